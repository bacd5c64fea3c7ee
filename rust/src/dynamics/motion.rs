//! The motion of a linear branch in closed form: modes side by side, and sums of them.

use crate::dynamics::peaks::Nearby;
use crate::model::elementary::{LARGEST_ANGLE, sin_cos};
use crate::wide::{Wide, with_widest};

/// Angle (rad) over which a mode is no longer taken for a parabola.
const TURNS: f64 = 1.5;
/// Modes that are computed together.
const LANES: usize = 4;

/// One number for each of the modes that are computed together.
type Lanes = [f64; LANES];

/// One mode under a force that changes linearly in time, from the moment at which a branch starts.
///
/// $\ddot q + c \dot q + \omega^2 q = f_0 + f_1 t$ with $c = \beta \omega^2$. With the free motions
/// $C$ (fading cosine) and $S$ (fading sine over the frequency) and a polynomial $p$ that the force
/// alone makes, $q = p + a C + b S$.
#[derive(Debug, Clone, Copy)]
pub(super) struct ModeMotion {
    /// Angular frequency squared (1/s^2), zero for a rigid mode.
    square: f64,
    /// Half of the damping coefficient (1/s).
    decay: f64,
    /// Angular frequency of the damped oscillation, or rate where it creeps back.
    omega: f64,
    /// Whether it creeps back without oscillating.
    creeps: bool,
    /// Coefficients of the polynomial; of a rigid mode it is the whole motion.
    polynomial: [f64; 4],
    /// Displacement and speed at the start, the polynomial's taken off.
    start: (f64, f64),
}

impl ModeMotion {
    /// A mode from displacement and speed at the start and the force's value and slope.
    pub(super) fn new(square: f64, damping_s: f64, start: (f64, f64), force: (f64, f64)) -> Self {
        if square == 0.0 {
            return Self {
                square,
                decay: 0.0,
                omega: 0.0,
                creeps: false,
                polynomial: [start.0, start.1, 0.5 * force.0, force.1 / 6.0],
                start: (0.0, 0.0),
            };
        }
        let decay = 0.5 * damping_s * square;
        let excess = square - decay * decay;
        let slope = force.1 / square;
        let constant = force.0 / square - 2.0 * decay * slope / square;
        Self {
            square,
            decay,
            omega: excess.abs().sqrt(),
            creeps: excess < 0.0,
            polynomial: [constant, slope, 0.0, 0.0],
            start: (start.0 - constant, start.1 - slope),
        }
    }

    /// Fading cosine, and fading sine over the frequency; hyperbolic where the mode creeps back.
    fn free(&self, time: f64) -> (f64, f64) {
        if self.creeps {
            let slow = ((self.omega - self.decay) * time).exp();
            let fast = (-(self.omega + self.decay) * time).exp();
            return (0.5 * (slow + fast), 0.5 * (slow - fast) / self.omega);
        }
        let fade = (-self.decay * time).exp();
        if self.omega == 0.0 {
            return (fade, fade * time);
        }
        let (sine, cosine) = (self.omega * time).sin_cos();
        (fade * cosine, fade * sine / self.omega)
    }

    /// Weights of the free motions in the displacement and its first two derivatives.
    fn weights(&self) -> [(f64, f64); 3] {
        let (from, speed) = self.start;
        let derivative = |(a, b): (f64, f64)| {
            // C' = -d C - (square - d^2) S and S' = C - d S.
            let stiff = self.square - self.decay * self.decay;
            (b - self.decay * a, -stiff * a - self.decay * b)
        };
        let displacement = (from, speed + self.decay * from);
        let rate = derivative(displacement);
        [displacement, rate, derivative(rate)]
    }

    /// Speed of the free part, which never exceeds it: the root of its energy never grows.
    fn root_of_energy(&self) -> f64 {
        let (from, speed) = self.start;
        (speed * speed + self.square * from * from).sqrt()
    }

    /// Rate (1/s) at which the derivatives of the free part grow at most.
    fn rate(&self) -> f64 {
        self.square.sqrt() + 2.0 * self.decay
    }
}

/// Modes whose free motions are computed together.
#[derive(Debug, Clone)]
struct Group {
    /// The modes; fewer than there are lanes in the last group.
    modes: Vec<ModeMotion>,
    omega: Lanes,
    /// One over the frequency; zero in lanes without a mode.
    period: Lanes,
    /// Whether all its modes oscillate without damping.
    undamped: bool,
    /// Time (s) up to which the angles are small enough for [`sin_cos`].
    short: f64,
}

