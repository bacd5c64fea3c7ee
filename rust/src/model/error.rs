//! Why a design cannot be built: one variant per physical refusal, with the numbers that show it.

use thiserror::Error;

/// A length as drive files have it (mm), without the digits that only the conversion makes.
fn mm(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e6
}

/// A physical or formal reason to refuse a design.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum DesignError {
    /// An input is NaN or infinite.
    #[error("{parameter} is not a finite number")]
    NonFinite {
        /// Name of the input.
        parameter: &'static str,
    },
    /// A dimension, modulus or rating that must be above zero is not.
    #[error("{parameter} must be above zero, found {value} in SI units")]
    NonPositive {
        /// Name of the input.
        parameter: &'static str,
        /// The value found, SI.
        value: f64,
    },
    /// A dimension that may be zero is negative.
    #[error("{parameter} must not be negative, found {value} in SI units")]
    Negative {
        /// Name of the input.
        parameter: &'static str,
        /// The value found, SI.
        value: f64,
    },
    /// The ratio is not a whole number from 3 to 300.
    #[error("ratio must be a whole number from 3 to 300, found {ratio}")]
    RatioOutOfRange {
        /// The ratio found.
        ratio: f64,
    },
    /// The number of discs is not a whole number from 1 to 4.
    #[error("disc_count must be a whole number from 1 to 4, found {discs}")]
    DiscCountOutOfRange {
        /// The number found.
        discs: f64,
    },
    /// The number of output pins is not a whole number from 3 to 64.
    #[error("output_pin_count must be a whole number from 3 to 64, found {pins}")]
    PinCountOutOfRange {
        /// The number found.
        pins: f64,
    },
    /// The short-width coefficient K1 = e (i + 1) / R_ring reaches one, within rounding: the profile
    /// has cusps, or loops above it.
    #[error(
        "eccentricity too large for the ring: K1 = e (i + 1) / R_ring = {k1:.4}, must stay below 1"
    )]
    EccentricityTooLargeForRing {
        /// Short-width coefficient K1.
        k1: f64,
    },
    /// The disc does not fit inside the circle of the ring pins.
    #[error(
        "disc of radius {} mm (disc_outer_radius_mm) does not fit inside the ring-pin circle of radius {} mm (ring_pin_circle_radius_mm)", mm(*disc_radius), mm(*ring_radius)
    )]
    DiscExceedsRing {
        /// Disc's outer radius (m).
        disc_radius: f64,
        /// Radius of the ring pins' circle (m).
        ring_radius: f64,
    },
    /// The hole's centre never crosses the pins' pitch circle (e >= 2 R_OP).
    #[error(
        "hole centre never crosses the pitch circle: e / (2 R_OP) = {ratio:.4}, must stay below 1"
    )]
    HoleNeverCrossesPitchCircle {
        /// e / (2 R_OP).
        ratio: f64,
    },
    /// The pin's bore leaves no wall.
    #[error("output pin bore {} mm leaves no wall in a pin of {} mm", mm(*bore), mm(*diameter))]
    PinBoreTooLarge {
        /// Bore diameter (m).
        bore: f64,
        /// Pin diameter (m).
        diameter: f64,
    },
    /// Neighbouring holes of a disc overlap.
    #[error("neighbouring holes overlap: web {} mm; take fewer or thinner output pins or a larger output_pin_circle_radius_mm", mm(*web))]
    HolesOverlap {
        /// Material between two holes (m), zero or negative here.
        web: f64,
    },
    /// The holes break through the disc's rim.
    #[error("holes break through the disc's rim: web {} mm; take thinner output pins, a smaller output_pin_circle_radius_mm or a larger disc_outer_radius_mm", mm(*web))]
    HoleBreaksRim {
        /// Material between hole and rim (m), zero or negative here.
        web: f64,
    },
    /// The holes break into the disc's bore.
    #[error("holes break into the disc's bore: web {} mm; take thinner output pins, a larger output_pin_circle_radius_mm or a smaller disc_bore_radius_mm", mm(*web))]
    HoleBreaksBore {
        /// Material between hole and bore (m), zero or negative here.
        web: f64,
    },
    /// The shaft's end at the flange reaches beyond the pin circle.
    #[error(
        "flange cuts the pin circle: the shaft ends with a diameter of {} mm, the circle of the output pins has {} mm; make the last shaft segment's diameter smaller or output_pin_circle_radius_mm larger", mm(2.0 * flange_radius), mm(2.0 * pin_circle_radius)
    )]
    FlangeCutsPinCircle {
        /// Radius of the shaft's end at the flange (m).
        flange_radius: f64,
        /// Radius of the pins' circle (m).
        pin_circle_radius: f64,
    },
    /// Poisson's ratio is outside what an isotropic solid can have.
    #[error("poisson_ratio must lie above -1 and not above 0.5, found {poisson}")]
    PoissonOutOfRange {
        /// The value found.
        poisson: f64,
    },
    /// The shaft's diameter falls on the way from the free end to the flange.
    #[error("shaft steps down from {} mm to {} mm towards the flange; Eq. (6) needs d < D", mm(*from), mm(*to))]
    ShaftStepNotAscending {
        /// Diameter before the step (m).
        from: f64,
        /// Diameter after the step (m).
        to: f64,
    },
    /// The keyway reaches the shaft's axis.
    #[error("keyway of depth {} mm reaches the axis of a shaft of {} mm", mm(*depth), mm(*diameter))]
    KeywayTooDeep {
        /// Depth of the keyway (m).
        depth: f64,
        /// Shaft diameter (m).
        diameter: f64,
    },
}

