//! The result columns of a sweep: their names and how each follows from the stages.

use crate::compliance::{
    natural_frequency, output_compliance, output_compliance_statics, reflected, slope_deg,
    twist_deg,
};
use crate::inputs::NM_PER_RAD_OF_NM_PER_ARCMIN;
use crate::stages::{Geometry, Map, PinBending, Rating, Shaft};

/// A result column; the twists are numbered by the study's list of loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(
    missing_docs,
    reason = "`Output::name` is the name that users and documents know"
)]
pub enum Output {
    ActivePinsMean,
    ActivePinsMin,
    ActivePinsMax,
    TorqueTransferEfficiency,
    TorqueTransferEfficiencyInside,
    TorqueTransferEfficiencyPublishedMap,
    PinParticipationStatics,
    StaticsApplicable,
    HoleDiameter,
    HoleWeb,
    ShortWidthCoefficient,
    NominalTorque,
    NaturalFrequency,
    ShaftCompliance,
    PinCompliance,
    OutputCompliance,
    OutputComplianceStatics,
    ReflectedCompliance,
    ReflectedStiffness,
    OutputStiffness,
    PinForceMax,
    PinBendingStress,
    Twist(usize),
}

/// How a column's numbers are to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A real number.
    Real,
    /// A count.
    Count,
    /// Zero or one.
    Flag,
}

impl Output {
    /// Every column but the twists, in the order of a table.
    pub const FIXED: [Output; 22] = [
        Output::ActivePinsMean,
        Output::ActivePinsMin,
        Output::ActivePinsMax,
        Output::TorqueTransferEfficiency,
        Output::TorqueTransferEfficiencyInside,
        Output::TorqueTransferEfficiencyPublishedMap,
        Output::PinParticipationStatics,
        Output::StaticsApplicable,
        Output::HoleDiameter,
        Output::HoleWeb,
        Output::ShortWidthCoefficient,
        Output::NominalTorque,
        Output::NaturalFrequency,
        Output::ShaftCompliance,
        Output::PinCompliance,
        Output::OutputCompliance,
        Output::OutputComplianceStatics,
        Output::ReflectedCompliance,
        Output::ReflectedStiffness,
        Output::OutputStiffness,
        Output::PinForceMax,
        Output::PinBendingStress,
    ];

    /// Name of the column, with the study's loads for the twists.
    #[must_use]
    pub fn name(self, loads: &[f64]) -> String {
        let name = match self {
            Output::ActivePinsMean => "active_pins_mean",
            Output::ActivePinsMin => "active_pins_min",
            Output::ActivePinsMax => "active_pins_max",
            Output::TorqueTransferEfficiency => "torque_transfer_efficiency",
            Output::TorqueTransferEfficiencyInside => "torque_transfer_efficiency_inside",
            Output::TorqueTransferEfficiencyPublishedMap => {
                "torque_transfer_efficiency_published_map"
            }
            Output::PinParticipationStatics => "pin_participation_statics",
            Output::StaticsApplicable => "statics_applicable",
            Output::HoleDiameter => "hole_diameter_mm",
            Output::HoleWeb => "hole_web_mm",
            Output::ShortWidthCoefficient => "short_width_coefficient",
            Output::NominalTorque => "nominal_torque_nm",
            Output::NaturalFrequency => "natural_frequency_hz",
            Output::ShaftCompliance => "shaft_compliance_rad_per_nm",
            Output::PinCompliance => "pin_compliance_rad_per_nm",
            Output::OutputCompliance => "output_compliance_rad_per_nm",
            Output::OutputComplianceStatics => "output_compliance_statics_rad_per_nm",
            Output::ReflectedCompliance => "reflected_compliance_rad_per_nm",
            Output::ReflectedStiffness => "reflected_stiffness_nm_per_rad",
            Output::OutputStiffness => "output_stiffness_nm_per_arcmin",
            Output::PinForceMax => "pin_force_max_n",
            Output::PinBendingStress => "pin_bending_stress_mpa",
            Output::Twist(k) => return twist_name(loads[k]),
        };
        name.to_owned()
    }

    /// Every column of a study with these loads, in the order of a table.
    #[must_use]
    pub fn all(loads: &[f64]) -> Vec<Output> {
        Output::FIXED
            .into_iter()
            .chain((0..loads.len()).map(Output::Twist))
            .collect()
    }

    /// How its numbers are to be read.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Output::ActivePinsMin | Output::ActivePinsMax => Kind::Count,
            Output::StaticsApplicable => Kind::Flag,
            _ => Kind::Real,
        }
    }

    /// True when the figures of every criterion are needed for it.
    #[must_use]
    pub const fn needs_every_criterion(self) -> bool {
        matches!(
            self,
            Output::TorqueTransferEfficiencyInside
                | Output::TorqueTransferEfficiencyPublishedMap
                | Output::PinParticipationStatics
                | Output::OutputComplianceStatics
        )
    }

    /// True when nothing of the active-pin map is needed for it.
    #[must_use]
    pub const fn is_free_of_map(self) -> bool {
        matches!(
            self,
            Output::HoleDiameter
                | Output::HoleWeb
                | Output::ShortWidthCoefficient
                | Output::NominalTorque
                | Output::ShaftCompliance
                | Output::PinCompliance
        )
    }
}

/// `twist_4p5tn_deg` for 4.5 times the nominal torque.
#[must_use]
pub fn twist_name(load: f64) -> String {
    format!("twist_{}tn_deg", format!("{load}").replace('.', "p"))
}

