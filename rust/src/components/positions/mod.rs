//! Positions of the crank side by side, one a lane of the machine's vectors: contacts, equilibria,
//! forces, input torques and backlash.

mod contacts;
mod equilibrium;
mod forces;
mod free;
mod laws;
mod vector;

use pulp::Simd;

use crate::components::contact::PowerLaws;
use crate::components::equilibrium::{Loaded as One, Motion};
use crate::components::forces::{AtPosition, Factors};
use crate::components::laws::APPROACH_EXPONENT;
use crate::components::mechanism::{Circle, MAX_DISCS, Mechanism};
use crate::components::positions::contacts::{Nobody, Pins, Ring};
use crate::components::positions::equilibrium::{Loaded, Motions, Terms};
use crate::components::positions::forces::Gather;
use crate::components::positions::free::InputTorque;
use crate::components::positions::laws::{Power, Secant};
use crate::components::positions::vector::{Column, Vector};
use crate::components::turn::Engine;
use crate::components::{equilibrium as one, quadratic};

/// Newton steps for which secants follow the penetrations before they are kept.
const FOLLOWING: u32 = 4;

/// Memory for a group of positions.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    rings: [Ring; MAX_DISCS],
    pins: [Pins; MAX_DISCS],
    ring_forces: Column,
    pin_forces: Column,
    /// Equal parts of a turn by their number, as far as they have been needed.
    parts: Vec<Circle>,
}

impl Memory {
    /// Makes sure that a turn in `count` equal parts is at hand.
    fn divide(&mut self, count: usize) {
        if self.parts.len() <= count {
            self.parts.resize(count + 1, Circle::default());
        }
        let circle = &mut self.parts[count];
        if circle.cos.is_empty() {
            circle.divide(count, 0.0);
        }
    }
}

/// As many positions of the crank as there are lanes.
pub(crate) struct Group<'a, S: Simd> {
    loaded: Loaded<'a, S>,
    cranks: &'a [f64],
    engine: Engine,
    laws: PowerLaws,
    secant: Secant<S>,
    terms: Terms<S>,
    /// The last equilibria found.
    motion: Motions<S>,
    forces: [&'a mut Column; 2],
}

/// How the equilibria of a group were found.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Found {
    /// By the full engine, one of them at least.
    pub by_full: bool,
    /// One of them not at all.
    pub failed: bool,
}

