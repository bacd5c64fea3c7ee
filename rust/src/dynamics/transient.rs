//! Transients of a train: from event to event in closed form.

use std::rc::Rc;

use nalgebra::DMatrix;

use crate::dynamics::branch::{Cause, EventKind, Range, SpringState, states};
use crate::dynamics::modes::Modes;
use crate::dynamics::motion::{ModeMotion, Motions, Sum};
use crate::dynamics::peaks::Peak;
use crate::dynamics::train::{Train, TrainError};

/// Parts into which a step near a standstill divides the shortest period.
const STEPS_A_PERIOD: f64 = 40.0;
/// Events without time passing after which two branches switch to and fro.
const MOST_AT_ONCE: usize = 200;
/// Rounds of the safeguarded Newton step; halving alone would need about sixty.
const MOST_ROUNDS: usize = 100;
/// Time (s) below which an event is not located.
const RESOLUTION_S: f64 = 1e-16;

/// Torques on the nodes: straight lines between knots, rows of nodes one after the other.
#[derive(Debug, Clone, Copy)]
pub struct Loads<'a> {
    /// Times of the knots (s), not falling; two equal ones are a jump.
    pub times: &'a [f64],
    /// Torques (N m), knots by nodes.
    pub torques: &'a [f64],
}

/// Where a transient begins.
#[derive(Debug, Clone)]
pub struct Start<'a> {
    /// Angles of the nodes (rad).
    pub angles: &'a [f64],
    /// Speeds of the nodes (rad/s).
    pub speeds: &'a [f64],
    /// Twists at which the slip elements of each spring are anchored (rad).
    pub anchors: Vec<Vec<f64>>,
}

/// An event: the branch of one spring ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// When (s).
    pub time: f64,
    /// Number of the spring.
    pub spring: usize,
    /// What happened.
    pub kind: EventKind,
    /// Twist (rad).
    pub twist: f64,
    /// Speed of the twist (rad/s).
    pub speed: f64,
}

/// What a transient leaves behind.
#[derive(Debug, Clone, Default)]
pub struct Record {
    /// Angles, samples by nodes (rad).
    pub angles: Vec<f64>,
    /// Speeds, samples by nodes (rad/s).
    pub speeds: Vec<f64>,
    /// Torques of law and friction, samples by springs (N m).
    pub torques: Vec<f64>,
    /// Friction's part of them (N m).
    pub frictions: Vec<f64>,
    /// Kinetic energy (J) at each sample.
    pub kinetic: Vec<f64>,
    /// Energy (J) in laws and slip elements at each sample.
    pub potential: Vec<f64>,
    /// Energy (J) that friction has taken up to each sample.
    pub lost: Vec<f64>,
    /// Events in order.
    pub events: Vec<Event>,
    /// Largest torque of each spring.
    pub peaks: Vec<Peak>,
    /// Energy (J) that friction has taken in each spring.
    pub lost_in: Vec<f64>,
    /// Angles and speeds at the end.
    pub end: (Vec<f64>, Vec<f64>),
}

/// Follows a train under torques.
///
/// `samples` are times (s) in order at which the record keeps the state; none are needed for events
/// and peaks.
///
/// # Errors
/// [`TrainError`] when lists do not fit the train or events follow without time passing.
pub fn transient(
    train: &Train,
    start: &Start<'_>,
    loads: Loads<'_>,
    samples: &[f64],
) -> Result<Record, TrainError> {
    let n = train.inertias().len();
    fits("angles", start.angles.len(), n)?;
    fits("speeds", start.speeds.len(), n)?;
    fits("anchors", start.anchors.len(), train.springs().len())?;
    for (spring, anchors) in train.springs().iter().zip(&start.anchors) {
        fits("anchors of a spring", anchors.len(), spring.elements.len())?;
    }
    fits("torques", loads.torques.len(), loads.times.len() * n)?;
    let mut run = Run::new(train, start, samples);
    for knot in 1..loads.times.len() {
        let (from, to) = (loads.times[knot - 1], loads.times[knot]);
        if to > from {
            let row = |k: usize| &loads.torques[k * n..(k + 1) * n];
            run.stretch(from, to, row(knot - 1), row(knot))?;
        }
    }
    Ok(run.finish())
}

fn fits(what: &'static str, found: usize, expected: usize) -> Result<(), TrainError> {
    let error = TrainError::Length {
        what,
        found,
        expected,
    };
    if found == expected {
        Ok(())
    } else {
        Err(error)
    }
}

