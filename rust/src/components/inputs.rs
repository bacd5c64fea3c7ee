//! The component model's own inputs by name, with their units and what stands in where a drive
//! gives none.

use crate::model::inputs::Input;

/// A number that the component model or the torsional train reads, and the published model does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
#[expect(
    missing_docs,
    reason = "`PartInput::name` is the name that users and documents know"
)]
pub enum PartInput {
    RingPinRadius,
    DiscWidth,
    RingClearance,
    RingCircleEnlargement,
    ProfileOffset,
    ProfileShift,
    ProfileRotation,
    HoleClearance,
    BearingStiffness,
    BearingClearance,
    Reach1,
    Reach2,
    Reach3,
    Reach4,
    RingYoungsModulus,
    RingPoisson,
    DiscYoungsModulus,
    DiscPoisson,
    DiscDensity,
    FrictionRing,
    FrictionOutput,
    FrictionBearing,
    ContactYieldStrength,
    PinYieldStrength,
    LoadInertia,
    EccentricInertia,
    FlangeInertia,
    CouplingStiffness,
}

/// Number of the component model's inputs.
pub const PART_INPUTS: usize = 28;
/// Place of the first of them among all inputs, far behind the shaft's.
pub const PARTS_AT: usize = 1 << 16;

const MILLI: f64 = 1e-3;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// What stands in for an input that a drive does not give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Substitute {
    /// Nothing: without it the drive has no component model.
    Required,
    /// A number, in the input's own unit.
    Number(f64),
    /// Another input: the material of the shaft and the output pins.
    Same(Input),
    /// This share of a disc's width: discs a third of their width apart, a sixth from the flange.
    Widths(f64),
    /// Nothing, and nothing is missing: the equilibria do not depend on it.
    Absent,
}

impl Substitute {
    /// Whether a number is assumed for what is left out. A variant of a study then has to give one.
    #[must_use]
    pub const fn is_assumed(self) -> bool {
        matches!(self, Self::Number(_) | Self::Same(_) | Self::Widths(_))
    }
}

impl PartInput {
    /// Every input, in order.
    pub const ALL: [PartInput; PART_INPUTS] = [
        PartInput::RingPinRadius,
        PartInput::DiscWidth,
        PartInput::RingClearance,
        PartInput::RingCircleEnlargement,
        PartInput::ProfileOffset,
        PartInput::ProfileShift,
        PartInput::ProfileRotation,
        PartInput::HoleClearance,
        PartInput::BearingStiffness,
        PartInput::BearingClearance,
        PartInput::Reach1,
        PartInput::Reach2,
        PartInput::Reach3,
        PartInput::Reach4,
        PartInput::RingYoungsModulus,
        PartInput::RingPoisson,
        PartInput::DiscYoungsModulus,
        PartInput::DiscPoisson,
        PartInput::DiscDensity,
        PartInput::FrictionRing,
        PartInput::FrictionOutput,
        PartInput::FrictionBearing,
        PartInput::ContactYieldStrength,
        PartInput::PinYieldStrength,
        PartInput::LoadInertia,
        PartInput::EccentricInertia,
        PartInput::FlangeInertia,
        PartInput::CouplingStiffness,
    ];

    /// Name and unit as in a drive file, what turns a value into SI, and the default.
    #[must_use]
    pub const fn row(self) -> (&'static str, f64, Substitute) {
        use Substitute::{Absent, Number, Required, Same, Widths};
        match self {
            Self::RingPinRadius => ("ring_pin_radius_mm", MILLI, Required),
            Self::DiscWidth => ("disc_width_mm", MILLI, Required),
            Self::RingClearance => ("ring_clearance_mm", MILLI, Number(0.0)),
            Self::RingCircleEnlargement => ("ring_circle_enlargement_mm", MILLI, Number(0.0)),
            Self::ProfileOffset => ("profile_offset_mm", MILLI, Number(0.0)),
            Self::ProfileShift => ("profile_shift_mm", MILLI, Number(0.0)),
            Self::ProfileRotation => ("profile_rotation_deg", DEGREE, Number(0.0)),
            Self::HoleClearance => ("hole_clearance_mm", MILLI, Number(0.0)),
            Self::BearingStiffness => ("eccentric_bearing_stiffness_n_per_mm", 1e3, Number(4e5)),
            Self::BearingClearance => ("eccentric_bearing_clearance_mm", MILLI, Number(0.0)),
            Self::Reach1 => ("disc_1_reach_mm", MILLI, Widths(2.0 / 3.0)),
            Self::Reach2 => ("disc_2_reach_mm", MILLI, Widths(2.0)),
            Self::Reach3 => ("disc_3_reach_mm", MILLI, Widths(10.0 / 3.0)),
            Self::Reach4 => ("disc_4_reach_mm", MILLI, Widths(14.0 / 3.0)),
            Self::RingYoungsModulus => ("ring_youngs_modulus_gpa", 1e9, Same(Input::YoungsModulus)),
            Self::RingPoisson => ("ring_poisson_ratio", 1.0, Same(Input::PoissonRatio)),
            Self::DiscYoungsModulus => ("disc_youngs_modulus_gpa", 1e9, Same(Input::YoungsModulus)),
            Self::DiscPoisson => ("disc_poisson_ratio", 1.0, Same(Input::PoissonRatio)),
            Self::DiscDensity => ("disc_density_kg_m3", 1.0, Number(7850.0)),
            Self::FrictionRing => ("friction_ring", 1.0, Number(0.05)),
            Self::FrictionOutput => ("friction_output", 1.0, Number(0.05)),
            Self::FrictionBearing => ("friction_bearing", 1.0, Number(0.003)),
            Self::ContactYieldStrength => ("contact_yield_strength_mpa", 1e6, Number(1700.0)),
            Self::PinYieldStrength => ("pin_yield_strength_mpa", 1e6, Number(750.0)),
            Self::LoadInertia => ("load_inertia_kg_m2", 1.0, Absent),
            Self::EccentricInertia => ("eccentric_inertia_kg_m2", 1.0, Absent),
            Self::FlangeInertia => ("flange_inertia_kg_m2", 1.0, Absent),
            Self::CouplingStiffness => ("coupling_stiffness_nm_per_rad", 1.0, Absent),
        }
    }

    /// Whether it is one of the torsional train's parts, without which nothing is missing.
    #[must_use]
    pub const fn is_of_train(self) -> bool {
        matches!(self.row().2, Substitute::Absent)
    }

    /// Name as in a drive file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }
}

/// Position among all inputs of one of the component model's, by name.
#[must_use]
pub fn part_index(name: &str) -> Option<usize> {
    let found = PartInput::ALL.iter().position(|input| input.name() == name);
    found.map(|place| PARTS_AT + place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_names_agree() {
        for (k, input) in PartInput::ALL.iter().enumerate() {
            assert_eq!(*input as usize, k);
            assert_eq!(part_index(input.name()), Some(PARTS_AT + k));
        }
        assert_eq!(part_index("ring_pin_radius"), None);
    }
}
