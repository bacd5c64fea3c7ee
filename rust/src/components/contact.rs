//! The laws of a drive's contacts: power laws with bending pins for the full engine, and straight
//! ones, secants at the expected forces, for the quadratic engine.

use crate::components::laws::ninth_root;
use crate::components::mechanism::{MAX_DISCS, Mechanism};

/// Penetrations below it count as none (m).
pub(crate) const LEAST_DEPTH: f64 = 1e-250;

/// Forces of a drive's contacts at penetrations of `LEAST_DEPTH` and more.
pub trait ContactLaws: Copy {
    /// Force over penetration, and slope of the force (N/m), of a ring contact of a disc.
    fn ring(&self, disc: usize, depth: f64) -> (f64, f64);
    /// Force (N) and its slope (N/m) of an output contact of a disc.
    fn pin(&self, disc: usize, depth: f64) -> (f64, f64);
}

/// `F = k p^(10/9)` at the ring; `p = F / k_pin + (F / k_hole)^0.9` at the output pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaws {
    pub(crate) ring: f64,
    pub(crate) hole: f64,
    /// Hole's stiffness over the pin's.
    pub(crate) ratio: [f64; MAX_DISCS],
}

impl PowerLaws {
    /// The laws of a drive.
    #[inline(always)]
    #[must_use]
    pub fn of(mechanism: &Mechanism) -> Self {
        Self {
            ring: mechanism.ring_stiffness,
            hole: mechanism.hole_stiffness,
            ratio: mechanism
                .pin_stiffness
                .map(|pin| mechanism.hole_stiffness / pin),
        }
    }
}

impl ContactLaws for PowerLaws {
    #[inline(always)]
    fn ring(&self, _: usize, depth: f64) -> (f64, f64) {
        let secant = self.ring * ninth_root(depth);
        (secant, 10.0 / 9.0 * secant)
    }

    #[inline(always)]
    fn pin(&self, disc: usize, depth: f64) -> (f64, f64) {
        // In s = (F / k_hole)^0.9, where the equation is nearly straight.
        let ratio = self.ratio[disc];
        // The first guess is within a factor (1 + ratio root)^(1/9); each step squares the miss.
        let mut s = depth / (1.0 + ratio * ninth_root(depth));
        for _ in 0..4 {
            let root = ninth_root(s);
            let miss = s + ratio * s * root - depth;
            s -= miss / (1.0 + 10.0 / 9.0 * ratio * root);
        }
        let root = ninth_root(s);
        let growth = 10.0 / 9.0 * root;
        (
            self.hole * s * root,
            self.hole * growth / (1.0 + ratio * growth),
        )
    }
}

/// Straight laws, of each disc.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SecantLaws {
    /// Ring contact (N/m).
    pub ring: [f64; MAX_DISCS],
    /// Output contact with its pin (N/m).
    pub pin: [f64; MAX_DISCS],
}

impl ContactLaws for SecantLaws {
    #[inline(always)]
    fn ring(&self, disc: usize, _: f64) -> (f64, f64) {
        (self.ring[disc], self.ring[disc])
    }

    #[inline(always)]
    fn pin(&self, disc: usize, depth: f64) -> (f64, f64) {
        (self.pin[disc] * depth, self.pin[disc])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_contact_closes_as_its_parts_do() {
        for ratio in [0.0, 0.3, 4.0, 60.0, 1000.0] {
            let laws = PowerLaws {
                ring: 1.0,
                hole: 7e8,
                ratio: [ratio; MAX_DISCS],
            };
            for depth in [1e-12, 1e-9, 1e-6, 3e-5, 1e-3] {
                let (force, slope) = laws.pin(0, depth);
                let closed = (force / 7e8).powf(0.9) + force * ratio / 7e8;
                assert!((closed / depth - 1.0).abs() < 1e-12, "{ratio} {depth}");
                let further = laws.pin(0, depth * (1.0 + 1e-6)).0;
                let secant = (further - force) / (depth * 1e-6);
                assert!((secant / slope - 1.0).abs() < 1e-5);
            }
        }
    }
}
