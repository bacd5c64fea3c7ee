//! A drive's parts: from its inputs to the mechanism that an equilibrium needs, and the reasons
//! for which it has none.

use thiserror::Error;

use crate::components::inputs::{PART_INPUTS, PartInput, Substitute};
use crate::components::laws::{Material, johnson_secant, palmgren, power_stiffness};
use crate::components::mechanism::{MAX_DISCS, Mechanism};
use crate::components::pin_root::{PinFlexibility, RootCompliance};
use crate::components::profile::Profile;
use crate::model::inputs::{Input, SCALARS};

/// Law by which contacts approach each other.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ContactLaw {
    /// Palmgren's empirical law of line contacts.
    #[default]
    Palmgren,
    /// The secant of Johnson's cylinders at the force of rated torque without clearance.
    Johnson,
}

/// What of a drive's parts no study varies.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixed {
    /// Law of the contacts.
    pub law: ContactLaw,
    /// Compliance of the flange at the pins' roots.
    pub root: RootCompliance,
    /// Further gap of each ring pin (m); empty where all are alike.
    pub ring_gap_errors: Vec<f64>,
    /// Further gap of each hole (m); empty where all are alike.
    pub hole_gap_errors: Vec<f64>,
}

impl Default for Fixed {
    fn default() -> Self {
        Self {
            law: ContactLaw::default(),
            root: RootCompliance::THICK_FLANGE,
            ring_gap_errors: Vec::new(),
            hole_gap_errors: Vec::new(),
        }
    }
}

/// Why a drive has no component model. Lengths in m.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PartError {
    /// An input that has no default is missing or no number.
    #[error("{name} is missing: without it a drive has no component model")]
    Missing {
        /// Its name.
        name: &'static str,
    },
    /// A variant leaves out an input for which a drive has an assumed number.
    #[error("{name} is not a finite number")]
    NoNumber {
        /// Its name.
        name: &'static str,
    },
    /// An input is outside what its part can have.
    #[error("{name} is {value}, expected {expected}")]
    OutOfRange {
        /// Its name.
        name: &'static str,
        /// The value found, in the input's own unit.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// Neighbouring ring pins overlap.
    #[error("ring pins of radius {radius} m overlap on a pitch of {pitch} m")]
    RingPinsOverlap {
        /// Radius of a pin (m).
        radius: f64,
        /// Distance of neighbouring pins' centres (m).
        pitch: f64,
    },
    /// The profile's offset by the pins' radius crosses itself.
    #[error("ring pins of radius {radius} m undercut a profile whose path bends at {bend} m")]
    Undercut {
        /// Radius of a pin (m).
        radius: f64,
        /// Smallest convex radius of the path of a pin's centre (m).
        bend: f64,
    },
    /// Holes reach beyond the roots of the profile.
    #[error(
        "holes that reach {hole} m from the middle break through a profile with its roots at {root} m"
    )]
    HolesBreakProfile {
        /// Largest distance of a hole's edge from the disc's middle (m).
        hole: f64,
        /// Distance of the profile's roots (m).
        root: f64,
    },
    /// A list of individual gaps has another length than there are contacts.
    #[error("{name}: {found} values, expected {expected}")]
    Length {
        /// Name of the list.
        name: &'static str,
        /// Values found.
        found: usize,
        /// Contacts there are.
        expected: usize,
    },
}

impl PartError {
    /// The words under which a sweep files these reasons, in the order of [`PartError::code`]. What is
    /// no number has the published model's word.
    pub const LABELS: [&'static str; 6] = [
        "component_input_missing",
        "component_input_out_of_range",
        "ring_pins_overlap",
        "profile_undercut",
        "gap_list_length",
        "holes_break_profile",
    ];

    /// Place of its word; none where the published model has one.
    #[must_use]
    pub const fn code(&self) -> Option<usize> {
        match self {
            Self::NoNumber { .. } => None,
            Self::Missing { .. } => Some(0),
            Self::OutOfRange { .. } => Some(1),
            Self::RingPinsOverlap { .. } => Some(2),
            Self::Undercut { .. } => Some(3),
            Self::Length { .. } => Some(4),
            Self::HolesBreakProfile { .. } => Some(5),
        }
    }
}