impl<'a, S: Simd> Group<'a, S> {
    /// Positions with the crank at these angles (rad), of a number that [`lanes`] tells.
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        mechanism: &'a Mechanism,
        engine: Engine,
        cranks: &'a [f64],
        memory: &'a mut Memory,
    ) -> Self {
        memory.divide(mechanism.ring_pins());
        memory.divide(mechanism.output_pins);
        let mut angles = [0.0; 64];
        let angles = &mut angles[..cranks.len()];
        for disc in 0..mechanism.discs {
            for (angle, crank) in angles.iter_mut().zip(cranks) {
                *angle = mechanism.disc_angle(*crank, disc);
            }
            let circle = &memory.parts[mechanism.ring_pins()];
            memory.rings[disc].set(simd, mechanism, circle, angles);
            for (angle, crank) in angles.iter_mut().zip(cranks) {
                *angle += crank / mechanism.lobes as f64 - mechanism.hole_clocking;
            }
            let circle = &memory.parts[mechanism.output_pins];
            memory.pins[disc].set(simd, mechanism, circle, angles);
        }
        let loaded = Loaded {
            simd,
            mechanism,
            rings: &memory.rings,
            pins: &memory.pins,
        };
        let laws = PowerLaws::of(mechanism);
        Self {
            loaded,
            cranks,
            engine,
            laws,
            secant: Secant::at(simd, laws, 1e-6, 1e-6),
            terms: loaded.no_terms(),
            motion: Motions::zero(simd),
            forces: [&mut memory.ring_forces, &mut memory.pin_forces],
        }
    }

    /// Goes to a first guess for a torque (N m).
    #[inline(always)]
    pub(crate) fn guess(&mut self, torque: f64) {
        let mechanism = self.loaded.mechanism;
        let share = torque.abs() / mechanism.discs as f64;
        let force = 4.0 * share / (mechanism.ring_lever() * mechanism.ring_pins() as f64);
        let ring_depth = (force / mechanism.ring_stiffness).powf(APPROACH_EXPONENT);
        let force = 4.0 * share / (mechanism.pin_circle_radius * mechanism.output_pins as f64);
        let hole_depth = (force / mechanism.hole_stiffness).powf(APPROACH_EXPONENT);
        let pin_depth = hole_depth + force / mechanism.pin_stiffness[0];
        self.secant = Secant::at(self.loaded.simd, self.laws, ring_depth, pin_depth);
        let sense = if torque < 0.0 { -1.0 } else { 1.0 };
        self.motion = self.loaded.first_motion(sense, ring_depth, pin_depth);
    }

    /// Goes to what the last equilibria would be for the other sense of the torque.
    #[inline(always)]
    pub(crate) fn mirror(&mut self) {
        self.motion = self.motion.mirrored();
    }

    /// Goes on to the equilibria under an output torque (N m).
    #[inline(always)]
    pub(crate) fn solve(&mut self, torque: f64) -> Found {
        let force = torque / self.loaded.mechanism.pin_circle_radius;
        let loaded = self.loaded;
        let (motion, terms) = (&mut self.motion, &mut self.terms);
        let found = match self.engine {
            Engine::Full => {
                let mut laws = Power::<S, 3>::new(loaded.simd, self.laws);
                let least = (one::TOLERANCE, one::ACCEPTED);
                loaded.solve(&mut laws, force, motion, terms, least)
            }
            Engine::Quadratic => {
                self.secant.follows = FOLLOWING;
                let least = (quadratic::TOLERANCE, quadratic::TOLERANCE);
                loaded.solve(&mut self.secant, force, motion, terms, least)
            }
        };
        let mut status = Found {
            by_full: self.engine == Engine::Full,
            failed: false,
        };
        if found.not().any() {
            let one = Vector::splat(loaded.simd, 1.0);
            let found = found.keep(one);
            self.solve_alone(torque, found.as_slice(), &mut status);
        }
        status
    }

    /// Solves what was not found side by side once more, one by one, by the full engine.
    #[inline(never)]
    fn solve_alone(&mut self, torque: f64, found: &[f64], status: &mut Found) {
        use crate::components::mechanism::{Circles, Position};
        let mechanism = self.loaded.mechanism;
        let mut circles = Circles::default();
        circles.set(mechanism);
        status.by_full = true;
        for (lane, crank) in self.cranks.iter().enumerate() {
            if found[lane] != 0.0 {
                continue;
            }
            let mut position = Position::default();
            position.set(mechanism, &circles, *crank);
            let alone = One::full(mechanism, &position);
            let result = alone.solve(torque, &alone.first_motion(torque));
            status.failed |= !result.converged;
            self.put_motion(lane, &result.motion);
        }
    }

    fn put_motion(&mut self, lane: usize, motion: &Motion) {
        self.motion.flange.as_mut_slice()[lane] = motion.flange;
        for (to, from) in self.motion.discs.iter_mut().zip(&motion.discs) {
            for (to, from) in to.iter_mut().zip(from) {
                to.as_mut_slice()[lane] = *from;
            }
        }
    }

    /// Goes to a motion, in all lanes.
    pub(crate) fn put(&mut self, motion: &Motion) {
        for lane in 0..Vector::<S>::LANES {
            self.put_motion(lane, motion);
        }
    }

    /// Writes the flange's motions (m at R_OP).
    #[inline(always)]
    pub(crate) fn flange(&self, to: &mut [f64]) {
        to.copy_from_slice(self.motion.flange.as_slice());
    }

    /// Writes the flange's stiffnesses (N/m at R_OP) by the power laws.
    #[inline(always)]
    pub(crate) fn stiffness(&mut self, to: &mut [f64]) {
        let mut laws = Power::<S, 3>::new(self.loaded.simd, self.laws);
        let terms = &mut self.terms;
        self.loaded
            .set_terms(terms, &mut laws, &self.motion, 0.0, &mut Nobody);
        to.copy_from_slice(self.loaded.stiffness(terms).as_slice());
    }

    /// Hands on the forces by the power laws, and writes the flange's stiffnesses.
    #[inline(always)]
    pub(crate) fn forces(
        &mut self,
        factors: &Factors,
        to: &mut [f64],
        put: impl FnMut(AtPosition<&[f64]>),
    ) {
        let loaded = self.loaded;
        let mut laws = Power::<S, 3>::new(loaded.simd, self.laws);
        let [ring, pins] = &mut self.forces;
        let mut gather = Gather::new(loaded.simd, factors, loaded.mechanism, ring, pins);
        loaded.set_terms(&mut self.terms, &mut laws, &self.motion, 0.0, &mut gather);
        gather.finish(loaded.mechanism, &self.motion, put);
        to.copy_from_slice(loaded.stiffness(&self.terms).as_slice());
    }

    /// Writes the torques (N m) at the input that hold the equilibria under an output torque
    /// without friction, by virtual work: `T / N + dU / d theta`.
    #[inline(always)]
    pub(crate) fn input_torque(&mut self, torque: f64, to: &mut [f64]) {
        let loaded = self.loaded;
        let mut laws = Power::<S, 3>::new(loaded.simd, self.laws);
        let mut input = InputTorque::new(&loaded, &self.motion);
        loaded.set_terms(&mut self.terms, &mut laws, &self.motion, 0.0, &mut input);
        let sums = input.sum + torque / loaded.mechanism.lobes as f64;
        to.copy_from_slice(sums.as_slice());
    }

    /// Writes the flange's free turns (m at R_OP).
    #[inline(always)]
    pub(crate) fn backlash(&self, to: &mut [f64]) {
        to.copy_from_slice(free::backlash(&self.loaded).as_slice());
    }

    /// Takes over where flange and discs stood in another group.
    #[inline(always)]
    pub(crate) fn go_on_from(&mut self, before: &State<S>) {
        (self.motion, self.secant) = (before.0, before.1);
    }

    /// Where flange and discs stand.
    #[inline(always)]
    pub(crate) fn state(&self) -> State<S> {
        State(self.motion, self.secant)
    }
}

/// Equilibria to go on from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct State<S: Simd>(Motions<S>, Secant<S>);

/// Positions that go side by side.
#[inline(always)]
pub(crate) const fn lanes<S: Simd>() -> usize {
    Vector::<S>::LANES
}
