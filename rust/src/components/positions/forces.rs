//! Forces, pressures, losses and shares of the twist at positions of the crank side by side.

use pulp::Simd;

use crate::components::forces::{ACTIVE_SHARE, AtPosition, Factors};
use crate::components::mechanism::Mechanism;
use crate::components::positions::contacts::{PinContacts, RingContacts, Visit};
use crate::components::positions::equilibrium::{Motions, bearing};
use crate::components::positions::vector::{Column, Vector};

/// Forces gathered while an equilibrium's contacts are summed.
pub(crate) struct Gather<'a, S: Simd> {
    simd: S,
    factors: &'a Factors,
    ring: Shared<'a, S>,
    pins: Shared<'a, S>,
    budget_ring: Vector<S>,
    budget_pins: Vector<S>,
    /// Sum of the squares of each disc's forces on pins, of this disc and of all weighed by the
    /// pins' flexibilities.
    squares: Vector<S>,
    bending: Vector<S>,
    root: Vector<S>,
    clearance: Vector<S>,
    /// Forces times levers, of this disc.
    torque: Vector<S>,
    torques: Vector<S>,
    largest_torque: Vector<S>,
    /// Largest force times curvature at the ring.
    pressure: Vector<S>,
    /// Number of the pin that has it.
    pressure_pin: Vector<S>,
    /// Number of the most loaded output pin.
    largest_pin: Vector<S>,
    /// Largest moment at a pin's root.
    moment: Vector<S>,
    /// Ring forces times the distance of contact and pitch point over R.
    sliding: Vector<S>,
    disc: usize,
}

/// How a kind of contact shares its load.
struct Shared<'a, S: Simd> {
    forces: &'a mut [S::f64s],
    count: usize,
    sum: Vector<S>,
    squares: Vector<S>,
    largest: Vector<S>,
}

impl<'a, S: Simd> Shared<'a, S> {
    #[inline(always)]
    fn new(simd: S, forces: &'a mut [S::f64s]) -> Self {
        let zero = Vector::zero(simd);
        Self {
            forces,
            count: 0,
            sum: zero,
            squares: zero,
            largest: zero,
        }
    }

    #[inline(always)]
    fn add(&mut self, force: Vector<S>) {
        if let Some(place) = self.forces.get_mut(self.count) {
            *place = force.raw();
            self.count += 1;
        }
        self.sum += force;
        self.squares += force * force;
        self.largest = self.largest.max(force);
    }

    /// Contacts that are active.
    #[inline(always)]
    fn active(&self, simd: S) -> Vector<S> {
        let threshold = self.largest * ACTIVE_SHARE;
        let one = Vector::splat(simd, 1.0);
        let mut count = Vector::zero(simd);
        for force in &self.forces[..self.count] {
            count += Vector::new(simd, *force).above(threshold).keep(one);
        }
        count
    }
}