/// Everything that the component model reads of a drive that the published model accepts. SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// The published model's inputs, in the order of [`Input::ALL`].
    scalars: [f64; SCALARS],
    /// The component model's, in the order of [`PartInput::ALL`], defaults put in.
    values: [f64; PART_INPUTS],
    /// Lobes, discs and output pins.
    pub counts: [usize; 3],
    /// Profile of the discs.
    pub profile: Profile,
    /// Rated output torque (N m).
    pub torque: f64,
    /// Compliance (rad/(N m)) of the output shaft in series.
    pub shaft_compliance: f64,
    /// Output pin with its root, under the force of each disc.
    pub pins: [PinFlexibility; MAX_DISCS],
}

impl Parts {
    /// The parts from the published model's inputs, the component model's own (NaN where left
    /// out), both in SI, and the shaft's compliance.
    ///
    /// # Errors
    /// The first reason for which there is no component model.
    pub fn of(
        scalars: &[f64; SCALARS],
        given: &[f64; PART_INPUTS],
        fixed: &Fixed,
        shaft_compliance: f64,
    ) -> Result<Self, PartError> {
        let scalar = |input: Input| scalars[input as usize];
        let mut values = *given;
        for input in PartInput::ALL {
            let (name, unit, default) = input.row();
            let value = &mut values[input as usize];
            if value.is_nan() {
                *value = match default {
                    Substitute::Required => return Err(PartError::Missing { name }),
                    Substitute::Number(number) => number * unit,
                    Substitute::Same(input) => scalar(input),
                    Substitute::Widths(share) => share * given[PartInput::DiscWidth as usize],
                    Substitute::Absent => continue,
                };
            }
            let expected = match range(input) {
                Range::Positive if !(*value > 0.0 && value.is_finite()) => "above zero",
                Range::NonNegative if !(*value >= 0.0 && value.is_finite()) => "not below zero",
                Range::Poisson if !(*value > -1.0 && *value <= 0.5) => "above -1, at most 0.5",
                Range::Finite if !value.is_finite() => "a finite number",
                _ => continue,
            };
            let value = *value / unit;
            return Err(PartError::OutOfRange {
                name,
                value,
                expected,
            });
        }
        let [lobes, discs, output_pins] =
            [Input::Ratio, Input::DiscCount, Input::OutputPinCount].map(|i| scalar(i) as usize);
        let profile = Profile {
            lobes,
            ring_radius: scalar(Input::RingPinCircleRadius),
            pin_radius: values[PartInput::RingPinRadius as usize],
            eccentricity: scalar(Input::Eccentricity),
        };
        let radius = profile.pin_radius;
        let pitch = 2.0 * profile.ring_radius * (std::f64::consts::PI / (lobes as f64 + 1.0)).sin();
        if 2.0 * radius >= pitch {
            return Err(PartError::RingPinsOverlap { radius, pitch });
        }
        check_gaps(&scalar, &values, &profile)?;
        let bend = profile.path_radius_min();
        if bend <= radius {
            return Err(PartError::Undercut { radius, bend });
        }
        let pins = std::array::from_fn(|disc| {
            PinFlexibility::at(
                values[PartInput::Reach1 as usize + disc],
                scalar(Input::OutputPinDiameter),
                scalar(Input::OutputPinBore),
                scalar(Input::YoungsModulus),
                scalar(Input::PoissonRatio),
                fixed.root,
            )
        });
        let parts = Self {
            scalars: *scalars,
            values,
            counts: [lobes, discs, output_pins],
            profile,
            torque: scalar(Input::OutputTorque),
            shaft_compliance,
            pins,
        };
        let root =
            parts.profile.ring_radius - radius - parts.profile.eccentricity - parts.ring_gap();
        let hole = parts.scalar(Input::OutputPinCircleRadius) + parts.hole_radius();
        if hole >= root {
            return Err(PartError::HolesBreakProfile { hole, root });
        }
        for (name, list, expected) in [
            ("ring_gap_errors_mm", &fixed.ring_gap_errors, lobes + 1),
            ("hole_gap_errors_mm", &fixed.hole_gap_errors, output_pins),
        ] {
            let found = list.len();
            if found != 0 && found != expected {
                return Err(PartError::Length {
                    name,
                    found,
                    expected,
                });
            }
        }
        Ok(parts)
    }