/// What the `status` column of a sweep says of one variant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
#[expect(
    missing_docs,
    reason = "each is the batch form of the DesignError of the same name"
)]
pub enum Status {
    Ok = 0,
    NonFiniteInput,
    NonPositiveDimension,
    NegativeDimension,
    RatioOutOfRange,
    DiscCountOutOfRange,
    PinCountOutOfRange,
    EccentricityTooLargeForRing,
    DiscExceedsRing,
    HoleNeverCrossesPitchCircle,
    PinBoreTooLarge,
    HolesOverlap,
    HoleBreaksRim,
    HoleBreaksBore,
    FlangeCutsPinCircle,
    PoissonOutOfRange,
    ShaftStepNotAscending,
    KeywayTooDeep,
}

impl Status {
    /// Every status, in the order of its code.
    pub const ALL: [Status; 18] = [
        Status::Ok,
        Status::NonFiniteInput,
        Status::NonPositiveDimension,
        Status::NegativeDimension,
        Status::RatioOutOfRange,
        Status::DiscCountOutOfRange,
        Status::PinCountOutOfRange,
        Status::EccentricityTooLargeForRing,
        Status::DiscExceedsRing,
        Status::HoleNeverCrossesPitchCircle,
        Status::PinBoreTooLarge,
        Status::HolesOverlap,
        Status::HoleBreaksRim,
        Status::HoleBreaksBore,
        Status::FlangeCutsPinCircle,
        Status::PoissonOutOfRange,
        Status::ShaftStepNotAscending,
        Status::KeywayTooDeep,
    ];

    /// This, or the other where this is ok.
    #[inline(always)]
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        if matches!(self, Status::Ok) {
            other
        } else {
            self
        }
    }

    /// The word that stands in the table.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Status::Ok => "ok",
            Status::NonFiniteInput => "non_finite_input",
            Status::NonPositiveDimension => "non_positive_dimension",
            Status::NegativeDimension => "negative_dimension",
            Status::RatioOutOfRange => "ratio_out_of_range",
            Status::DiscCountOutOfRange => "disc_count_out_of_range",
            Status::PinCountOutOfRange => "pin_count_out_of_range",
            Status::EccentricityTooLargeForRing => "eccentricity_too_large_for_ring",
            Status::DiscExceedsRing => "disc_exceeds_ring",
            Status::HoleNeverCrossesPitchCircle => "hole_never_crosses_pitch_circle",
            Status::PinBoreTooLarge => "pin_bore_too_large",
            Status::HolesOverlap => "holes_overlap",
            Status::HoleBreaksRim => "hole_breaks_rim",
            Status::HoleBreaksBore => "hole_breaks_bore",
            Status::FlangeCutsPinCircle => "flange_cuts_pin_circle",
            Status::PoissonOutOfRange => "poisson_out_of_range",
            Status::ShaftStepNotAscending => "shaft_step_not_ascending",
            Status::KeywayTooDeep => "keyway_too_deep",
        }
    }
}

impl DesignError {
    /// The status under which a sweep files this refusal.
    #[must_use]
    pub const fn status(&self) -> Status {
        match self {
            Self::NonFinite { .. } => Status::NonFiniteInput,
            Self::NonPositive { .. } => Status::NonPositiveDimension,
            Self::Negative { .. } => Status::NegativeDimension,
            Self::RatioOutOfRange { .. } => Status::RatioOutOfRange,
            Self::DiscCountOutOfRange { .. } => Status::DiscCountOutOfRange,
            Self::PinCountOutOfRange { .. } => Status::PinCountOutOfRange,
            Self::EccentricityTooLargeForRing { .. } => Status::EccentricityTooLargeForRing,
            Self::DiscExceedsRing { .. } => Status::DiscExceedsRing,
            Self::HoleNeverCrossesPitchCircle { .. } => Status::HoleNeverCrossesPitchCircle,
            Self::PinBoreTooLarge { .. } => Status::PinBoreTooLarge,
            Self::HolesOverlap { .. } => Status::HolesOverlap,
            Self::HoleBreaksRim { .. } => Status::HoleBreaksRim,
            Self::HoleBreaksBore { .. } => Status::HoleBreaksBore,
            Self::FlangeCutsPinCircle { .. } => Status::FlangeCutsPinCircle,
            Self::PoissonOutOfRange { .. } => Status::PoissonOutOfRange,
            Self::ShaftStepNotAscending { .. } => Status::ShaftStepNotAscending,
            Self::KeywayTooDeep { .. } => Status::KeywayTooDeep,
        }
    }
}

/// Why a value is not above zero.
// Out of line: inlined, the compiler works out every refusal beside every good value.
#[cold]
#[inline(never)]
pub(crate) fn not_positive(parameter: &'static str, value: f64) -> DesignError {
    if value.is_finite() {
        DesignError::NonPositive { parameter, value }
    } else {
        DesignError::NonFinite { parameter }
    }
}

/// Why a value is below zero.
#[cold]
#[inline(never)]
pub(crate) fn negative(parameter: &'static str, value: f64) -> DesignError {
    if value.is_finite() {
        DesignError::Negative { parameter, value }
    } else {
        DesignError::NonFinite { parameter }
    }
}
