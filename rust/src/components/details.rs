//! Columns that few queries ask for, solved on their own by the full engine: where the worst contacts
//! are, how the largest forces change over the crank, what comes near yield, and the stiffness that a
//! drive has without its clearances.

use crate::components::equilibrium::{Equilibrium, Loaded};
use crate::components::inputs::PartInput;
use crate::components::laws::{SHEAR_OF_PRESSURE, hertz};
use crate::components::mechanism::{Circles, Mechanism, Position};
use crate::components::outputs::{PartOutput, Wanted};
use crate::components::parts::{Fixed, Parts};
use crate::components::sharing::Sharing;
use crate::components::turn::{ARCMIN, POSITIONS, positions};
use crate::model::inputs::Input;

/// The largest of some quantity, and where it is.
#[derive(Debug, Clone, Copy)]
struct Worst {
    value: f64,
    pin: usize,
    crank: f64,
}

impl Worst {
    const NONE: Self = Self {
        value: 0.0,
        pin: 0,
        crank: 0.0,
    };

    const fn take(&mut self, value: f64, pin: usize, crank: f64) {
        if value > self.value {
            *self = Self { value, pin, crank };
        }
    }
}

/// What is gathered over the positions of the crank.
#[derive(Debug, Clone, Copy)]
struct Gathered {
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

/// Writes the columns that are asked for; those of an equilibrium that is not found stay as they are.
pub fn put_details(
    parts: &Parts,
    fixed: &Fixed,
    wanted: Wanted,
    put: &mut impl FnMut(PartOutput, f64),
) {
    let mechanism = parts.mechanism(fixed);
    if wanted.details
        && let Some(found) = gather(parts, &mechanism)
    {
        put_gathered(parts, &found, put);
    }
    if wanted.without_clearance
        && let Some(stiffness) = mean_stiffness(&without_clearance(&mechanism), parts.torque)
    {
        let stiffness = ARCMIN / (1.0 / stiffness + parts.shaft_compliance);
        put(PartOutput::StiffnessWithoutClearance, stiffness);
    }
}

/// The mechanism with every gap, modification and play taken out.
fn without_clearance(mechanism: &Mechanism) -> Mechanism {
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

/// Equilibria at the few positions of the crank, each handed to `take`. None where one is not found.
fn over_the_crank(
    mechanism: &Mechanism,
    torque: f64,
    mut take: impl FnMut(f64, &Loaded<'_, crate::components::contact::PowerLaws>, &Equilibrium),
) -> Option<()> {
    let (mut circles, mut position) = (Circles::default(), Position::default());
    circles.set(mechanism);
    for crank in positions(mechanism, POSITIONS) {
        position.set(mechanism, &circles, crank);
        let loaded = Loaded::full(mechanism, &position);
        let found = loaded.solve(torque, &loaded.first_motion(torque));
        if !found.converged {
            return None;
        }
        take(crank, &loaded, &found);
    }
    Some(())
}

/// Mean stiffness (N m/rad) at a torque, without the shaft.
fn mean_stiffness(mechanism: &Mechanism, torque: f64) -> Option<f64> {
    let mut sum = 0.0;
    over_the_crank(mechanism, torque, |_, _, found| sum += found.stiffness)?;
    let radius = mechanism.pin_circle_radius;
    Some(sum / POSITIONS as f64 * radius * radius)
}

fn gather(parts: &Parts, mechanism: &Mechanism) -> Option<Gathered> {
    let mut found = Gathered {
        ring: Worst::NONE,
        output: Worst::NONE,
        ring_peak: f64::INFINITY,
        output_peak: f64::INFINITY,
        bearing: f64::INFINITY,
        moment: 0.0,
    };
    let (mut ring, mut pins) = (Vec::new(), Vec::new());
    over_the_crank(mechanism, parts.torque, |crank, loaded, equilibrium| {
        let motion = &equilibrium.motion;
        ring.clear();
        pins.clear();
        for disc in 0..mechanism.discs {
            let from = ring.len();
            loaded.ring_forces(disc, motion, &mut ring);
            let contacts = loaded.ring_contacts(disc, motion, &ring[from..]);
            for (pin, contact) in contacts.enumerate() {
                let curvature = parts.profile.contact_curvature(contact.cosine);
                found.ring.take(contact.force * curvature, pin, crank);
            }
            let from = pins.len();
            loaded.pin_forces(disc, motion, &mut pins);
            let reach = PartInput::ALL[PartInput::Reach1 as usize + disc];
            for (pin, force) in pins[from..].iter().enumerate() {
                found.output.take(*force, pin, crank);
                found.moment = found.moment.max(force * parts.value(reach));
            }
            let [x, y] = loaded.bearing_force(disc, motion);
            found.bearing = found.bearing.min(x.hypot(y));
        }
        found.ring_peak = found.ring_peak.min(Sharing::of(&ring).largest);
        found.output_peak = found.output_peak.min(Sharing::of(&pins).largest);
    })?;
    Some(found)
}

fn put_gathered(parts: &Parts, found: &Gathered, put: &mut impl FnMut(PartOutput, f64)) {
    put(PartOutput::RingPressurePin, found.ring.pin as f64);
    put(PartOutput::RingPressureCrank, found.ring.crank.to_degrees());
    put(PartOutput::OutputPressurePin, found.output.pin as f64);
    put(
        PartOutput::OutputPressureCrank,
        found.output.crank.to_degrees(),
    );
    put(PartOutput::RingPinForcePeakMin, found.ring_peak);
    put(PartOutput::OutputPinForcePeakMin, found.output_peak);
    put(PartOutput::BearingForceMin, found.bearing);
    let (outer, bore) = (
        parts.scalar(Input::OutputPinDiameter),
        parts.scalar(Input::OutputPinBore),
    );
    let modulus = std::f64::consts::PI / 32.0 * (outer.powi(4) - bore.powi(4)) / outer;
    let stress = found.moment / modulus;
    put(PartOutput::PinRootStress, stress * 1e-6);
    let pin_yield = parts.value(PartInput::PinYieldStrength);
    put(PartOutput::PinYieldRatio, stress / pin_yield);
    let [ring, disc, pin] = parts.materials();
    let width = parts.value(PartInput::DiscWidth);
    // Pressure goes with the root of force times curvature.
    let at_ring = hertz(found.ring.value / width, 1.0, ring, disc).pressure;
    let at_hole = hertz(
        found.output.value / width,
        parts.hole_curvature(),
        pin,
        disc,
    )
    .pressure;
    // Yield begins below the surface where twice the largest shear stress reaches the strength.
    let stress = 2.0 * SHEAR_OF_PRESSURE.0 * at_ring.max(at_hole);
    let contact_yield = parts.value(PartInput::ContactYieldStrength);
    put(PartOutput::ContactYieldRatio, stress / contact_yield);
}