    /// Value of an input of the published model. SI.
    #[must_use]
    pub const fn scalar(&self, input: Input) -> f64 {
        self.scalars[input as usize]
    }

    /// Value of an input of the component model. SI.
    #[must_use]
    pub const fn value(&self, input: PartInput) -> f64 {
        self.values[input as usize]
    }

    /// Materials of ring, disc and output pins.
    #[must_use]
    pub fn materials(&self) -> [Material; 3] {
        [
            (
                self.value(PartInput::RingYoungsModulus),
                self.value(PartInput::RingPoisson),
            ),
            (
                self.value(PartInput::DiscYoungsModulus),
                self.value(PartInput::DiscPoisson),
            ),
            (
                self.scalar(Input::YoungsModulus),
                self.scalar(Input::PoissonRatio),
            ),
        ]
        .map(|(youngs_modulus, poisson)| Material {
            youngs_modulus,
            poisson,
        })
    }

    /// Radius (m) of an output pin with its bush.
    #[must_use]
    pub const fn bush_radius(&self) -> f64 {
        0.5 * self.scalar(Input::OutputPinDiameter) + self.scalar(Input::BushWall)
    }

    /// Radius (m) of a hole: pin, bush, eccentricity and clearance.
    #[must_use]
    pub const fn hole_radius(&self) -> f64 {
        self.bush_radius() + self.scalar(Input::Eccentricity) + self.value(PartInput::HoleClearance)
    }

    /// Gap (m) at every ring pin along its normal.
    #[must_use]
    pub const fn ring_gap(&self) -> f64 {
        self.value(PartInput::RingClearance) + self.value(PartInput::ProfileOffset)
    }

    /// Relative curvature (1/m) of hole and output pin.
    #[must_use]
    pub const fn hole_curvature(&self) -> f64 {
        1.0 / self.bush_radius() - 1.0 / self.hole_radius()
    }

    /// Approaches under one newton of the ring's two contacts and of the hole's.
    fn approaches(&self, law: ContactLaw) -> [f64; 2] {
        let [ring, disc, pin] = self.materials();
        let width = self.value(PartInput::DiscWidth);
        match law {
            ContactLaw::Palmgren => [
                palmgren(ring, disc, width) + palmgren(ring, ring, width),
                palmgren(pin, disc, width),
            ],
            ContactLaw::Johnson => {
                let [lobes, discs, pins] = self.counts.map(|count| count as f64);
                let share = 4.0 * self.torque / discs;
                let eccentricity = self.profile.eccentricity;
                let load = share / (eccentricity * lobes * (lobes + 1.0));
                let radius = self.profile.pin_radius;
                // Ring pins carry most where the normal is across u: cosine K1.
                let cosine = eccentricity * (lobes + 1.0) / self.profile.ring_radius;
                let curvature = self.profile.contact_curvature(cosine);
                let lobe = 1.0 / (curvature - 1.0 / radius).abs();
                let lobe = lobe.min(self.profile.ring_radius);
                let ring_contact =
                    johnson_secant(load, width, curvature, [(ring, radius), (disc, lobe)]);
                // The ring holds its pins in half-round seats a hundredth wider than they are.
                let seat = radius * SEAT;
                let seat_curvature = 1.0 / radius - 1.0 / seat;
                let seated =
                    johnson_secant(load, width, seat_curvature, [(ring, radius), (ring, seat)]);
                let load = share / (self.scalar(Input::OutputPinCircleRadius) * pins);
                let bodies = [(pin, self.bush_radius()), (disc, self.hole_radius())];
                let hole = johnson_secant(load, width, self.hole_curvature(), bodies);
                [ring_contact + seated.max(0.0), hole]
            }
        }
    }

