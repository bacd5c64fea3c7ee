//! Columns that few queries ask for: where the worst contacts are, how the largest forces change over
//! the crank, what comes near yield, and the drive without its clearances.

use crate::components::forces::AtPosition;
use crate::components::inputs::PartInput;
use crate::components::laws::{SHEAR_OF_PRESSURE, hertz};
use crate::components::mechanism::Mechanism;
use crate::components::outputs::PartOutput;
use crate::components::parts::Parts;
use crate::model::inputs::Input;

/// The largest of some quantity, and where it is.
#[derive(Debug, Clone, Copy, Default)]
struct Worst {
    value: f64,
    pin: f64,
    crank: f64,
}

impl Worst {
    const fn take(&mut self, value: f64, pin: f64, crank: f64) {
        if value > self.value {
            *self = Self { value, pin, crank };
        }
    }
}

/// What is gathered over the positions of the crank.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Details {
    /// Force times curvature at the ring, and force at the holes.
    ring: Worst,
    output: Worst,
    /// Smallest over the crank of the largest force of each kind.
    ring_peak: f64,
    output_peak: f64,
    /// Smallest force on a bearing.
    bearing: f64,
    /// Largest moment at a pin's root (N m).
    moment: f64,
}

impl Default for Details {
    fn default() -> Self {
        Self {
            ring: Worst::default(),
            output: Worst::default(),
            ring_peak: f64::INFINITY,
            output_peak: f64::INFINITY,
            bearing: f64::INFINITY,
            moment: 0.0,
        }
    }
}

impl Details {
    /// Adds one position of the crank (rad).
    pub(crate) fn add(&mut self, crank: f64, at: &AtPosition<f64>) {
        self.ring.take(at.ring_pressure, at.ring_pin, crank);
        self.output.take(at.pin_force, at.output_pin, crank);
        self.ring_peak = self.ring_peak.min(at.ring_force);
        self.output_peak = self.output_peak.min(at.pin_force);
        self.bearing = self.bearing.min(at.bearing_least);
        self.moment = self.moment.max(at.moment);
    }

    /// Writes the columns.
    pub(crate) fn put(&self, parts: &Parts, put: &mut impl FnMut(PartOutput, f64)) {
        let ring_pins = parts.counts[0] as f64 + 1.0;
        put(
            PartOutput::RingPressurePin,
            self.ring.pin.rem_euclid(ring_pins),
        );
        put(PartOutput::RingPressureCrank, self.ring.crank.to_degrees());
        put(PartOutput::OutputPressurePin, self.output.pin);
        put(
            PartOutput::OutputPressureCrank,
            self.output.crank.to_degrees(),
        );
        put(PartOutput::RingPinForcePeakMin, self.ring_peak);
        put(PartOutput::OutputPinForcePeakMin, self.output_peak);
        put(PartOutput::BearingForceMin, self.bearing);
        let (outer, bore) = (
            parts.scalar(Input::OutputPinDiameter),
            parts.scalar(Input::OutputPinBore),
        );
        let modulus = std::f64::consts::PI / 32.0 * (outer.powi(4) - bore.powi(4)) / outer;
        let stress = self.moment / modulus;
        put(PartOutput::PinRootStress, stress * 1e-6);
        let pin_yield = parts.value(PartInput::PinYieldStrength);
        put(PartOutput::PinYieldRatio, stress / pin_yield);
        let [ring, disc, pin] = parts.materials();
        let width = parts.value(PartInput::DiscWidth);
        // Pressure goes with the root of force times curvature.
        let at_ring = hertz(self.ring.value / width, 1.0, ring, disc).pressure;
        let at_hole = hertz(self.output.value / width, parts.hole_curvature(), pin, disc).pressure;
        // Yield begins below the surface where twice the largest shear stress reaches the strength.
        let stress = 2.0 * SHEAR_OF_PRESSURE.0 * at_ring.max(at_hole);
        let contact_yield = parts.value(PartInput::ContactYieldStrength);
        put(PartOutput::ContactYieldRatio, stress / contact_yield);
    }
}

/// The mechanism with every gap, modification and play taken out.
pub(crate) fn without_clearance(mechanism: &Mechanism) -> Mechanism {
    Mechanism {
        ring_gap: 0.0,
        ring_enlargement: 0.0,
        profile_rotation: 0.0,
        ring_gap_errors: Vec::new(),
        hole_gap: 0.0,
        hole_gap_errors: Vec::new(),
        bearing_clearance: 0.0,
        ..mechanism.clone()
    }
}
