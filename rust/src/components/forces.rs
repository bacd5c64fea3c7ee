//! Forces, pressures, losses and shares of the twist at rated torque, gathered over the positions of
//! the crank.

use crate::components::contact::PowerLaws;
use crate::components::equilibrium::{Loaded, Motion};
use crate::components::inputs::PartInput;
use crate::components::laws::hertz;
use crate::components::mechanism::Mechanism;
use crate::components::outputs::PartOutput;
use crate::components::parts::Parts;
use crate::components::turn::{ARCMIN, POSITIONS};
use crate::model::inputs::Input;

/// A contact is active when its force is above this share of the largest of its kind.
pub const ACTIVE_SHARE: f64 = 0.01;

/// Twist times torque of each kind of part (N m), and what sums up to it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Budget {
    /// Ring contacts.
    pub ring: f64,
    /// Holes' contacts.
    pub output: f64,
    /// Bending and shear of the output pins.
    pub bending: f64,
    /// Roots of the output pins.
    pub root: f64,
    /// Eccentric's bearings.
    pub bearing: f64,
    /// Clearances taken up, and the turn of the line of centres.
    pub clearance: f64,
}

/// What is gathered.
#[derive(Debug, Clone, Default)]
pub struct RatedForces {
    ring: Vec<f64>,
    pins: Vec<f64>,
    budget: Budget,
    /// Sum of the forces at R_OP (N).
    torque: f64,
    active_pins: [f64; 3],
    effective: f64,
    active_ring: f64,
    largest: [f64; 2],
    share: f64,
    bearing: f64,
    /// Largest force times curvature at the ring.
    ring_pressure: f64,
    /// Sums of force times sliding speed over that of the crank (N m).
    losses: [f64; 3],
}

/// Mean and extremes of the sharing at one position.
fn active(forces: &[f64]) -> (f64, f64, f64) {
    let largest = forces.iter().fold(0.0_f64, |a, b| a.max(*b));
    let threshold = ACTIVE_SHARE * largest;
    let count = forces.iter().filter(|force| **force > threshold).count();
    let (sum, squares) = forces
        .iter()
        .fold((0.0, 0.0), |(sum, squares), f| (sum + f, squares + f * f));
    let effective = if squares > 0.0 {
        sum * sum / squares
    } else {
        0.0
    };
    (count as f64, effective, largest)
}

impl RatedForces {
    /// Forgets everything, and keeps the memory.
    pub fn clear(&mut self) {
        let (ring, pins) = (
            std::mem::take(&mut self.ring),
            std::mem::take(&mut self.pins),
        );
        *self = Self {
            ring,
            pins,
            ..Self::default()
        };
    }

    /// Adds one position of the crank.
    #[inline(always)]
    pub fn add(
        &mut self,
        parts: &Parts,
        mechanism: &Mechanism,
        loaded: &Loaded<'_, PowerLaws>,
        motion: &Motion,
    ) {
        self.ring.clear();
        self.pins.clear();
        let [_, discs, count] = parts.counts;
        let lobes = mechanism.lobes as f64;
        // Speeds for a crank that turns by one radian a second.
        let (spin, slip) = (1.0 / lobes, mechanism.eccentricity * (lobes + 1.0) / lobes);
        let bore = parts.scalar(Input::DiscBoreRadius);
        let [friction_ring, friction_output, friction_bearing] = [
            PartInput::FrictionRing,
            PartInput::FrictionOutput,
            PartInput::FrictionBearing,
        ]
        .map(|input| parts.value(input));
        let mut torques = 0.0_f64;
        let mut largest_torque = 0.0_f64;
        for disc in 0..discs {
            let profile = &parts.profile;
            let from = self.ring.len();
            loaded.ring_forces(disc, motion, &mut self.ring);
            for contact in loaded.ring_contacts(disc, motion, &self.ring[from..]) {
                if contact.force > 0.0 {
                    self.budget.ring += contact.force * contact.depth;
                    self.budget.clearance += contact.force * contact.gap;
                    let curvature = profile.contact_curvature(contact.cosine);
                    self.ring_pressure = self.ring_pressure.max(contact.force * curvature);
                    let lever = contact.to_pitch - profile.pin_radius;
                    self.losses[0] += friction_ring * contact.force * spin * lever.abs();
                }
            }
            let from = self.pins.len();
            let mut torque = 0.0;
            loaded.pin_forces(disc, motion, &mut self.pins);
            for contact in loaded.pin_contacts(disc, motion, &self.pins[from..]) {
                let force = contact.force;
                if force > 0.0 {
                    let flexibility = parts.pins[disc];
                    let bending = force * flexibility.bending;
                    let root = force * flexibility.root;
                    self.budget.bending += force * bending;
                    self.budget.root += force * root;
                    self.budget.output += force * (contact.depth - bending - root);
                    self.budget.clearance += force * contact.taken_up;
                    torque -= force * contact.along;
                }
            }
            let sum: f64 = self.pins[from..].iter().sum();
            self.losses[1] += friction_output * sum * slip;
            let [x, y] = loaded.bearing_force(disc, motion);
            let force = x.hypot(y);
            self.bearing = self.bearing.max(force);
            self.losses[2] += friction_bearing * force * bore * (1.0 + spin);
            let [_, dx, dy] = motion.discs[disc];
            let taken_up = parts.value(PartInput::BearingClearance) * force;
            self.budget.bearing += x * dx + y * dy - taken_up;
            self.budget.clearance += taken_up;
            torques += torque;
            self.torque += torque;
            largest_torque = largest_torque.max(torque);
        }
        if torques > 0.0 {
            self.share = self.share.max(largest_torque / torques);
        }
        let (pins, effective, largest) = active(&self.pins);
        let [sum, least, most] = &mut self.active_pins;
        *least = if *sum > 0.0 { least.min(pins) } else { pins };
        *most = most.max(pins);
        *sum += pins;
        self.effective += effective;
        self.largest[1] = self.largest[1].max(largest);
        let (ring, _, largest) = active(&self.ring);
        self.active_ring += ring;
        self.largest[0] = self.largest[0].max(largest);
        debug_assert_eq!(self.pins.len(), discs * count);
    }