    /// The mechanism of these parts.
    #[must_use]
    pub fn mechanism(&self, fixed: &Fixed) -> Mechanism {
        let [lobes, discs, output_pins] = self.counts;
        let [ring, hole] = self.approaches(fixed.law).map(power_stiffness);
        Mechanism {
            lobes,
            discs,
            output_pins,
            eccentricity: self.profile.eccentricity,
            ring_radius: self.profile.ring_radius,
            pin_circle_radius: self.scalar(Input::OutputPinCircleRadius),
            hole_clocking: std::f64::consts::TAU * self.scalar(Input::HoleClocking),
            ring_gap: self.ring_gap(),
            ring_enlargement: self.value(PartInput::RingCircleEnlargement)
                + self.value(PartInput::ProfileShift),
            profile_rotation: self.value(PartInput::ProfileRotation),
            ring_gap_errors: fixed.ring_gap_errors.clone(),
            hole_gap: self.value(PartInput::HoleClearance),
            hole_gap_errors: fixed.hole_gap_errors.clone(),
            ring_stiffness: ring,
            hole_stiffness: hole,
            pin_stiffness: self.pins.map(PinFlexibility::stiffness),
            bearing_stiffness: self.value(PartInput::BearingStiffness),
            bearing_clearance: self.value(PartInput::BearingClearance),
        }
    }
}

/// Refuses gaps with which the parts would not be the ones of a drive: holes that meet or are no wider
/// than their pins, and lobes that pass the ring pins.
fn check_gaps(
    scalar: &impl Fn(Input) -> f64,
    values: &[f64; PART_INPUTS],
    profile: &Profile,
) -> Result<(), PartError> {
    let eccentricity = profile.eccentricity;
    let refused = |input: PartInput, expected| {
        let (name, unit, _) = input.row();
        let value = values[input as usize] / unit;
        Err(PartError::OutOfRange {
            name,
            value,
            expected,
        })
    };
    let clearance = values[PartInput::HoleClearance as usize];
    if clearance <= -eccentricity {
        return refused(
            PartInput::HoleClearance,
            "above minus the eccentricity, so that holes are wider than their pins",
        );
    }
    let bush = 0.5 * scalar(Input::OutputPinDiameter) + scalar(Input::BushWall);
    let half_turn = std::f64::consts::PI / scalar(Input::OutputPinCount);
    let half_pitch = scalar(Input::OutputPinCircleRadius) * half_turn.sin();
    if bush + eccentricity + clearance >= half_pitch {
        return refused(
            PartInput::HoleClearance,
            "small enough that holes do not meet",
        );
    }
    let gap = values[PartInput::RingClearance as usize] + values[PartInput::ProfileOffset as usize];
    if gap >= eccentricity {
        return refused(
            PartInput::RingClearance,
            "with profile_offset_mm below the eccentricity, so that lobes do not pass the ring pins",
        );
    }
    Ok(())
}

/// Radius of a ring pin's seat over the pin's, for Johnson's law alone.
const SEAT: f64 = 1.01;

/// What an input may be.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Range {
    Positive,
    NonNegative,
    Finite,
    Poisson,
}

const fn range(input: PartInput) -> Range {
    match input {
        PartInput::RingPinRadius
        | PartInput::DiscWidth
        | PartInput::BearingStiffness
        | PartInput::Reach1
        | PartInput::Reach2
        | PartInput::Reach3
        | PartInput::Reach4
        | PartInput::RingYoungsModulus
        | PartInput::DiscYoungsModulus
        | PartInput::DiscDensity
        | PartInput::ContactYieldStrength
        | PartInput::PinYieldStrength
        | PartInput::LoadInertia
        | PartInput::FlangeInertia
        | PartInput::CouplingStiffness => Range::Positive,
        PartInput::BearingClearance
        | PartInput::EccentricInertia
        | PartInput::FrictionRing
        | PartInput::FrictionOutput
        | PartInput::FrictionBearing
        | PartInput::ProfileRotation => Range::NonNegative,
        PartInput::RingPoisson | PartInput::DiscPoisson => Range::Poisson,
        PartInput::RingClearance
        | PartInput::RingCircleEnlargement
        | PartInput::ProfileOffset
        | PartInput::ProfileShift
        | PartInput::HoleClearance => Range::Finite,
    }
}
