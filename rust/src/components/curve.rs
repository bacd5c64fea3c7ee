//! Torque over twist of one drive, through its free play and up to a load, seen from the input with
//! the output locked or from the output with the input locked.
//!
//! The turn is prescribed and the torque follows, so that the free play, where nothing holds the
//! flange, is no exception. The output shaft is a spring between the flange and the end that is held.

use crate::components::contact::PowerLaws;
use crate::components::equilibrium::{Loaded, Motion, Pull};
use crate::components::inputs::PartInput;
use crate::components::mechanism::{Circles, Mechanism, Position};
use crate::components::parts::{Fixed, Parts};
use crate::components::sharing::Sharing;
use crate::model::inputs::Input;

/// Shaft that is turned; the other one is locked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turned {
    /// The crank, with the far end of the output shaft locked: the mesh travels while it loads.
    Input,
    /// The far end of the output shaft, with the crank locked.
    Output,
}

/// One point of a curve.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CurvePoint {
    /// Turn (rad) of the shaft that is turned.
    pub turn: f64,
    /// Torque (N m) in the output shaft.
    pub output_torque: f64,
    /// Torque (N m) at the crank without friction.
    pub input_torque: f64,
    /// Torque (N m) at the crank that sliding at all contacts takes; none where the crank is locked.
    pub friction_torque: f64,
    /// Contacts of holes and pins above 1 % of their largest force.
    pub active_pins: f64,
    /// `(sum F)^2 / sum F^2` of the output pins' forces.
    pub effective_pins: f64,
    /// Largest force (N) of a hole on a pin.
    pub pin_force: f64,
    /// Ring contacts above 1 % of their largest force.
    pub active_ring: f64,
    /// Largest force (N) of a ring pin on a disc.
    pub ring_force: f64,
    /// Whether the forces balance.
    pub converged: bool,
}

/// A curve in one sense of turning.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// From no turn to the largest one, the end of the free play among them.
    pub points: Vec<CurvePoint>,
    /// Turn (rad) at which the contacts begin to carry.
    pub free_play: f64,
    /// Whether the load asked for was reached.
    pub reached: bool,
}

/// Steps of the first search over the turn at rated torque.
const SEARCH_STEPS: f64 = 12.0;
/// Most steps of that search: a drive that has not reached its load by then does not reach it.
const MOST_STEPS: usize = 2000;
/// Halvings of an interval that brackets the end of the free play or of the curve.
const HALVINGS: usize = 48;
/// Output torque over the rated one above which contacts carry.
const CARRIES: f64 = 1e-9;
/// Stiffness of the spring that stands for a rigid shaft, over that of all output pins side by side.
const RIGID: f64 = 1e4;
/// Corrections for that spring's own twist, each of which leaves a ten-thousandth of it.
const CORRECTIONS: usize = 3;
/// Parts into which a step is cut where the search for an equilibrium ends elsewhere.
const CUTS: usize = 16;

/// A drive in the test rig: one shaft locked, the other one turned.
#[derive(Debug)]
pub struct Rig<'a> {
    parts: &'a Parts,
    mechanism: Mechanism,
    circles: Circles,
    position: Position,
    turned: Turned,
    crank: f64,
    /// Where the last search ended: turn and motion.
    last: (f64, Motion),
    memory: Vec<f64>,
}

impl<'a> Rig<'a> {
    /// A drive whose crank stands at `crank` (rad) when both shafts are in their middle.
    #[must_use]
    pub fn new(parts: &'a Parts, fixed: &Fixed, turned: Turned, crank: f64) -> Self {
        let mechanism = parts.mechanism(fixed);
        let mut circles = Circles::default();
        circles.set(&mechanism);
        Self {
            parts,
            mechanism,
            circles,
            position: Position::default(),
            turned,
            crank,
            last: (0.0, Motion::default()),
            memory: Vec::new(),
        }
    }

    /// The curve from no turn towards `sense`, up to this torque (N m) at the shaft turned, in at
    /// least so many equal steps. It ends where that torque is first reached.
    #[must_use]
    pub fn curve(&mut self, sense: f64, torque: f64, steps: usize) -> Curve {
        let sense = sense.signum();
        let step = self.first_step(sense);
        let turned = self.turned;
        let load = |point: &CurvePoint| sense * turned.torque(point);
        let carries = CARRIES * self.parts.torque;
        let (mut play, mut end) = (None, None);
        let mut before = self.at(0.0).turn;
        for k in 0..=MOST_STEPS {
            let point = self.at(sense * step * k as f64);
            if play.is_none() && sense * point.output_torque > carries {
                play = Some((before, point.turn));
            }
            if load(&point) >= torque {
                end = Some((before, point.turn));
                break;
            }
            before = point.turn;
        }
        let reached = end.is_some();
        let end = end.unwrap_or((before, before));
        let end = self.bisect(end, |point| load(point) >= torque);
        let free_play = match play {
            Some((from, to)) => self.bisect((from, to), |p| sense * p.output_torque > carries),
            None => end,
        };
        let mut turns: Vec<f64> = (0..=steps).map(|k| end * k as f64 / steps as f64).collect();
        turns.push(free_play);
        turns.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        turns.dedup();
        self.last = (0.0, Motion::default());
        Curve {
            points: turns.into_iter().map(|turn| self.at(turn)).collect(),
            free_play,
            reached,
        }
    }