/// What the stages of one variant amount to together.
#[derive(Debug, Clone, Copy)]
pub struct Assembly {
    /// C_OS (rad/(N m)): Eq. (11), or the compliance given as measured.
    pub compliance: f64,
    /// C*_OS (rad/(N m)) at the input, Eq. (12).
    pub reflected: f64,
    /// Twist (deg) at the input for one nominal torque beyond the free play, Eq. (13), by the
    /// chosen criterion. A stiffness given as measured is taken as it is.
    pub slope_deg: f64,
    /// Largest pin force (N).
    pub pin_force: f64,
}

impl Assembly {
    /// Before anything is known.
    pub(crate) const NONE: Self = Self {
        compliance: f64::NAN,
        reflected: f64::NAN,
        slope_deg: f64::NAN,
        pin_force: f64::NAN,
    };

    /// Assembles one variant.
    #[inline]
    #[must_use]
    pub fn of(map: &Map, shaft: &Shaft, pin: &PinBending, rating: &Rating) -> Self {
        let (compliance, in_twist, factor) = if rating.given_compliance.is_nan() {
            (
                output_compliance(shaft.compliance, pin.compliance, map.pins),
                output_compliance(shaft.compliance, pin.compliance, map.pins_in_twist),
                map.twist_factor,
            )
        } else {
            (rating.given_compliance, rating.given_compliance, 1.0)
        };
        let reflected_in_twist = reflected(in_twist, map.ratio_squared);
        Self {
            compliance,
            reflected: reflected(compliance, map.ratio_squared),
            slope_deg: slope_deg(factor, reflected_in_twist, rating.nominal_torque),
            pin_force: rating.output_torque * map.force_per_torque,
        }
    }
}

/// The stages of a block of variants, one entry a variant.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// Discs, holes and pins.
    pub geometry: &'a [Geometry],
    /// Active pins.
    pub map: &'a [Map],
    /// Shaft.
    pub shaft: &'a [Shaft],
    /// Pin.
    pub pin: &'a [PinBending],
    /// Ratings.
    pub rating: &'a [Rating],
    /// All together.
    pub assembly: &'a [Assembly],
}

impl Block<'_> {
    /// Writes one column, in its own unit.
    pub fn write(&self, output: Output, loads: &[f64], out: &mut [f64]) {
        let Block {
            geometry,
            map,
            shaft,
            pin,
            rating,
            assembly,
        } = *self;
        match output {
            Output::ActivePinsMean => each(out, map, |m| m.active.mean),
            Output::ActivePinsMin => each(out, map, |m| f64::from(m.active.min)),
            Output::ActivePinsMax => each(out, map, |m| f64::from(m.active.max)),
            Output::TorqueTransferEfficiency => each(out, map, |m| m.efficiency),
            Output::TorqueTransferEfficiencyInside => each(out, map, |m| m.efficiency_inside),
            Output::TorqueTransferEfficiencyPublishedMap => {
                each(out, map, |m| m.efficiency_published_map);
            }
            Output::PinParticipationStatics => each(out, map, |m| m.participation),
            Output::StaticsApplicable => each(out, map, |m| m.statics_applicable),
            Output::HoleDiameter => each(out, geometry, |g| g.hole_diameter * 1e3),
            Output::HoleWeb => each(out, geometry, |g| g.hole_web * 1e3),
            Output::ShortWidthCoefficient => each(out, geometry, |g| g.short_width_coefficient),
            Output::NominalTorque => each(out, rating, |r| r.nominal_torque),
            Output::NaturalFrequency => {
                for ((value, a), r) in out.iter_mut().zip(assembly).zip(rating) {
                    *value = natural_frequency(1.0 / a.reflected, r.inertia);
                }
            }
            Output::ShaftCompliance => each(out, shaft, |s| s.compliance),
            Output::PinCompliance => each(out, pin, |p| p.compliance),
            Output::OutputCompliance => each(out, assembly, |a| a.compliance),
            Output::OutputComplianceStatics => {
                for (k, value) in out.iter_mut().enumerate() {
                    *value = if rating[k].given_compliance.is_nan() {
                        output_compliance_statics(
                            shaft[k].compliance,
                            pin[k].compliance,
                            map[k].pins,
                            map[k].participation,
                        )
                    } else {
                        rating[k].given_compliance
                    };
                }
            }
            Output::ReflectedCompliance => each(out, assembly, |a| a.reflected),
            Output::ReflectedStiffness => each(out, assembly, |a| 1.0 / a.reflected),
            Output::OutputStiffness => {
                each(out, assembly, |a| {
                    1.0 / (a.compliance * NM_PER_RAD_OF_NM_PER_ARCMIN)
                });
            }
            Output::PinForceMax => each(out, assembly, |a| a.pin_force),
            Output::PinBendingStress => {
                for ((value, a), p) in out.iter_mut().zip(assembly).zip(pin) {
                    *value = a.pin_force * p.stress_per_force * 1e-6;
                }
            }
            Output::Twist(k) => {
                let load = loads[k];
                for ((value, a), r) in out.iter_mut().zip(assembly).zip(rating) {
                    *value = twist_deg(a.slope_deg, load, r.free_play_deg);
                }
            }
        }
    }
}

#[inline]
fn each<T>(out: &mut [f64], stage: &[T], value: impl Fn(&T) -> f64) {
    for (out, stage) in out.iter_mut().zip(stage) {
        *out = value(stage);
    }
}
