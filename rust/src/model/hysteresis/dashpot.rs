//! Drag: what a dashpot in parallel lets through of a torque.
//!
//! Drag that thins above some rate is that of Carreau (Trans. Soc. Rheol. 16(1), 1972).

use crate::model::hysteresis::checks::{
    HistoryError, not_negative, numbers, positive, same_length,
};

/// Share of a step after which the first stage of the integration stands, `1 - sqrt(1/2)`.
const STAGE: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Fewest steps of the integration from one sample to the next,
const FEWEST_STEPS: f64 = 2.0;

/// and most: of a lag of a hundredth of that time next to nothing of a change is then left.
const MOST_STEPS: f64 = 4.0;

/// Share of the largest possible way from which Newton's steps begin at the least,
const LEAST_NEAR: f64 = 0.05;

/// their number at most,
const MOST_ITERATIONS: usize = 60;

/// and a step, in shares of the power of the way, after which the next one is about its square.
const CLOSE: f64 = 1e-5;

/// Resistance to motion that grows with a power of the rate, or does so above some rate.
#[derive(Clone, Copy, Debug)]
pub struct Dashpot {
    /// Drag over rate at the reference rate, as a time.
    pub lag: f64,
    /// Power of the rate, above zero and up to one.
    pub power: f64,
    /// Rate up to which the drag is in proportion to the rate, as by Carreau's law
    /// `rate (1 + (rate/thinning_rate)^2)^((power - 1)/2)`; none for the power alone.
    pub thinning_rate: Option<f64>,
    /// Rate at which the drag is `lag` times the rate.
    pub reference_rate: f64,
    /// Whether the rate is taken from sample to sample, and not of the motion between them.
    pub by_sample: bool,
}

/// Drag of a way that takes a given time.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Drag of a way of one, without thinning.
    factor: f64,
    /// Way from which it thins.
    thinning_way: Option<f64>,
}

impl Dashpot {
    /// State after a time in which the input grew evenly, with drag in proportion to the rate.
    ///
    /// This is exact, but for one implicit step where the rate is taken from sample to sample.
    fn follow_exactly(self, state: f64, from: f64, to: f64, lapse: f64) -> f64 {
        if self.by_sample {
            return state + (to - state) / (1.0 + self.lag / lapse);
        }
        let spans = lapse / self.lag.max(1e-300);
        let (passed, ramp) = (-(-spans).exp_m1(), (to - from) / spans);
        let gap = from - state;
        to - gap * (1.0 - passed) - ramp * passed
    }

    /// The same with drag that grows with a power of the rate, in a few steps.
    ///
    /// They are those of a singly diagonally implicit Runge-Kutta method of second order, which is
    /// L-stable and exact for an even motion (Alexander 1977, SIAM J. Numer. Anal. 14: 1006).
    /// `near` is a way to the power, near which each stage looks for its own.
    fn follow(self, state: f64, from: f64, to: f64, lapse: f64, near: &mut f64) -> f64 {
        if self.by_sample {
            return state + self.way(to - state, self.step(lapse), near);
        }
        let count = (2.0 * lapse / self.lag.max(1e-300)).ceil();
        let count = count.clamp(FEWEST_STEPS, MOST_STEPS);
        let (step, ramp) = (lapse / count, (to - from) / count);
        let stage = self.step(STAGE * step);
        let (mut state, mut begun) = (state, from);
        for _ in 0..count as usize {
            let way = self.way(begun + STAGE * ramp - state, stage, near);
            state += (1.0 / STAGE - 1.0) * way;
            begun += ramp;
            state += self.way(begun - state, stage, near);
        }
        state
    }

    /// Drag of a way that takes a time.
    fn step(self, lapse: f64) -> Step {
        let Some(thinning_rate) = self.thinning_rate else {
            let drag = self.lag * self.reference_rate;
            return Step {
                factor: drag / (self.reference_rate * lapse).powf(self.power),
                thinning_way: None,
            };
        };
        let thinned = self.thinned((self.reference_rate / thinning_rate).powi(2));
        Step {
            factor: self.lag / lapse / thinned,
            thinning_way: Some(thinning_rate * lapse),
        }
    }