    /// Turn (rad) of the first search's steps.
    fn first_step(&mut self, sense: f64) -> f64 {
        self.position
            .set(&self.mechanism, &self.circles, self.crank);
        let loaded = Loaded::full(&self.mechanism, &self.position);
        let torque = sense * self.parts.torque;
        let found = loaded.solve(torque, &loaded.first_motion(torque));
        let twist = found.motion.flange.abs() / self.mechanism.pin_circle_radius
            + self.parts.torque * self.parts.shaft_compliance;
        let at_turned = match self.turned {
            Turned::Input => twist * self.mechanism.lobes as f64,
            Turned::Output => twist,
        };
        at_turned / SEARCH_STEPS
    }

    /// Middle of an interval of turns at whose far end something holds, as small as it gets.
    fn bisect(&mut self, (from, to): (f64, f64), holds: impl Fn(&CurvePoint) -> bool) -> f64 {
        let (mut from, mut to) = (from, to);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (from + to);
            if holds(&self.at(middle)) {
                to = middle;
            } else {
                from = middle;
            }
        }
        to
    }

    /// The equilibrium at a turn (rad), from the last one found.
    pub fn at(&mut self, turn: f64) -> CurvePoint {
        let (from, motion) = self.last;
        let mut found = self.settled(turn, &motion);
        if !found.1 {
            let mut on_the_way = motion;
            for cut in 1..=CUTS {
                let part = from + (turn - from) * cut as f64 / CUTS as f64;
                found = self.settled(part, &on_the_way);
                on_the_way = found.0;
            }
        }
        self.last = (turn, found.0);
        self.point(turn, &found.0, found.1)
    }

    /// Where flange and discs stand at a turn, and whether the forces balance.
    fn settled(&mut self, turn: f64, start: &Motion) -> (Motion, bool) {
        let mechanism = &self.mechanism;
        let radius = mechanism.pin_circle_radius;
        let (crank, end) = match self.turned {
            Turned::Input => (self.crank + turn, turn / mechanism.lobes as f64),
            Turned::Output => (self.crank, turn),
        };
        self.position.set(mechanism, &self.circles, crank);
        let loaded = Loaded::full(mechanism, &self.position);
        let pins = mechanism.pin_stiffness[0] * mechanism.output_pins as f64;
        let softness = self.parts.shaft_compliance * radius * radius;
        let softest = 1.0 / (RIGID * pins);
        let spring = 1.0 / softness.max(softest);
        let (mut motion, mut converged) = (*start, false);
        let mut correction = 0.0;
        for _ in 0..=CORRECTIONS {
            let far_end = end * radius + correction;
            let pull = Pull {
                force: spring * far_end,
                stiffness: spring,
                scale: self.parts.torque / radius,
            };
            let found = loaded.settle(pull, &motion);
            (motion, converged) = (found.motion, found.converged);
            if softness >= softest {
                break;
            }
            correction = loaded.flange_force(&motion) * (softest - softness);
        }
        (motion, converged)
    }

    /// What of an equilibrium a curve holds. The contacts are those of the last search.
    fn point(&mut self, turn: f64, motion: &Motion, converged: bool) -> CurvePoint {
        let (mechanism, parts) = (&self.mechanism, self.parts);
        let loaded = Loaded::full(mechanism, &self.position);
        let torque = loaded.flange_force(motion) * mechanism.pin_circle_radius;
        let (mut ring, mut pins) = (Vec::new(), Vec::new());
        let mut friction = 0.0;
        for disc in 0..mechanism.discs {
            let from = ring.len();
            loaded.ring_forces(disc, motion, &mut ring);
            if self.turned == Turned::Input {
                friction += sliding(parts, &loaded, disc, motion, &ring[from..]);
            }
            loaded.pin_forces(disc, motion, &mut pins);
        }
        if self.turned == Turned::Input {
            // A locked flange: discs move in a circle of radius e without turning.
            let sum: f64 = pins.iter().sum();
            friction += parts.value(PartInput::FrictionOutput) * mechanism.eccentricity * sum;
        }
        let (of_pins, of_ring) = (Sharing::of(&pins), Sharing::of(&ring));
        CurvePoint {
            turn,
            output_torque: torque,
            input_torque: loaded.input_torque(torque, motion, &mut self.memory),
            friction_torque: friction,
            active_pins: of_pins.active,
            effective_pins: of_pins.effective,
            pin_force: of_pins.largest,
            active_ring: of_ring.active,
            ring_force: of_ring.largest,
            converged,
        }
    }
}

/// Torque (N m) at the crank that a disc's sliding on the ring and in its bearing takes when the
/// flange is locked.
fn sliding(
    parts: &Parts,
    loaded: &Loaded<'_, PowerLaws>,
    disc: usize,
    motion: &Motion,
    ring: &[f64],
) -> f64 {
    let along: f64 = loaded
        .ring_contacts(disc, motion, ring)
        .map(|contact| contact.force * contact.normal[0].abs())
        .sum();
    let [x, y] = loaded.bearing_force(disc, motion);
    let bore = parts.scalar(Input::DiscBoreRadius);
    parts.value(PartInput::FrictionRing) * parts.profile.eccentricity * along
        + parts.value(PartInput::FrictionBearing) * bore * x.hypot(y)
}

impl Turned {
    /// Torque (N m) at the shaft turned.
    #[must_use]
    pub const fn torque(self, point: &CurvePoint) -> f64 {
        match self {
            Self::Input => point.input_torque,
            Self::Output => point.output_torque,
        }
    }
}