    /// Twist times torque of each kind of part, summed over the positions.
    #[must_use]
    pub const fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Sum over the positions of the forces at R_OP (N).
    #[must_use]
    pub const fn torque(&self) -> f64 {
        self.torque
    }

    /// Largest pressures (Pa) at ring and output contacts.
    #[must_use]
    pub fn pressures(&self, parts: &Parts) -> [f64; 2] {
        let [ring, disc, pin] = parts.materials();
        let width = parts.value(PartInput::DiscWidth);
        // Pressure goes with the root of force times curvature.
        let line_load = [self.ring_pressure, self.largest[1]].map(|force| force / width);
        let at_ring = hertz(line_load[0], 1.0, ring, disc).pressure;
        let at_hole = hertz(line_load[1], parts.hole_curvature(), pin, disc).pressure;
        [at_ring, at_hole]
    }

    /// Writes the columns.
    #[inline(always)]
    pub fn put(&self, parts: &Parts, put: &mut impl FnMut(PartOutput, f64)) {
        let mean = 1.0 / POSITIONS as f64;
        let to_twist = mean / (parts.torque * ARCMIN);
        let budget = &self.budget;
        put(PartOutput::TwistRing, budget.ring * to_twist);
        put(PartOutput::TwistOutputContact, budget.output * to_twist);
        put(PartOutput::TwistPinBending, budget.bending * to_twist);
        put(PartOutput::TwistPinRoot, budget.root * to_twist);
        put(PartOutput::TwistBearing, budget.bearing * to_twist);
        put(PartOutput::TwistClearance, budget.clearance * to_twist);
        let shaft = parts.torque * parts.shaft_compliance / ARCMIN;
        put(PartOutput::TwistShaft, shaft);
        put(PartOutput::ActiveOutputPinsMean, self.active_pins[0] * mean);
        put(PartOutput::ActiveOutputPinsMin, self.active_pins[1]);
        put(PartOutput::ActiveOutputPinsMax, self.active_pins[2]);
        put(PartOutput::EffectiveOutputPins, self.effective * mean);
        put(PartOutput::ActiveRingPinsMean, self.active_ring * mean);
        put(PartOutput::RingPinForceMax, self.largest[0]);
        put(PartOutput::OutputPinForceMax, self.largest[1]);
        put(PartOutput::DiscLoadShareMax, self.share);
        put(PartOutput::BearingForceMax, self.bearing);
        let [ring, output] = self.pressures(parts);
        put(PartOutput::RingPressureMax, ring * 1e-6);
        put(PartOutput::OutputPressureMax, output * 1e-6);
        let out = parts.torque / parts.counts[0] as f64;
        let losses = self.losses.map(|loss| loss * mean);
        let input = out + losses.iter().sum::<f64>();
        put(PartOutput::Efficiency, out / input);
        put(PartOutput::LossRing, losses[0] / input);
        put(PartOutput::LossOutput, losses[1] / input);
        put(PartOutput::LossBearing, losses[2] / input);
    }
}