impl<'a, S: Simd> Gather<'a, S> {
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        factors: &'a Factors,
        mechanism: &Mechanism,
        ring: &'a mut Column,
        pins: &'a mut Column,
    ) -> Self {
        let lanes = Vector::<S>::LANES;
        ring.make_room(mechanism.discs * mechanism.ring_pins() * lanes);
        pins.make_room(mechanism.discs * mechanism.output_pins * lanes);
        let zero = Vector::zero(simd);
        Self {
            simd,
            factors,
            ring: Shared::new(simd, Vector::<S>::of_slice_mut(ring.get_mut())),
            pins: Shared::new(simd, Vector::<S>::of_slice_mut(pins.get_mut())),
            budget_ring: zero,
            budget_pins: zero,
            squares: zero,
            bending: zero,
            root: zero,
            clearance: zero,
            torque: zero,
            torques: zero,
            largest_torque: zero,
            pressure: zero,
            pressure_pin: zero,
            largest_pin: zero,
            moment: zero,
            sliding: zero,
            disc: 0,
        }
    }

    /// Closes a disc's sums.
    #[inline(always)]
    fn close(&mut self) {
        self.bending += self.squares * self.factors.bending[self.disc];
        self.root += self.squares * self.factors.root[self.disc];
        self.torques += self.torque;
        self.largest_torque = self.largest_torque.max(self.torque);
        self.squares = Vector::zero(self.simd);
        self.torque = Vector::zero(self.simd);
    }

    /// What comes of the forces at each position.
    #[inline(always)]
    pub(crate) fn finish(
        mut self,
        mechanism: &Mechanism,
        motion: &Motions<S>,
        mut put: impl FnMut(AtPosition<&[f64]>),
    ) {
        self.close();
        let zero = Vector::zero(self.simd);
        let (mut friction, mut largest, mut work) = (zero, zero, zero);
        let mut least = Vector::splat(self.simd, f64::INFINITY);
        for [_, dx, dy] in motion.discs[..mechanism.discs].iter().copied() {
            let ([x, y], _) = bearing(self.simd, mechanism, [dx, dy]);
            let force = (x * x + y * y).sqrt();
            largest = largest.max(force);
            least = least.min(force);
            friction += force;
            work += x * dx + y * dy;
        }
        let taken_up = friction * mechanism.bearing_clearance;
        let bent = self.bending + self.root;
        let one = Vector::splat(self.simd, 1.0);
        let some = self.pins.squares.above(zero);
        let effective =
            some.keep(self.pins.sum * self.pins.sum / some.select(self.pins.squares, one));
        let turned = self.torques.above(zero);
        let share = turned.keep(self.largest_torque / turned.select(self.torques, one));
        put(AtPosition {
            ring: self.budget_ring.as_slice(),
            output: (self.budget_pins - bent).as_slice(),
            bending: self.bending.as_slice(),
            root: self.root.as_slice(),
            bearing: (work - taken_up).as_slice(),
            clearance: (self.clearance + taken_up).as_slice(),
            torque: self.torques.as_slice(),
            active_pins: self.pins.active(self.simd).as_slice(),
            effective_pins: effective.as_slice(),
            active_ring: self.ring.active(self.simd).as_slice(),
            ring_force: self.ring.largest.as_slice(),
            pin_force: self.pins.largest.as_slice(),
            share: share.as_slice(),
            bearing_force: largest.as_slice(),
            bearing_least: least.as_slice(),
            ring_pin: self.pressure_pin.as_slice(),
            output_pin: self.largest_pin.as_slice(),
            moment: self.moment.as_slice(),
            ring_pressure: self.pressure.as_slice(),
            ring_sliding: self.sliding.as_slice(),
            pin_forces: self.pins.sum.as_slice(),
            bearing_forces: friction.as_slice(),
        });
    }
}

impl<S: Simd> Visit<S> for Gather<'_, S> {
    #[inline(always)]
    fn ring(&mut self, disc: usize, contacts: &RingContacts<S>) {
        if disc != self.disc {
            self.close();
            self.disc = disc;
        }
        let RingContacts {
            force,
            depth,
            gap,
            length,
            ..
        } = *contacts;
        self.ring.add(force);
        self.budget_ring += force * depth;
        self.clearance += force * gap;
        // Curvature of the path of a pin's centre, with the cosine by the law of cosines.
        let factors = self.factors;
        let square = length * length;
        let bend = square * factors.bend_of_square + factors.bend;
        let path = bend / (square * length);
        let one = Vector::splat(self.simd, 1.0);
        let curvature = path / (one - path * factors.pin_radius) + factors.pin_curvature;
        let pressure = force * curvature;
        let worse = pressure.above(self.pressure);
        self.pressure_pin = worse.select(contacts.pin, self.pressure_pin);
        self.pressure = self.pressure.max(pressure);
        self.sliding += force * (length * factors.ring_radius - factors.pin_radius).abs();
    }

    #[inline(always)]
    fn pin(&mut self, disc: usize, contacts: &PinContacts<S>) {
        if disc != self.disc {
            self.close();
            self.disc = disc;
        }
        let force = contacts.force;
        let e = self.factors.eccentricity;
        let worse = force.above(self.pins.largest);
        let pin = Vector::splat(self.simd, contacts.pin as f64);
        self.largest_pin = worse.select(pin, self.largest_pin);
        self.moment = self.moment.max(force * self.factors.reach[disc]);
        self.pins.add(force);
        self.squares += force * force;
        self.budget_pins += force * contacts.depth;
        let one = Vector::splat(self.simd, 1.0);
        self.clearance += force * (contacts.gap + (one - contacts.line[0]) * e);
        self.torque -= force * contacts.along;
    }
}
