//! The quadratic engine: straight contact laws, secants of the true ones at the forces to be
//! expected, so that the energy is quadratic wherever the same contacts touch.

use crate::components::contact::{LEAST_DEPTH, SecantLaws};
use crate::components::equilibrium::{Equilibrium, Loaded, Motion};
use crate::components::laws::APPROACH_EXPONENT;
use crate::components::mechanism::{MAX_DISCS, Mechanism, Position};

/// Largest force out of balance that counts as none, over the force at the pin circle.
pub(crate) const TOLERANCE: f64 = 1e-6;
/// Solutions after which a first guess of the secants is good enough to keep.
const FIRST_SOLUTIONS: usize = 2;

/// Forces (N) at which the secants of each disc are taken.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Expected {
    /// Ring contacts.
    pub ring: [f64; MAX_DISCS],
    /// Output contacts.
    pub pin: [f64; MAX_DISCS],
}

impl Expected {
    /// What discs without clearance share alike carry at their most loaded contacts.
    #[inline(always)]
    #[must_use]
    pub fn first(mechanism: &Mechanism, torque: f64) -> Self {
        let share = torque.abs() / mechanism.discs as f64;
        let ring = 4.0 * share / (mechanism.ring_lever() * mechanism.ring_pins() as f64);
        let pin = 4.0 * share / (mechanism.pin_circle_radius * mechanism.output_pins as f64);
        Self {
            ring: [ring; MAX_DISCS],
            pin: [pin; MAX_DISCS],
        }
    }

    /// The mean forces of an equilibrium, each contact weighed by its own; those of before where a
    /// disc carries nothing.
    #[inline(always)]
    #[must_use]
    pub fn of(
        loaded: &Loaded<'_, SecantLaws>,
        motion: &Motion,
        discs: usize,
        before: &Self,
    ) -> Self {
        let mut expected = *before;
        for disc in 0..discs {
            if let Some(depth) = loaded.mean_ring_depth(disc, motion) {
                expected.ring[disc] = depth * loaded.laws().ring[disc];
            }
            if let Some(depth) = loaded.mean_pin_depth(disc, motion) {
                expected.pin[disc] = depth * loaded.laws().pin[disc];
            }
        }
        expected
    }
}

impl SecantLaws {
    /// The secants of a drive's power laws at these forces.
    #[inline(always)]
    #[must_use]
    pub fn at(mechanism: &Mechanism, expected: &Expected) -> Self {
        let mut laws = Self::default();
        for disc in 0..mechanism.discs {
            let ring = expected.ring[disc];
            laws.ring[disc] = ring / (ring / mechanism.ring_stiffness).powf(APPROACH_EXPONENT);
            let pin = expected.pin[disc];
            let closed = pin / mechanism.pin_stiffness[disc]
                + (pin / mechanism.hole_stiffness).powf(APPROACH_EXPONENT);
            laws.pin[disc] = pin / closed;
        }
        laws
    }
}

/// An equilibrium by secants, and the forces to expect at the next position of the crank.
#[inline(always)]
#[must_use]
pub fn solve(
    mechanism: &Mechanism,
    position: &Position,
    torque: f64,
    start: Option<(&Motion, &Expected)>,
) -> (Equilibrium, Expected) {
    let (mut motion, mut expected, solutions) = match start {
        Some((motion, expected)) => (*motion, *expected, 1),
        None => {
            let full = Loaded::full(mechanism, position);
            let expected = Expected::first(mechanism, torque);
            (full.first_motion(torque), expected, FIRST_SOLUTIONS)
        }
    };
    let mut found = Equilibrium::default();
    for _ in 0..solutions {
        let laws = SecantLaws::at(mechanism, &expected);
        let loaded = Loaded::new(mechanism, position, laws, TOLERANCE);
        found = loaded.solve(torque, &motion);
        motion = found.motion;
        expected = Expected::of(&loaded, &motion, mechanism.discs, &expected);
    }
    (found, expected)
}

/// Force-weighted mean of penetrations: sum of squares over sum.
#[inline(always)]
pub(crate) fn weighted_mean(depths: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut squares) = (0.0, 0.0);
    for depth in depths {
        let depth = depth.max(0.0);
        sum += depth;
        squares += depth * depth;
    }
    (sum > LEAST_DEPTH).then(|| squares / sum)
}
