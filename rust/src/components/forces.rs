//! Forces, pressures, losses and shares of the twist at rated torque, gathered over the positions of
//! the crank.

use crate::components::details::Details;
use crate::components::inputs::PartInput;
use crate::components::laws::hertz;
use crate::components::mechanism::MAX_DISCS;
use crate::components::outputs::PartOutput;
use crate::components::parts::Parts;
use crate::components::turn::ARCMIN;
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

/// What comes of the forces at one position of the crank, or one list of each for several.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct AtPosition<T> {
    /// Twist times torque (N m), as in [`Budget`].
    pub ring: T,
    pub output: T,
    pub bending: T,
    pub root: T,
    pub bearing: T,
    pub clearance: T,
    /// Force at R_OP (N).
    pub torque: T,
    pub active_pins: T,
    pub effective_pins: T,
    pub active_ring: T,
    /// Largest forces (N).
    pub ring_force: T,
    pub pin_force: T,
    /// Largest share of a disc.
    pub share: T,
    pub bearing_force: T,
    pub bearing_least: T,
    /// Numbers of the ring pin with the largest pressure, counted on without end, and of the most
    /// loaded output pin.
    pub ring_pin: T,
    pub output_pin: T,
    /// Largest moment at an output pin's root (N m).
    pub moment: T,
    /// Largest force times curvature at the ring (N/m).
    pub ring_pressure: T,
    /// Sum of the ring's forces times the distances of contact and pitch point (N m).
    pub ring_sliding: T,
    /// Sums of the forces (N) on output pins and bearings.
    pub pin_forces: T,
    pub bearing_forces: T,
}

impl AtPosition<&[f64]> {
    /// That of one position.
    pub(crate) fn at(&self, position: usize) -> AtPosition<f64> {
        AtPosition {
            ring: self.ring[position],
            output: self.output[position],
            bending: self.bending[position],
            root: self.root[position],
            bearing: self.bearing[position],
            clearance: self.clearance[position],
            torque: self.torque[position],
            active_pins: self.active_pins[position],
            effective_pins: self.effective_pins[position],
            active_ring: self.active_ring[position],
            ring_force: self.ring_force[position],
            pin_force: self.pin_force[position],
            share: self.share[position],
            bearing_force: self.bearing_force[position],
            bearing_least: self.bearing_least[position],
            ring_pin: self.ring_pin[position],
            output_pin: self.output_pin[position],
            moment: self.moment[position],
            ring_pressure: self.ring_pressure[position],
            ring_sliding: self.ring_sliding[position],
            pin_forces: self.pin_forces[position],
            bearing_forces: self.bearing_forces[position],
        }
    }
}

/// What the sums over contacts need of a drive besides its mechanism.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors {
    /// Flexibilities (m/N) of the output pins and their roots under the force of each disc.
    pub bending: [f64; MAX_DISCS],
    pub root: [f64; MAX_DISCS],
    /// Reach of each disc's forces from the flange (m).
    pub reach: [f64; MAX_DISCS],
    pub pin_radius: f64,
    pub pin_curvature: f64,
    pub ring_radius: f64,
    pub eccentricity: f64,
    /// Bend of the path of a pin's centre times the cube of `l`, the distance from the pitch point
    /// over R: `bend + bend_of_square l^2` (1/m).
    pub bend: f64,
    pub bend_of_square: f64,
}

impl Factors {
    pub(crate) fn of(parts: &Parts) -> Self {
        let profile = &parts.profile;
        let pins = profile.lobes as f64 + 1.0;
        let width = profile.eccentricity * pins / profile.ring_radius;
        Self {
            bending: parts.pins.map(|pin| pin.bending),
            root: parts.pins.map(|pin| pin.root),
            reach: std::array::from_fn(|disc| {
                parts.value(PartInput::ALL[PartInput::Reach1 as usize + disc])
            }),
            pin_radius: profile.pin_radius,
            pin_curvature: 1.0 / profile.pin_radius,
            ring_radius: profile.ring_radius,
            eccentricity: profile.eccentricity,
            bend: 0.5 * (1.0 - pins) * (1.0 - width * width) / profile.ring_radius,
            bend_of_square: 0.5 * (1.0 + pins) / profile.ring_radius,
        }
    }
}

/// What is gathered over the positions.
#[derive(Debug, Clone, Default)]
pub struct RatedForces {
    /// Positions that were added.
    positions: f64,
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
    details: Details,
}

impl RatedForces {
    /// Adds one position of the crank (rad).
    pub(crate) fn add(&mut self, parts: &Parts, crank: f64, at: &AtPosition<f64>) {
        self.positions += 1.0;
        self.details.add(crank, at);
        let lobes = parts.counts[0] as f64;
        // Speeds for a crank that turns by one radian a second.
        let (spin, slip) = (
            1.0 / lobes,
            parts.profile.eccentricity * (lobes + 1.0) / lobes,
        );
        let friction = [
            PartInput::FrictionRing,
            PartInput::FrictionOutput,
            PartInput::FrictionBearing,
        ]
        .map(|input| parts.value(input));
        let bore = parts.scalar(Input::DiscBoreRadius);
        self.losses[0] += friction[0] * at.ring_sliding * spin;
        self.losses[1] += friction[1] * at.pin_forces * slip;
        self.losses[2] += friction[2] * at.bearing_forces * bore * (1.0 + spin);
        self.budget.ring += at.ring;
        self.budget.output += at.output;
        self.budget.bending += at.bending;
        self.budget.root += at.root;
        self.budget.bearing += at.bearing;
        self.budget.clearance += at.clearance;
        self.torque += at.torque;
        let [sum, least, most] = &mut self.active_pins;
        let pins = at.active_pins;
        *least = if *sum > 0.0 { least.min(pins) } else { pins };
        *most = most.max(pins);
        *sum += pins;
        self.effective += at.effective_pins;
        self.active_ring += at.active_ring;
        self.largest[0] = self.largest[0].max(at.ring_force);
        self.largest[1] = self.largest[1].max(at.pin_force);
        self.share = self.share.max(at.share);
        self.bearing = self.bearing.max(at.bearing_force);
        self.ring_pressure = self.ring_pressure.max(at.ring_pressure);
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

    /// What few queries ask for.
    pub(crate) const fn details(&self) -> &Details {
        &self.details
    }

    /// Writes the columns.
    #[inline(always)]
    pub fn put(&self, parts: &Parts, put: &mut impl FnMut(PartOutput, f64)) {
        let mean = 1.0 / self.positions;
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