impl Group {
    fn new(modes: &[ModeMotion]) -> Self {
        let mut omega = [0.0; LANES];
        let mut period = [0.0; LANES];
        for (lane, mode) in modes.iter().enumerate() {
            omega[lane] = mode.omega;
            period[lane] = 1.0 / mode.omega;
        }
        Self {
            modes: modes.to_vec(),
            omega,
            period,
            undamped: modes.iter().all(|mode| mode.decay == 0.0),
            short: LARGEST_ANGLE / omega.into_iter().fold(0.0, f64::max),
        }
    }

    /// Fading cosine and fading sine over the frequency of every lane.
    #[inline(always)]
    fn free(&self, time: f64) -> (Lanes, Lanes) {
        let (mut cosine, mut sine) = ([0.0; LANES], [0.0; LANES]);
        if self.undamped && time <= self.short {
            for lane in 0..LANES {
                let (s, c) = sin_cos(self.omega[lane] * time);
                cosine[lane] = c;
                sine[lane] = s * self.period[lane];
            }
        } else {
            self.free_one_by_one(time, &mut cosine, &mut sine);
        }
        (cosine, sine)
    }

    #[inline(never)]
    fn free_one_by_one(&self, time: f64, cosine: &mut Lanes, sine: &mut Lanes) {
        for (lane, mode) in self.modes.iter().enumerate() {
            (cosine[lane], sine[lane]) = mode.free(time);
        }
    }
}

/// All modes of a branch.
#[derive(Debug, Clone)]
pub(super) struct Motions {
    modes: Vec<ModeMotion>,
    /// Places of the modes that are not rigid, in the order of the groups' lanes.
    places: Vec<usize>,
    groups: Vec<Group>,
}

impl Motions {
    /// The modes, in the order in which weights of a [`Sum`] are given.
    pub(super) fn new(modes: Vec<ModeMotion>) -> Self {
        let elastic = |&m: &usize| modes[m].square != 0.0;
        let places: Vec<usize> = (0..modes.len()).filter(elastic).collect();
        let together: Vec<ModeMotion> = places.iter().map(|&m| modes[m]).collect();
        Self {
            groups: together.chunks(LANES).map(Group::new).collect(),
            places,
            modes,
        }
    }

    /// A sum of the modes with these weights.
    pub(super) fn sum(&self, part: impl Fn(usize) -> f64) -> Sum {
        let mut polynomial = [0.0; 4];
        for (m, mode) in self.modes.iter().enumerate() {
            for (total, coefficient) in polynomial.iter_mut().zip(mode.polynomial) {
                *total += part(m) * coefficient;
            }
        }
        let of_group = |places: &[usize]| {
            let mut weights = Weights::default();
            for (lane, &m) in places.iter().enumerate() {
                weights.take(lane, part(m), &self.modes[m]);
            }
            weights
        };
        Sum {
            polynomial,
            groups: self.places.chunks(LANES).map(of_group).collect(),
        }
    }

    /// The sum's value and its first two derivatives after a time (s).
    pub(super) fn at(&self, sum: &Sum, time: f64) -> [f64; 3] {
        let free = with_widest(Free {
            groups: &self.groups,
            weights: &sum.groups,
            time,
        });
        let forced = sum.forced(time);
        [0, 1, 2].map(|order| forced[order] + free[order])
    }

    /// Values and first derivatives of several sums after a time (s).
    pub(super) fn all_at(&self, sums: &[Sum], time: f64, states: &mut Vec<[f64; 2]>) {
        states.clear();
        states.extend(sums.iter().map(|sum| {
            let [value, rate, _] = sum.forced(time);
            [value, rate]
        }));
        for (k, group) in self.groups.iter().enumerate() {
            let (cosine, sine) = with_widest(Phase { group, time });
            for (state, sum) in states.iter_mut().zip(sums) {
                for (total, (a, b)) in state.iter_mut().zip(&sum.groups[k].of) {
                    for lane in 0..LANES {
                        *total += a[lane] * cosine[lane] + b[lane] * sine[lane];
                    }
                }
            }
        }
    }