/// Modes for the stiffnesses of a branch.
struct Basis {
    stiffnesses: Vec<f64>,
    modes: Modes,
    /// A step within which no twist turns more than once.
    step: f64,
}

struct Run<'a> {
    train: &'a Train,
    bases: Vec<Rc<Basis>>,
    states: Vec<SpringState>,
    angles: Vec<f64>,
    speeds: Vec<f64>,
    /// Angle and speed of every node at a sample.
    nodes: Vec<[f64; 2]>,
    samples: &'a [f64],
    next_sample: usize,
    record: Record,
}

impl<'a> Run<'a> {
    fn new(train: &'a Train, start: &Start<'_>, samples: &'a [f64]) -> Self {
        let twists = train.twists(start.angles);
        let states = states(train, &twists, &start.anchors);
        let springs = train.springs().len();
        Self {
            train,
            bases: Vec::new(),
            states,
            angles: start.angles.to_vec(),
            speeds: start.speeds.to_vec(),
            nodes: Vec::with_capacity(start.angles.len()),
            samples,
            next_sample: 0,
            record: Record {
                peaks: vec![Peak::default(); springs],
                lost_in: vec![0.0; springs],
                ..Record::default()
            },
        }
    }

    /// Follows the train while the torques change linearly.
    fn stretch(
        &mut self,
        from: f64,
        to: f64,
        first: &[f64],
        last: &[f64],
    ) -> Result<(), TrainError> {
        let rates: Vec<f64> = first
            .iter()
            .zip(last)
            .map(|(a, b)| (b - a) / (to - from))
            .collect();
        let mut now = from;
        let mut at_once = 0;
        while now < to {
            let torques: Vec<f64> = first
                .iter()
                .zip(&rates)
                .map(|(torque, rate)| torque + rate * (now - from))
                .collect();
            let path = Path::new(self, now, &torques, &rates, to - now);
            let event = path.next_event(to - now);
            let length = event.map_or(to - now, |event| event.after);
            self.keep(&path, length, event.is_none());
            let twists = self.train.twists(&self.angles);
            path.nodes(length, &mut self.nodes);
            self.angles = self.nodes.iter().map(|node| node[0]).collect();
            self.speeds = self.nodes.iter().map(|node| node[1]).collect();
            let reached = self.train.twists(&self.angles);
            for (k, spring) in self.train.springs().iter().enumerate() {
                let state = &self.states[k];
                self.record.lost_in[k] += state.lost(spring, twists[k], reached[k]);
            }
            now = if event.is_some() { now + length } else { to };
            if let Some(event) = event {
                at_once = if length > 0.0 { 0 } else { at_once + 1 };
                if at_once > MOST_AT_ONCE {
                    return Err(TrainError::Stuck {
                        events: at_once,
                        time_s: now,
                    });
                }
                self.pass(event, now, &reached);
            }
        }
        Ok(())
    }

    /// Goes over to the branch behind an event.
    fn pass(&mut self, event: Found, now: f64, twists: &[f64]) {
        let spring = &self.train.springs()[event.spring];
        let kind = self.states[event.spring].pass(spring, event.cause, twists[event.spring]);
        let speed = self.train.twists(&self.speeds)[event.spring];
        self.record.events.push(Event {
            time: now,
            spring: event.spring,
            kind,
            twist: twists[event.spring],
            speed,
        });
    }

    /// Keeps the samples and peaks of a branch.
    fn keep(&mut self, path: &Path, length: f64, closed: bool) {
        let before = self.train.twists(&self.angles);
        while let Some(&time) = self.samples.get(self.next_sample) {
            let after = time - path.start;
            if after > length || (after == length && !closed) {
                break;
            }
            self.sample(path, &before, after.max(0.0));
            self.next_sample += 1;
        }
        for (k, peak) in self.record.peaks.iter_mut().enumerate() {
            let (offset, slope) = path.lines[k];
            let torque_at = |after: f64| offset + slope * path.twist(k, after)[0];
            peak.take(torque_at(0.0), path.start);
            peak.take(torque_at(length), path.start + length);
            peak.search(path.start, length, |after, radius| {
                let mut near = path.motions.around(&path.twists[k], after, radius);
                for part in &mut near.parabola {
                    *part *= slope;
                }
                near.parabola[0] += offset;
                near.margin *= slope;
                near
            });
        }
    }

