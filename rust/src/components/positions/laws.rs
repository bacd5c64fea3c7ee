//! The laws of contacts for positions side by side: power laws, and straight ones whose slopes
//! follow the loaded contacts.

use pulp::Simd;

use crate::components::contact::PowerLaws;
use crate::components::mechanism::MAX_DISCS;
use crate::components::positions::vector::{Mask, Vector, closed, ninth_root};

/// Penetrations up to it count as none (m).
pub(crate) const LEAST_DEPTH: f64 = 1e-100;

/// Sum of the penetrations (m) of loaded contacts, and of their squares.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Depths<S: Simd> {
    pub sum: Vector<S>,
    pub squares: Vector<S>,
}

/// Forces of contacts at penetrations above [`LEAST_DEPTH`], but for a factor that all contacts of
/// a kind on a disc share.
pub(crate) trait Laws<S: Simd>: Copy {
    /// Whether the shared factors follow the penetrations.
    const FOLLOWS: bool;
    /// Force over penetration, and slope of the force (N/m), of a ring contact.
    fn ring(&self, depth: Vector<S>) -> (Vector<S>, Vector<S>);
    /// Force (N) and its slope (N/m) of an output contact of a disc.
    fn pin(&self, disc: usize, depth: Vector<S>) -> (Vector<S>, Vector<S>);
    /// Called before every step of Newton's.
    #[inline(always)]
    fn next_step(&mut self) {}
    /// The factor of a disc's ring contacts.
    fn ring_factor(&mut self, disc: usize, depths: &Depths<S>) -> Vector<S>;
    /// The factor of a disc's output contacts.
    fn pin_factor(&mut self, disc: usize, depths: &Depths<S>) -> Vector<S>;
}

/// The power laws, by this many steps of each root.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Power<S: Simd, const STEPS: usize> {
    simd: S,
    laws: PowerLaws,
}

impl<S: Simd, const STEPS: usize> Power<S, STEPS> {
    #[inline(always)]
    pub(crate) fn new(simd: S, laws: PowerLaws) -> Self {
        Self { simd, laws }
    }
}

impl<S: Simd, const STEPS: usize> Laws<S> for Power<S, STEPS> {
    const FOLLOWS: bool = false;

    #[inline(always)]
    fn ring(&self, depth: Vector<S>) -> (Vector<S>, Vector<S>) {
        let secant = ninth_root::<S, STEPS>(depth) * self.laws.ring;
        (secant, secant * (10.0 / 9.0))
    }

    #[inline(always)]
    fn pin(&self, disc: usize, depth: Vector<S>) -> (Vector<S>, Vector<S>) {
        let ratio = Vector::splat(self.simd, self.laws.ratio[disc]);
        let (s, root) = closed::<S, STEPS>(depth, ratio);
        let growth = root * (10.0 / 9.0);
        let force = s * root * self.laws.hole;
        (force, growth * self.laws.hole / (ratio * growth + 1.0))
    }

    #[inline(always)]
    fn ring_factor(&mut self, _: usize, _: &Depths<S>) -> Vector<S> {
        Vector::splat(self.simd, 1.0)
    }

    #[inline(always)]
    fn pin_factor(&mut self, _: usize, _: &Depths<S>) -> Vector<S> {
        Vector::splat(self.simd, 1.0)
    }
}

/// Straight laws: secants of the power laws at the mean penetration of a disc's loaded contacts,
/// each weighed by its own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Secant<S: Simd> {
    simd: S,
    laws: Power<S, 2>,
    ring: [Vector<S>; MAX_DISCS],
    pin: [Vector<S>; MAX_DISCS],
    /// Newton steps for which the secants still follow the penetrations.
    pub follows: u32,
}

impl<S: Simd> Secant<S> {
    /// Secants at these penetrations (m) of ring and output contacts.
    #[inline(always)]
    pub(crate) fn at(simd: S, laws: PowerLaws, ring_depth: f64, pin_depth: f64) -> Self {
        let laws = Power::new(simd, laws);
        let ring = laws.ring(Vector::splat(simd, ring_depth)).0;
        let depth = Vector::splat(simd, pin_depth);
        let mut pin = [depth; MAX_DISCS];
        for (disc, secant) in pin.iter_mut().enumerate() {
            *secant = laws.pin(disc, depth).0 / depth;
        }
        Self {
            simd,
            laws,
            ring: [ring; MAX_DISCS],
            pin,
            follows: 0,
        }
    }
}

impl<S: Simd> Depths<S> {
    /// Of no contact.
    #[inline(always)]
    pub(crate) fn none(simd: S) -> Self {
        let zero = Vector::zero(simd);
        Self {
            sum: zero,
            squares: zero,
        }
    }

    /// Counts a contact; its depth is zero where it is not loaded.
    #[inline(always)]
    pub(crate) fn add(&mut self, depth: Vector<S>) {
        self.sum += depth;
        self.squares += depth * depth;
    }

    /// Where contacts are loaded, and their mean penetration (m), each weighed by its own.
    #[inline(always)]
    fn mean(&self, simd: S) -> (Mask<S>, Vector<S>) {
        let least = Vector::splat(simd, LEAST_DEPTH);
        let loaded = self.sum.above(least);
        let mean = loaded.select(self.squares / self.sum, least).max(least);
        (loaded, mean)
    }
}

impl<S: Simd> Laws<S> for Secant<S> {
    const FOLLOWS: bool = true;

    #[inline(always)]
    fn ring(&self, _: Vector<S>) -> (Vector<S>, Vector<S>) {
        let one = Vector::splat(self.simd, 1.0);
        (one, one)
    }

    #[inline(always)]
    fn pin(&self, _: usize, depth: Vector<S>) -> (Vector<S>, Vector<S>) {
        (depth, Vector::splat(self.simd, 1.0))
    }

    #[inline(always)]
    fn next_step(&mut self) {
        self.follows = self.follows.saturating_sub(1);
    }

    #[inline(always)]
    fn ring_factor(&mut self, disc: usize, depths: &Depths<S>) -> Vector<S> {
        if self.follows > 0 {
            let (loaded, mean) = depths.mean(self.simd);
            self.ring[disc] = loaded.select(self.laws.ring(mean).0, self.ring[disc]);
        }
        self.ring[disc]
    }

    #[inline(always)]
    fn pin_factor(&mut self, disc: usize, depths: &Depths<S>) -> Vector<S> {
        if self.follows > 0 {
            let (loaded, mean) = depths.mean(self.simd);
            let secant = self.laws.pin(disc, mean).0 / mean;
            self.pin[disc] = loaded.select(secant, self.pin[disc]);
        }
        self.pin[disc]
    }
}
