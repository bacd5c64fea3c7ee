//! The inputs of a design by name, with their units, and the order in which studies number them.

use std::f64::consts::PI;

use crate::components::inputs::{PARTS_AT, PartInput, part_index};

/// A scalar input of a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
#[expect(
    missing_docs,
    reason = "`Input::name` is the name that users and documents know"
)]
pub enum Input {
    Ratio,
    DiscCount,
    Eccentricity,
    RingPinCircleRadius,
    HoleClocking,
    OutputPinCount,
    OutputPinCircleRadius,
    OutputPinDiameter,
    OutputPinBore,
    OutputPinLength,
    BushWall,
    DiscOuterRadius,
    DiscBoreRadius,
    YoungsModulus,
    PoissonRatio,
    KeywayCoefficient,
    InputPower,
    InputSpeed,
    OutputTorque,
    FreePlay,
    InputInertia,
    OutputStiffness,
    Criterion,
}

/// Number of scalar inputs; the shaft's follow them, four a segment.
pub const SCALARS: usize = 23;
/// A segment's inputs, in order.
pub const SEGMENT_FIELDS: [&str; 4] = [
    "diameter_mm",
    "end_diameter_mm",
    "length_mm",
    "keyway_depth_mm",
];

const MILLI: f64 = 1e-3;
const RPM: f64 = 2.0 * PI / 60.0;
const TURNS_PER_DEG: f64 = 1.0 / 360.0;
/// N m/rad in one N m/arcmin.
pub const NM_PER_RAD_OF_NM_PER_ARCMIN: f64 = 10_800.0 / PI;

impl Input {
    /// Every scalar input, in order.
    pub const ALL: [Input; SCALARS] = [
        Input::Ratio,
        Input::DiscCount,
        Input::Eccentricity,
        Input::RingPinCircleRadius,
        Input::HoleClocking,
        Input::OutputPinCount,
        Input::OutputPinCircleRadius,
        Input::OutputPinDiameter,
        Input::OutputPinBore,
        Input::OutputPinLength,
        Input::BushWall,
        Input::DiscOuterRadius,
        Input::DiscBoreRadius,
        Input::YoungsModulus,
        Input::PoissonRatio,
        Input::KeywayCoefficient,
        Input::InputPower,
        Input::InputSpeed,
        Input::OutputTorque,
        Input::FreePlay,
        Input::InputInertia,
        Input::OutputStiffness,
        Input::Criterion,
    ];

    /// Name and unit as in a drive file, and what turns a value into the kernel's unit: SI, but
    /// turns for the clocking and degrees for the free play, which is only ever added to degrees.
    #[must_use]
    pub const fn name_and_factor(self) -> (&'static str, f64) {
        match self {
            Input::Ratio => ("ratio", 1.0),
            Input::DiscCount => ("disc_count", 1.0),
            Input::Eccentricity => ("eccentricity_mm", MILLI),
            Input::RingPinCircleRadius => ("ring_pin_circle_radius_mm", MILLI),
            Input::HoleClocking => ("hole_clocking_deg", TURNS_PER_DEG),
            Input::OutputPinCount => ("output_pin_count", 1.0),
            Input::OutputPinCircleRadius => ("output_pin_circle_radius_mm", MILLI),
            Input::OutputPinDiameter => ("output_pin_diameter_mm", MILLI),
            Input::OutputPinBore => ("output_pin_bore_mm", MILLI),
            Input::OutputPinLength => ("output_pin_length_mm", MILLI),
            Input::BushWall => ("bush_wall_mm", MILLI),
            Input::DiscOuterRadius => ("disc_outer_radius_mm", MILLI),
            Input::DiscBoreRadius => ("disc_bore_radius_mm", MILLI),
            Input::YoungsModulus => ("youngs_modulus_gpa", 1e9),
            Input::PoissonRatio => ("poisson_ratio", 1.0),
            Input::KeywayCoefficient => ("keyway_coefficient", 1.0),
            Input::InputPower => ("input_power_kw", 1e3),
            Input::InputSpeed => ("input_speed_rpm", RPM),
            Input::OutputTorque => ("output_torque_nm", 1.0),
            Input::FreePlay => ("free_play_deg", 1.0),
            Input::InputInertia => ("input_inertia_kg_m2", 1.0),
            Input::OutputStiffness => (
                "output_stiffness_nm_per_arcmin",
                NM_PER_RAD_OF_NM_PER_ARCMIN,
            ),
            Input::Criterion => ("criterion", 1.0),
        }
    }

    /// Name as in a drive file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.name_and_factor().0
    }

    /// True for counts, which take whole numbers.
    #[must_use]
    pub const fn is_whole(self) -> bool {
        matches!(
            self,
            Input::Ratio | Input::DiscCount | Input::OutputPinCount
        )
    }

    /// True for the inputs that a design may leave out (NaN).
    #[must_use]
    pub const fn is_optional(self) -> bool {
        matches!(self, Input::InputInertia | Input::OutputStiffness)
    }
}

/// Position of a segment's field among all inputs; segments count from 0 here.
#[must_use]
pub const fn segment_input(segment: usize, field: usize) -> usize {
    SCALARS + SEGMENT_FIELDS.len() * segment + field
}

/// Position of an input named as in a study's axes (`eccentricity_mm`, `shaft_2_diameter_mm`).
#[must_use]
pub fn input_index(name: &str, segments: usize) -> Option<usize> {
    if let Some(found) = Input::ALL.iter().position(|input| input.name() == name) {
        return Some(found);
    }
    if let Some(part) = part_index(name) {
        return Some(part);
    }
    let (number, field) = name.strip_prefix("shaft_")?.split_once('_')?;
    let segment = number.parse::<usize>().ok()?.checked_sub(1)?;
    let field = SEGMENT_FIELDS.iter().position(|known| *known == field)?;
    (segment < segments).then(|| segment_input(segment, field))
}

/// What turns an input's value into the core's unit.
#[must_use]
pub fn factor(index: usize) -> f64 {
    if let Some(part) = index.checked_sub(PARTS_AT) {
        return PartInput::ALL[part].row().1;
    }
    Input::ALL
        .get(index)
        .map_or(MILLI, |input| input.name_and_factor().1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_names_agree() {
        for (k, input) in Input::ALL.iter().enumerate() {
            assert_eq!(*input as usize, k);
            assert_eq!(input_index(input.name(), 0), Some(k));
        }
        assert_eq!(input_index("shaft_2_diameter_mm", 2), Some(SCALARS + 4));
        assert_eq!(input_index("shaft_3_diameter_mm", 2), None);
        assert_eq!(input_index("shaft_0_length_mm", 2), None);
        assert_eq!(input_index("eccentricity", 2), None);
    }
}