    fn sample(&mut self, path: &Path, before: &[f64], after: f64) {
        path.nodes(after, &mut self.nodes);
        let record = &mut self.record;
        let mut lost: f64 = record.lost_in.iter().sum();
        let mut potential = 0.0;
        for (k, spring) in self.train.springs().iter().enumerate() {
            let state = &self.states[k];
            let (offset, slope) = path.lines[k];
            let twist = self.nodes[spring.from][0] - spring.to.map_or(0.0, |to| self.nodes[to][0]);
            record.torques.push(offset + slope * twist);
            record.frictions.push(state.friction(spring, twist));
            potential += spring.energy(twist) + state.slip_energy(spring, twist);
            lost += state.lost(spring, before[k], twist);
        }
        let nodes = self.train.inertias().iter().zip(&self.nodes);
        let kinetic = nodes.map(|(j, [_, speed])| 0.5 * j * speed * speed).sum();
        record.kinetic.push(kinetic);
        record.potential.push(potential);
        record.lost.push(lost);
        record.angles.extend(self.nodes.iter().map(|node| node[0]));
        record.speeds.extend(self.nodes.iter().map(|node| node[1]));
    }

    fn basis(&mut self, stiffnesses: Vec<f64>) -> Rc<Basis> {
        if let Some(basis) = self.bases.iter().find(|b| b.stiffnesses == stiffnesses) {
            return Rc::clone(basis);
        }
        let modes = Modes::of(self.train, &stiffnesses);
        let fastest = modes.omega_squared.last().copied().unwrap_or(0.0).sqrt();
        let step = std::f64::consts::TAU / (STEPS_A_PERIOD * fastest);
        let basis = Rc::new(Basis {
            stiffnesses,
            modes,
            step,
        });
        self.bases.push(Rc::clone(&basis));
        basis
    }

    fn finish(mut self) -> Record {
        self.record.end = (self.angles, self.speeds);
        self.record
    }
}

/// The event that ends a branch.
#[derive(Debug, Clone, Copy)]
struct Found {
    after: f64,
    spring: usize,
    cause: Cause,
}

/// Motion on one branch.
struct Path {
    start: f64,
    /// A step within which no twist turns more than once.
    step: f64,
    motions: Motions,
    /// Twist of each spring as a sum of the modes.
    twists: Vec<Sum>,
    /// Angle of each node as a sum of the modes.
    angles: Vec<Sum>,
    /// Torque of each spring as a line of its twist.
    lines: Vec<(f64, f64)>,
    /// Springs whose branch can end, where, and what their acceleration never exceeds.
    watched: Vec<(usize, Range, f64)>,
}

impl Path {
    fn new(run: &mut Run<'_>, start: f64, torques: &[f64], rates: &[f64], horizon: f64) -> Self {
        let train = run.train;
        let springs = train.springs();
        let lines: Vec<(f64, f64)> = springs
            .iter()
            .zip(&run.states)
            .map(|(spring, state)| state.linear(spring))
            .collect();
        let basis = run.basis(lines.iter().map(|line| line.1).collect());
        let modes = &basis.modes;
        let motions = (0..modes.omega_squared.len())
            .map(|m| {
                let shape = modes.shapes.column(m);
                let twist = modes.twists.column(m);
                let onto = |values: &[f64]| shape.iter().zip(values).map(|(s, v)| s * v).sum();
                let scaled = |values: &[f64]| {
                    let parts = shape.iter().zip(train.inertias()).zip(values);
                    parts.map(|((s, j), v)| s * j * v).sum()
                };
                let held: f64 = twist.iter().zip(&lines).map(|(t, line)| t * line.0).sum();
                let force: f64 = onto(torques);
                ModeMotion::new(
                    modes.omega_squared[m],
                    train.damping_s(),
                    (scaled(&run.angles), scaled(&run.speeds)),
                    (force - held, onto(rates)),
                )
            })
            .collect();
        let motions = Motions::new(motions);
        let sums = |weights: &DMatrix<f64>| -> Vec<Sum> {
            let rows = 0..weights.nrows();
            rows.map(|row| motions.sum(|m| weights[(row, m)])).collect()
        };
        let (twists, angles) = (sums(&modes.twists), sums(&modes.shapes));
        let bound = |k: usize| motions.acceleration_bound(&twists[k], horizon);
        let watched = (0..springs.len())
            .filter(|&k| springs[k].has_events())
            .map(|k| (k, run.states[k].range(&springs[k]), bound(k)))
            .collect();
        Self {
            start,
            step: basis.step,
            motions,
            twists,
            angles,
            lines,
            watched,
        }
    }