    /// Carreau's factor on the drag where the rate over that of thinning has this square.
    fn thinned(self, square: f64) -> f64 {
        (1.0 + square).powf(0.5 * (self.power - 1.0))
    }

    /// Way in which the balance `way + drag(way) = gap` holds.
    fn way(self, gap: f64, step: Step, near: &mut f64) -> f64 {
        if gap == 0.0 || step.factor == 0.0 {
            return gap;
        }
        let size = match step.thinning_way {
            None => self.way_by_power(gap.abs(), step.factor, near),
            Some(thinning_way) => self.way_by_carreau(gap.abs(), step.factor, thinning_way),
        };
        gap.signum() * size
    }

    /// Way `w` in which the balance `w + factor w (1 + (w/k)^2)^((power - 1)/2) = size` holds.
    fn way_by_carreau(self, size: f64, factor: f64, thinning_way: f64) -> f64 {
        // The balance rises and is concave: from below Newton's steps stay below.
        let mut way = size / (1.0 + factor);
        for _ in 0..MOST_ITERATIONS {
            let square = (way / thinning_way).powi(2);
            let drag = factor * self.thinned(square);
            let slope = 1.0 + drag * (1.0 + (self.power - 1.0) * square / (1.0 + square));
            let ahead = (size - way - drag * way) / slope;
            way += ahead;
            if ahead <= CLOSE * way {
                break;
            }
        }
        way.clamp(0.0, size)
    }

    /// Way `w` in which the balance `w + factor w^power = size` holds.
    fn way_by_power(self, size: f64, factor: f64, near: &mut f64) -> f64 {
        let inverse = 1.0 / self.power;
        // In y = |w|^power the balance is convex and rises: once above, Newton's steps descend.
        let highest = size / factor;
        let mut y = near.max(LEAST_NEAR * highest).min(highest);
        for _ in 0..MOST_ITERATIONS {
            let way = y.powf(inverse);
            let step = (way + factor * y - size) / (inverse * way / y + factor);
            y -= step;
            if step.abs() <= CLOSE * y {
                break;
            }
        }
        *near = y;
        // As the balance has it, of which the drag is the larger part where this is inexact.
        (size - factor * y).max(0.0)
    }
}

/// Input that a dashpot in parallel lets through: the torque balance `u = x + drag(dx/dt)`, with an
/// input `u` that grows evenly from sample to sample.
///
/// `lapse[i]` is the time that led to sample `i`; `restart[i]` marks a sample reached from rest.
///
/// # Errors
/// [`HistoryError`] when columns differ in length, the signal holds what is not a number, the lag is
/// negative, or the rate of thinning is not above zero.
pub fn dragged(
    input: &[f64],
    lapse: &[f64],
    restart: &[bool],
    dashpot: Dashpot,
    out: &mut [f64],
) -> Result<(), HistoryError> {
    same_length(input.len(), &[lapse.len(), restart.len(), out.len()])?;
    numbers("signal", input)?;
    not_negative("lag", &[dashpot.lag])?;
    if let Some(rate) = dashpot.thinning_rate {
        positive("thinning rate", &[rate])?;
    }
    let (mut state, mut before, mut near) = (0.0, 0.0, 0.0);
    for i in 0..input.len() {
        if i == 0 || restart[i] {
            (state, before) = (0.0, 0.0);
        }
        // Without a lapse nothing can have moved.
        let passed = lapse[i].max(1e-12 * dashpot.lag.abs().max(1e-300));
        state = if dashpot.power == 1.0 {
            dashpot.follow_exactly(state, before, input[i], passed)
        } else {
            dashpot.follow(state, before, input[i], passed, &mut near)
        };
        before = input[i];
        out[i] = state;
    }
    Ok(())
}
