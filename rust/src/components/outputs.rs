//! The component model's result columns, and what has to be solved for each.

/// A result column of the component model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
#[expect(
    missing_docs,
    reason = "`PartOutput::name` is the name that users and documents know"
)]
pub enum PartOutput {
    LoadedTwist,
    TwistRing,
    TwistOutputContact,
    TwistPinBending,
    TwistPinRoot,
    TwistBearing,
    TwistShaft,
    TwistClearance,
    TangentStiffness3,
    TangentStiffness50,
    TangentStiffness100,
    LostMotion3,
    Backlash,
    ActiveOutputPinsMean,
    ActiveOutputPinsMin,
    ActiveOutputPinsMax,
    EffectiveOutputPins,
    ActiveRingPinsMean,
    OutputPinForceMax,
    RingPinForceMax,
    DiscLoadShareMax,
    BearingForceMax,
    RingPressureMax,
    OutputPressureMax,
    Efficiency,
    LossRing,
    LossOutput,
    LossBearing,
    TransmissionError,
    InputTorqueRipple,
    CurvatureRadiusMin,
    DiscMass,
    DiscInertia,
    DriveVolume,
    StiffnessWithoutClearance,
    RingPressurePin,
    RingPressureCrank,
    OutputPressurePin,
    OutputPressureCrank,
    RingPinForcePeakMin,
    OutputPinForcePeakMin,
    BearingForceMin,
    PinRootStress,
    ContactYieldRatio,
    PinYieldRatio,
    Solver,
}

/// Number of result columns.
pub const PART_OUTPUTS: usize = 46;

impl PartOutput {
    /// Every column, in order.
    pub const ALL: [PartOutput; PART_OUTPUTS] = [
        Self::LoadedTwist,
        Self::TwistRing,
        Self::TwistOutputContact,
        Self::TwistPinBending,
        Self::TwistPinRoot,
        Self::TwistBearing,
        Self::TwistShaft,
        Self::TwistClearance,
        Self::TangentStiffness3,
        Self::TangentStiffness50,
        Self::TangentStiffness100,
        Self::LostMotion3,
        Self::Backlash,
        Self::ActiveOutputPinsMean,
        Self::ActiveOutputPinsMin,
        Self::ActiveOutputPinsMax,
        Self::EffectiveOutputPins,
        Self::ActiveRingPinsMean,
        Self::OutputPinForceMax,
        Self::RingPinForceMax,
        Self::DiscLoadShareMax,
        Self::BearingForceMax,
        Self::RingPressureMax,
        Self::OutputPressureMax,
        Self::Efficiency,
        Self::LossRing,
        Self::LossOutput,
        Self::LossBearing,
        Self::TransmissionError,
        Self::InputTorqueRipple,
        Self::CurvatureRadiusMin,
        Self::DiscMass,
        Self::DiscInertia,
        Self::DriveVolume,
        Self::StiffnessWithoutClearance,
        Self::RingPressurePin,
        Self::RingPressureCrank,
        Self::OutputPressurePin,
        Self::OutputPressureCrank,
        Self::RingPinForcePeakMin,
        Self::OutputPinForcePeakMin,
        Self::BearingForceMin,
        Self::PinRootStress,
        Self::ContactYieldRatio,
        Self::PinYieldRatio,
        Self::Solver,
    ];