    /// Angle and speed of every node.
    fn nodes(&self, after: f64, nodes: &mut Vec<[f64; 2]>) {
        self.motions.all_at(&self.angles, after, nodes);
    }

    /// Twist of a spring and its first two derivatives.
    fn twist(&self, spring: usize, after: f64) -> [f64; 3] {
        self.motions.at(&self.twists[spring], after)
    }

    /// The first event within a time.
    fn next_event(&self, horizon: f64) -> Option<Found> {
        let mut first: Option<Found> = None;
        for &(spring, range, bound) in &self.watched {
            let until = first.map_or(horizon, |found| found.after);
            if let Some((after, cause)) = self.first_of(spring, range, bound, until)
                && first.is_none_or(|found| after < found.after)
            {
                first = Some(Found {
                    after,
                    spring,
                    cause,
                });
            }
        }
        first
    }

    /// The first end of one spring's branch.
    ///
    /// A step is as long as the acceleration's bound proves that the twist does not turn, or that
    /// it stays in its range; near a standstill a fraction of the shortest period.
    fn first_of(
        &self,
        spring: usize,
        range: Range,
        bound: f64,
        horizon: f64,
    ) -> Option<(f64, Cause)> {
        let mut from = 0.0;
        let mut here = self.twist(spring, 0.0);
        while from < horizon {
            let [twist, speed, _] = here;
            let mut step = (speed.abs() / bound).max(self.step);
            let room = (range.high.0 - twist).min(twist - range.low.0);
            if !range.slides && room > 0.0 {
                let root = (speed * speed + 2.0 * bound * room).sqrt();
                step = step.max(2.0 * room / (root + speed.abs()));
            }
            let to = if step.is_finite() {
                horizon.min(from + step)
            } else {
                horizon
            };
            let there = self.twist(spring, to);
            let reach = (to - from) * (speed.abs() + 0.5 * bound * (to - from));
            if (range.slides || reach >= room)
                && let Some(found) = self.within(spring, range, (from, here), (to, there))
            {
                return Some(found);
            }
            if to <= from {
                break;
            }
            (from, here) = (to, there);
        }
        None
    }

    /// The first event between two times between which the twist turns once at most.
    fn within(
        &self,
        spring: usize,
        range: Range,
        (from, here): (f64, [f64; 3]),
        (to, there): (f64, [f64; 3]),
    ) -> Option<(f64, Cause)> {
        if here[1] != 0.0 && here[1] * there[1] <= 0.0 {
            let turn = root(from, to, here[1] < 0.0, |t| {
                let [_, speed, acceleration] = self.twist(spring, t);
                (speed, acceleration)
            });
            let middle = self.twist(spring, turn);
            return self
                .crossing(spring, range, (from, here[0]), (turn, middle[0]))
                .or_else(|| range.slides.then_some((turn, Cause::Stop)))
                .or_else(|| self.crossing(spring, range, (turn, middle[0]), (to, there[0])));
        }
        self.crossing(spring, range, (from, here[0]), (to, there[0]))
    }

    /// Where a twist that only grows or only falls leaves its range.
    fn crossing(
        &self,
        spring: usize,
        range: Range,
        (from, before): (f64, f64),
        (to, behind): (f64, f64),
    ) -> Option<(f64, Cause)> {
        let (limit, cause) = if behind > before && behind > range.high.0 {
            range.high
        } else if behind < before && behind < range.low.0 {
            range.low
        } else {
            return None;
        };
        let rises = behind > before;
        if (rises && before >= limit) || (!rises && before <= limit) {
            return Some((from, cause));
        }
        let at = root(from, to, rises, |t| {
            let [twist, speed, _] = self.twist(spring, t);
            (twist - limit, speed)
        });
        Some((at, cause))
    }
}

/// Zero of a function that only rises or only falls between two times, by Newton steps that never
/// leave the bracket.
fn root(
    mut low: f64,
    mut high: f64,
    rises: bool,
    mut function: impl FnMut(f64) -> (f64, f64),
) -> f64 {
    let mut at = 0.5 * (low + high);
    for _ in 0..MOST_ROUNDS {
        let (value, slope) = function(at);
        if value == 0.0 {
            break;
        }
        if (value > 0.0) == rises {
            high = at;
        } else {
            low = at;
        }
        let newton = at - value / slope;
        if (newton - at).abs() <= RESOLUTION_S + 4.0 * f64::EPSILON * at {
            break;
        }
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if next <= low || next >= high {
            break;
        }
        at = next;
    }
    at
}
