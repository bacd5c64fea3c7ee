//! The result columns of a sweep: their names and how each follows from the stages.

use crate::kernel::lanes::{BLOCK, Lanes};
use crate::kernel::map_stage::{Map, MapBlock};
use crate::kernel::stages::{
    GeometryBlock, PinBending, PinBendingBlock, Rating, RatingBlock, Shaft, ShaftBlock, Stage,
    stage,
};
use crate::model::compliance::{
    natural_frequency, output_compliance, output_compliance_statics, reflected, slope_deg,
    twist_deg,
};
use crate::model::inputs::NM_PER_RAD_OF_NM_PER_ARCMIN;
use crate::model::pin::{force_per_pin, torque_per_pin};

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
    NaturalFrequencyWithEfficiency,
    ShaftCompliance,
    PinCompliance,
    OutputCompliance,
    OutputComplianceStatics,
    ReflectedCompliance,
    ReflectedStiffness,
    OutputStiffness,
    ComplianceFactor,
    TorquePerPin,
    ForcePerPin,
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
    pub const FIXED: [Output; 26] = [
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
        Output::NaturalFrequencyWithEfficiency,
        Output::ShaftCompliance,
        Output::PinCompliance,
        Output::OutputCompliance,
        Output::OutputComplianceStatics,
        Output::ReflectedCompliance,
        Output::ReflectedStiffness,
        Output::OutputStiffness,
        Output::ComplianceFactor,
        Output::TorquePerPin,
        Output::ForcePerPin,
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
            Output::NaturalFrequencyWithEfficiency => "natural_frequency_with_efficiency_hz",
            Output::ShaftCompliance => "shaft_compliance_rad_per_nm",
            Output::PinCompliance => "pin_compliance_rad_per_nm",
            Output::OutputCompliance => "output_compliance_rad_per_nm",
            Output::OutputComplianceStatics => "output_compliance_statics_rad_per_nm",
            Output::ReflectedCompliance => "reflected_compliance_rad_per_nm",
            Output::ReflectedStiffness => "reflected_stiffness_nm_per_rad",
            Output::OutputStiffness => "output_stiffness_nm_per_arcmin",
            Output::ComplianceFactor => "compliance_factor",
            Output::TorquePerPin => "torque_per_pin_nm",
            Output::ForcePerPin => "force_per_pin_n",
            Output::PinForceMax => "pin_force_max_n",
            Output::PinBendingStress => "pin_bending_stress_mpa",
            Output::Twist(k) => {
                return twist_name(loads.get(k).copied().unwrap_or(f64::NAN));
            }
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
    pub(crate) const fn needs_every_criterion(self) -> bool {
        matches!(
            self,
            Output::TorqueTransferEfficiencyInside
                | Output::TorqueTransferEfficiencyPublishedMap
                | Output::PinParticipationStatics
                | Output::OutputComplianceStatics
        )
    }

    /// True when the largest pin force by statics is needed for it.
    #[must_use]
    pub(crate) const fn needs_pin_force(self) -> bool {
        matches!(self, Output::PinForceMax | Output::PinBendingStress)
    }

    /// True when nothing of the active-pin map is needed for it.
    #[must_use]
    pub(crate) const fn is_free_of_map(self) -> bool {
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

/// `twist_4p5tn_deg` for 4.5 times the nominal torque, `twist_minus_4p5tn_deg` for -4.5 times.
#[must_use]
pub fn twist_name(load: f64) -> String {
    format!(
        "twist_{}tn_deg",
        format!("{load}").replace('.', "p").replace('-', "minus_")
    )
}

stage! {
    /// What the stages of one variant amount to together.
    Assembly, AssemblyBlock {
        /// C_OS (rad/(N m)): Eq. (11), with the pins' participation where statics feeds the twist,
        /// or the compliance given as measured.
        compliance,
        /// C*_OS (rad/(N m)) at the input, Eq. (12).
        reflected,
        /// Factor on C*_OS in Eq. (13): eta_OP by the chosen criterion; one by statics, and for a
        /// stiffness given as measured.
        twist_factor,
        /// Twist (deg) at the input for one nominal torque beyond the free play, Eq. (13).
        slope_deg,
        /// Largest pin force (N).
        pin_force,
    }
}

impl Assembly {
    /// Assembles one variant.
    #[inline(always)]
    pub(crate) fn of(map: &Map, shaft: &Shaft, pin: &PinBending, rating: &Rating) -> Self {
        let is_given = !rating.given_compliance.is_nan();
        let computed = output_compliance(shaft.compliance, pin.compliance, map.pins_in_twist);
        let compliance = if is_given {
            rating.given_compliance
        } else {
            computed
        };
        let twist_factor = if is_given { 1.0 } else { map.twist_factor };
        let reflected = reflected(compliance, map.ratio_squared);
        Self {
            compliance,
            reflected,
            twist_factor,
            slope_deg: slope_deg(twist_factor, reflected, rating.nominal_torque),
            pin_force: rating.output_torque * map.force_per_torque,
        }
    }
}

/// The stages of a block of variants.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block<'a> {
    /// Discs, holes and pins.
    pub geometry: &'a GeometryBlock,
    /// Active pins.
    pub map: &'a MapBlock,
    /// Shaft.
    pub shaft: &'a ShaftBlock,
    /// Pin.
    pub pin: &'a PinBendingBlock,
    /// Ratings.
    pub rating: &'a RatingBlock,
}

impl Block<'_> {
    /// Assembles every variant.
    #[inline(always)]
    pub(crate) fn assemble(&self, out: &mut AssemblyBlock) {
        for row in 0..BLOCK {
            let map = Map::get(self.map, row);
            let shaft = Shaft::get(self.shaft, row);
            let pin = PinBending::get(self.pin, row);
            let rating = Rating::get(self.rating, row);
            Assembly::of(&map, &shaft, &pin, &rating).put(out, row);
        }
    }

    /// Writes one column, in its own unit, for the first variants of the block.
    #[inline(always)]
    pub(crate) fn write(
        &self,
        assembly: &AssemblyBlock,
        output: Output,
        loads: &[f64],
        out: &mut [f64],
    ) {
        let Block {
            geometry,
            map,
            shaft,
            pin,
            rating,
        } = *self;
        match output {
            Output::ActivePinsMean => copy(out, &map.active_mean),
            Output::ActivePinsMin => copy(out, &map.active_min),
            Output::ActivePinsMax => copy(out, &map.active_max),
            Output::TorqueTransferEfficiency => copy(out, &map.efficiency),
            Output::TorqueTransferEfficiencyInside => copy(out, &map.efficiency_inside),
            Output::TorqueTransferEfficiencyPublishedMap => {
                copy(out, &map.efficiency_published_map);
            }
            Output::PinParticipationStatics => copy(out, &map.participation),
            Output::StaticsApplicable => copy(out, &map.statics_applicable),
            Output::HoleDiameter => each(out, |k| geometry.hole_diameter[k] * 1e3),
            Output::HoleWeb => each(out, |k| geometry.hole_web[k] * 1e3),
            Output::ShortWidthCoefficient => copy(out, &geometry.short_width_coefficient),
            Output::NominalTorque => copy(out, &rating.nominal_torque),
            Output::NaturalFrequency => each(out, |k| {
                natural_frequency(1.0 / assembly.reflected[k], rating.inertia[k])
            }),
            Output::NaturalFrequencyWithEfficiency => each(out, |k| {
                let effective = assembly.twist_factor[k] * assembly.reflected[k];
                natural_frequency(1.0 / effective, rating.inertia[k])
            }),
            Output::ShaftCompliance => copy(out, &shaft.compliance),
            Output::PinCompliance => copy(out, &pin.compliance),
            Output::OutputCompliance => copy(out, &assembly.compliance),
            Output::OutputComplianceStatics => each(out, |k| {
                let given = rating.given_compliance[k];
                let computed = output_compliance_statics(
                    shaft.compliance[k],
                    pin.compliance[k],
                    map.pins[k],
                    map.participation[k],
                );
                if given.is_nan() { computed } else { given }
            }),
            Output::ReflectedCompliance => copy(out, &assembly.reflected),
            Output::ReflectedStiffness => each(out, |k| 1.0 / assembly.reflected[k]),
            Output::OutputStiffness => each(out, |k| {
                1.0 / (assembly.compliance[k] * NM_PER_RAD_OF_NM_PER_ARCMIN)
            }),
            Output::ComplianceFactor => copy(out, &assembly.twist_factor),
            Output::TorquePerPin => each(out, |k| {
                torque_per_pin(rating.output_torque[k], map.active_mean[k])
            }),
            Output::ForcePerPin => each(out, |k| {
                let torque = torque_per_pin(rating.output_torque[k], map.active_mean[k]);
                force_per_pin(torque, pin.circle_radius[k])
            }),
            Output::PinForceMax => copy(out, &assembly.pin_force),
            Output::PinBendingStress => each(out, |k| {
                assembly.pin_force[k] * pin.stress_per_force[k] * 1e-6
            }),
            Output::Twist(number) => {
                let load = loads[number];
                let (slope, play) = (&assembly.slope_deg, &rating.free_play_deg);
                // To the other side by as much.
                if load.is_sign_negative() {
                    each(out, |k| -twist_deg(slope[k], -load, play[k]));
                } else {
                    each(out, |k| twist_deg(slope[k], load, play[k]));
                }
            }
        }
    }
}

#[inline(always)]
fn copy(out: &mut [f64], lanes: &Lanes) {
    out.copy_from_slice(&lanes[..out.len()]);
}

#[inline(always)]
fn each(out: &mut [f64], value: impl Fn(usize) -> f64) {
    assert!(out.len() <= BLOCK);
    for (row, out) in out.iter_mut().enumerate() {
        *out = value(row);
    }
}