    /// Name of the column, with its unit.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LoadedTwist => "loaded_twist_arcmin",
            Self::TwistRing => "twist_ring_contacts_arcmin",
            Self::TwistOutputContact => "twist_output_contacts_arcmin",
            Self::TwistPinBending => "twist_pin_bending_arcmin",
            Self::TwistPinRoot => "twist_pin_root_arcmin",
            Self::TwistBearing => "twist_eccentric_bearing_arcmin",
            Self::TwistShaft => "twist_shaft_arcmin",
            Self::TwistClearance => "twist_clearance_arcmin",
            Self::TangentStiffness3 => "tangent_stiffness_3pct_nm_per_arcmin",
            Self::TangentStiffness50 => "tangent_stiffness_50pct_nm_per_arcmin",
            Self::TangentStiffness100 => "tangent_stiffness_100pct_nm_per_arcmin",
            Self::LostMotion3 => "lost_motion_3pct_arcmin",
            Self::Backlash => "backlash_arcmin",
            Self::ActiveOutputPinsMean => "active_output_pins_mean",
            Self::ActiveOutputPinsMin => "active_output_pins_min",
            Self::ActiveOutputPinsMax => "active_output_pins_max",
            Self::EffectiveOutputPins => "effective_output_pins",
            Self::ActiveRingPinsMean => "active_ring_pins_mean",
            Self::OutputPinForceMax => "output_pin_force_max_n",
            Self::RingPinForceMax => "ring_pin_force_max_n",
            Self::DiscLoadShareMax => "disc_load_share_max",
            Self::BearingForceMax => "eccentric_bearing_force_max_n",
            Self::RingPressureMax => "ring_contact_pressure_max_mpa",
            Self::OutputPressureMax => "output_contact_pressure_max_mpa",
            Self::Efficiency => "efficiency",
            Self::LossRing => "loss_share_ring",
            Self::LossOutput => "loss_share_output",
            Self::LossBearing => "loss_share_eccentric_bearing",
            Self::TransmissionError => "transmission_error_pp_arcmin",
            Self::InputTorqueRipple => "input_torque_ripple_pp",
            Self::CurvatureRadiusMin => "profile_curvature_radius_min_mm",
            Self::DiscMass => "disc_mass_kg",
            Self::DiscInertia => "disc_inertia_kg_m2",
            Self::DriveVolume => "drive_volume_mm3",
            Self::StiffnessWithoutClearance => {
                "tangent_stiffness_100pct_without_clearance_nm_per_arcmin"
            }
            Self::RingPressurePin => "ring_contact_pressure_max_pin",
            Self::RingPressureCrank => "ring_contact_pressure_max_crank_deg",
            Self::OutputPressurePin => "output_contact_pressure_max_pin",
            Self::OutputPressureCrank => "output_contact_pressure_max_crank_deg",
            Self::RingPinForcePeakMin => "ring_pin_force_peak_min_n",
            Self::OutputPinForcePeakMin => "output_pin_force_peak_min_n",
            Self::BearingForceMin => "eccentric_bearing_force_min_n",
            Self::PinRootStress => "pin_root_stress_max_mpa",
            Self::ContactYieldRatio => "contact_yield_ratio_max",
            Self::PinYieldRatio => "pin_yield_ratio_max",
            Self::Solver => "solver_status",
        }
    }

    /// The column of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|output| output.name() == name)
    }
}

/// What a row of results is solved for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Rated torque over the few positions of the crank.
    pub rated: bool,
    /// The contacts' forces there.
    pub forces: bool,
    /// The tangent stiffness there.
    pub stiffness: bool,
    /// Half the rated torque.
    pub half: bool,
    /// 3 % of it.
    pub low: bool,
    /// 3 % of it in the other sense.
    pub reverse: bool,
    /// Gaps at rest.
    pub gaps: bool,
    /// Rated torque over the many positions of the crank.
    pub fine: bool,
    /// Areas and moments of the discs.
    pub mass: bool,
    /// Worst contacts, extremes over the crank and what comes near yield, at rated torque.
    pub details: bool,
    /// Rated torque without clearances.
    pub without_clearance: bool,
}

impl Wanted {
    /// What some columns need.
    #[must_use]
    pub fn by(outputs: impl IntoIterator<Item = PartOutput>) -> Self {
        let mut wanted = Self::default();
        for output in outputs {
            match output {
                PartOutput::LoadedTwist | PartOutput::Solver => wanted.rated = true,
                PartOutput::TangentStiffness100 => {
                    (wanted.rated, wanted.stiffness) = (true, true);
                }
                PartOutput::TangentStiffness50 => wanted.half = true,
                PartOutput::TangentStiffness3 => wanted.low = true,
                PartOutput::LostMotion3 => (wanted.low, wanted.reverse) = (true, true),
                PartOutput::Backlash => wanted.gaps = true,
                PartOutput::TransmissionError | PartOutput::InputTorqueRipple => {
                    wanted.fine = true;
                }
                PartOutput::DiscMass | PartOutput::DiscInertia => wanted.mass = true,
                PartOutput::StiffnessWithoutClearance => wanted.without_clearance = true,
                PartOutput::RingPressurePin
                | PartOutput::RingPressureCrank
                | PartOutput::OutputPressurePin
                | PartOutput::OutputPressureCrank
                | PartOutput::RingPinForcePeakMin
                | PartOutput::OutputPinForcePeakMin
                | PartOutput::BearingForceMin
                | PartOutput::PinRootStress
                | PartOutput::ContactYieldRatio
                | PartOutput::PinYieldRatio => {
                    (wanted.rated, wanted.forces, wanted.details) = (true, true, true);
                }
                PartOutput::CurvatureRadiusMin | PartOutput::DriveVolume => {}
                _ => (wanted.rated, wanted.forces) = (true, true),
            }
        }
        // Lower loads start from the rated one.
        wanted.rated |= wanted.half || wanted.low || wanted.reverse;
        wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_names_agree() {
        for (k, output) in PartOutput::ALL.iter().enumerate() {
            assert_eq!(*output as usize, k);
            assert_eq!(PartOutput::named(output.name()), Some(*output));
        }
    }
}