    /// The sum around a time: a parabola, and what it is never farther from it within a radius.
    ///
    /// A mode that turns more than once in the stretch is only known to stay within its amplitude.
    pub(super) fn around(&self, sum: &Sum, time: f64, radius: f64) -> Nearby {
        let cube = radius * radius * radius / 6.0;
        let mut near = Nearby {
            parabola: sum.forced(time),
            margin: 6.0 * sum.polynomial[3].abs() * cube,
            touches: true,
        };
        for (group, weights) in self.groups.iter().zip(&sum.groups) {
            let slow = weights.rate.map(|rate| rate * radius <= TURNS);
            for (lane, &slow) in slow.iter().enumerate() {
                let amplitude = weights.amplitude[lane];
                near.margin += if slow {
                    weights.jerk[lane] * cube
                } else {
                    amplitude
                };
                near.touches &= slow || amplitude == 0.0;
            }
            if slow.contains(&true) {
                let (cosine, sine) = with_widest(Phase { group, time });
                for (total, (a, b)) in near.parabola.iter_mut().zip(&weights.of) {
                    for lane in (0..LANES).filter(|&lane| slow[lane]) {
                        *total += a[lane] * cosine[lane] + b[lane] * sine[lane];
                    }
                }
            }
        }
        near
    }

    /// What the sum's second derivative never exceeds within a time (s).
    pub(super) fn acceleration_bound(&self, sum: &Sum, time: f64) -> f64 {
        let [_, _, half, sixth] = sum.polynomial;
        let forced = 2.0 * half.abs() + 6.0 * sixth.abs() * time;
        let free = sum.groups.iter().map(|weights| {
            let lanes = weights.jerk.iter().zip(weights.rate);
            lanes
                .map(|(jerk, rate)| if rate > 0.0 { jerk / rate } else { 0.0 })
                .sum::<f64>()
        });
        forced + free.sum::<f64>()
    }
}

/// A sum of modes, such as the twist of a spring or the angle of a node.
#[derive(Debug, Clone)]
pub(super) struct Sum {
    polynomial: [f64; 4],
    groups: Vec<Weights>,
}

impl Sum {
    /// The polynomial and its first two derivatives.
    #[inline(always)]
    fn forced(&self, time: f64) -> [f64; 3] {
        let [zeroth, first, second, third] = self.polynomial;
        [
            zeroth + time * (first + time * (second + time * third)),
            first + time * (2.0 * second + 3.0 * time * third),
            2.0 * second + 6.0 * time * third,
        ]
    }
}

/// What the modes of a group contribute to a sum.
#[derive(Debug, Clone, Copy, Default)]
struct Weights {
    /// Of the fading cosines and sines, in the value and its first two derivatives.
    of: [(Lanes, Lanes); 3],
    /// What the third derivative never exceeds.
    jerk: Lanes,
    /// What the value never exceeds.
    amplitude: Lanes,
    /// Rate (1/s) at which the derivatives grow at most.
    rate: Lanes,
}

impl Weights {
    fn take(&mut self, lane: usize, part: f64, mode: &ModeMotion) {
        for ((a, b), (of_cosine, of_sine)) in self.of.iter_mut().zip(mode.weights()) {
            a[lane] = part * of_cosine;
            b[lane] = part * of_sine;
        }
        let (rate, energy) = (mode.rate(), part.abs() * mode.root_of_energy());
        self.rate[lane] = rate;
        self.jerk[lane] = rate * rate * energy;
        self.amplitude[lane] = energy / mode.square.sqrt();
    }
}

/// Free motions of one group.
struct Phase<'a> {
    group: &'a Group,
    time: f64,
}

impl Wide for Phase<'_> {
    type Output = (Lanes, Lanes);
    #[inline(always)]
    fn run(self) -> (Lanes, Lanes) {
        self.group.free(self.time)
    }
}

/// Free motions of all groups, weighted and added.
struct Free<'a> {
    groups: &'a [Group],
    weights: &'a [Weights],
    time: f64,
}

impl Wide for Free<'_> {
    type Output = [f64; 3];
    #[inline(always)]
    fn run(self) -> [f64; 3] {
        let mut sums = [[0.0; LANES]; 3];
        for (group, weights) in self.groups.iter().zip(self.weights) {
            let (cosine, sine) = group.free(self.time);
            for (sum, (a, b)) in sums.iter_mut().zip(&weights.of) {
                for lane in 0..LANES {
                    sum[lane] += a[lane] * cosine[lane] + b[lane] * sine[lane];
                }
            }
        }
        sums.map(|lanes| (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]))
    }
}
