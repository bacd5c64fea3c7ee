//! The model cut into stages by the inputs each needs, so that a study computes a stage once per
//! combination of the axes it depends on.
//!
//! A stage's formulas are written once, without branches. With checks that keep the first reason they
//! compute one variant; with checks that only keep whether all hold, a block at a time.

use std::ops::Range;

use crate::kernel::lanes::Variant;
use crate::model::MAX_PINS;
use crate::model::checks::Checks;
use crate::model::error::DesignError;
use crate::model::inputs::Input;
use crate::model::pin::{Pin, pin_compliance};
use crate::model::rounding::{is_whole_within, smaller};

/// K1 this close to one is one but for rounding: the profile has cusps.
const CUSP: f64 = 1e-12;

/// What a stage gives for one variant. Where the variant is refused it is meaningless.
pub(crate) trait Stage: Copy + Send + Sync {
    /// The same for every variant of a block.
    type Block: Send;
    /// Before anything is known.
    const NONE: Self;
    /// A block of variants alike.
    fn block(self) -> Box<Self::Block>;
    /// Writes the outcome of one variant of a block.
    fn put(self, block: &mut Self::Block, row: usize);
    /// Writes the outcome of variants that are alike.
    fn put_all(self, block: &mut Self::Block, rows: Range<usize>);
    /// The outcome of one variant of a block.
    fn get(block: &Self::Block, row: usize) -> Self;
}

/// Declares a stage's outcome, its block of variants, and [`Stage`] for them.
macro_rules! stage {
    (
        $(#[$doc:meta])*
        $name:ident, $block:ident { $($(#[$field_doc:meta])* $field:ident,)+ }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub(crate) struct $name {
            $($(#[$field_doc])* pub $field: f64,)+
        }

        $crate::kernel::stages::blocks_of!($name, $block { $($(#[$field_doc])* $field,)+ });
    };
}
pub(crate) use stage;

/// Declares the block of variants of a struct of numbers, and [`Stage`] for them.
macro_rules! blocks_of {
    ($name:ident, $block:ident { $($(#[$field_doc:meta])* $field:ident,)+ }) => {
        #[doc = concat!("[`", stringify!($name), "`] of every variant of a block.")]
        #[derive(Debug, Clone)]
        pub(crate) struct $block {
            $($(#[$field_doc])* pub $field: $crate::kernel::lanes::Lanes,)+
        }

        impl $crate::kernel::stages::Stage for $name {
            type Block = $block;
            const NONE: Self = Self { $($field: f64::NAN,)+ };

            fn block(self) -> Box<$block> {
                Box::new($block { $($field: [self.$field; $crate::kernel::lanes::BLOCK],)+ })
            }

            #[inline(always)]
            fn put(self, block: &mut $block, row: usize) {
                $(block.$field[row] = self.$field;)+
            }

            #[inline(always)]
            fn put_all(self, block: &mut $block, rows: std::ops::Range<usize>) {
                $(block.$field[rows.clone()].fill(self.$field);)+
            }

            #[inline(always)]
            fn get(block: &$block, row: usize) -> Self {
                Self { $($field: block.$field[row],)+ }
            }
        }
    };
}
pub(crate) use blocks_of;

stage! {
    /// Whether discs, holes and pins fit; hole and web.
    Geometry, GeometryBlock {
        /// Hole diameter (m): pin + 2 bush walls + 2 e.
        hole_diameter,
        /// Least material (m) between two holes, hole and rim, hole and bore.
        hole_web,
        /// Short-width coefficient K1 = e (i + 1) / R_ring.
        short_width_coefficient,
    }
}

stage! {
    /// The output shaft.
    Shaft, ShaftBlock {
        /// C_OS^t (rad/(N m)); NaN for a drive that gives its stiffness instead of a shaft.
        compliance,
    }
}

stage! {
    /// One output pin.
    PinBending, PinBendingBlock {
        /// C_OP (rad/(N m)).
        compliance,
        /// Root stress per force (Pa/N).
        stress_per_force,
        /// R_OP (m).
        circle_radius,
    }
}

stage! {
    /// Ratings and what is measured rather than computed.
    Rating, RatingBlock {
        /// T_N = P / omega (N m).
        nominal_torque,
        /// Rated output torque (N m).
        output_torque,
        /// gamma (deg).
        free_play_deg,
        /// Input inertia (kg m^2), or NaN.
        inertia,
        /// Output compliance given as measured (rad/(N m)), or NaN.
        given_compliance,
    }
}

/// The whole numbers of a design, with the number of discs checked.
pub(crate) struct WholeNumbers {
    pub ratio: f64,
    pub pins: f64,
}

impl WholeNumbers {
    #[inline(always)]
    pub(crate) fn of(inputs: &impl Variant, checks: &mut impl Checks) -> Self {
        let ratio = checks.finite("ratio", inputs.get(Input::Ratio));
        checks.require(is_whole_within(ratio, 3.0, 300.0), || {
            DesignError::RatioOutOfRange { ratio }
        });
        let discs = checks.finite("disc_count", inputs.get(Input::DiscCount));
        checks.require(is_whole_within(discs, 1.0, 4.0), || {
            DesignError::DiscCountOutOfRange { discs }
        });
        let pins = checks.finite("output_pin_count", inputs.get(Input::OutputPinCount));
        checks.require(is_whole_within(pins, 3.0, MAX_PINS as f64), || {
            DesignError::PinCountOutOfRange { pins }
        });
        Self { ratio, pins }
    }
}

impl Geometry {
    /// The scalar inputs this stage reads; it reads the shaft's diameter at the flange too.
    pub(crate) const INPUTS: [Input; 11] = [
        Input::Ratio,
        Input::DiscCount,
        Input::Eccentricity,
        Input::RingPinCircleRadius,
        Input::OutputPinCount,
        Input::OutputPinCircleRadius,
        Input::OutputPinDiameter,
        Input::OutputPinBore,
        Input::BushWall,
        Input::DiscOuterRadius,
        Input::DiscBoreRadius,
    ];

    /// Checks and computes.
    #[inline(always)]
    pub(crate) fn of(inputs: &impl Variant, checks: &mut impl Checks) -> Self {
        let WholeNumbers { ratio, .. } = WholeNumbers::of(inputs, checks);
        let e = checks.positive("eccentricity", inputs.get(Input::Eccentricity));
        let ring = checks.positive(
            "ring_pin_circle_radius",
            inputs.get(Input::RingPinCircleRadius),
        );
        let circle = checks.positive(
            "output_pin_circle_radius",
            inputs.get(Input::OutputPinCircleRadius),
        );
        let diameter = checks.positive("output_pin_diameter", inputs.get(Input::OutputPinDiameter));
        let bore = checks.non_negative("output_pin_bore", inputs.get(Input::OutputPinBore));
        let wall = checks.non_negative("bush_wall", inputs.get(Input::BushWall));
        let rim = checks.positive("disc_outer_radius", inputs.get(Input::DiscOuterRadius));
        let hub = checks.non_negative("disc_bore_radius", inputs.get(Input::DiscBoreRadius));
        let k1 = e * (ratio + 1.0) / ring;
        checks.require(k1 < 1.0 - CUSP, || {
            DesignError::EccentricityTooLargeForRing { k1 }
        });
        checks.require(rim < ring, || DesignError::DiscExceedsRing {
            disc_radius: rim,
            ring_radius: ring,
        });
        checks.require(e < 2.0 * circle, || {
            DesignError::HoleNeverCrossesPitchCircle {
                ratio: e / (2.0 * circle),
            }
        });
        checks.require(bore < diameter, || DesignError::PinBoreTooLarge {
            bore,
            diameter,
        });
        let hole = diameter + 2.0 * wall + 2.0 * e;
        let between = 2.0 * circle * inputs.half_pitch_sine() - hole;
        let outer = rim - circle - 0.5 * hole;
        let inner = circle - 0.5 * hole - hub;
        checks.require(between > 0.0, || DesignError::HolesOverlap { web: between });
        checks.require(outer > 0.0, || DesignError::HoleBreaksRim { web: outer });
        checks.require(inner > 0.0, || DesignError::HoleBreaksBore { web: inner });
        let flange = inputs.flange_diameter();
        let beyond = (flange > 2.0 * circle) & (flange <= f64::MAX);
        checks.require(!beyond, || DesignError::FlangeCutsPinCircle {
            flange_radius: 0.5 * flange,
            pin_circle_radius: circle,
        });
        Self {
            hole_diameter: hole,
            hole_web: smaller(smaller(between, outer), inner),
            short_width_coefficient: k1,
        }
    }
}

impl Shaft {
    /// The scalar inputs this stage reads; it reads every segment's too. Computed by
    /// [`crate::kernel::shaft_plan::ShaftPlan`].
    pub(crate) const INPUTS: [Input; 3] = [
        Input::YoungsModulus,
        Input::PoissonRatio,
        Input::KeywayCoefficient,
    ];
}

impl PinBending {
    /// The inputs this stage reads.
    pub(crate) const INPUTS: [Input; 6] = [
        Input::YoungsModulus,
        Input::PoissonRatio,
        Input::OutputPinDiameter,
        Input::OutputPinBore,
        Input::OutputPinLength,
        Input::OutputPinCircleRadius,
    ];

    /// Checks and computes.
    #[inline(always)]
    pub(crate) fn of(inputs: &impl Variant, checks: &mut impl Checks) -> Self {
        let pin = Pin {
            diameter: inputs.get(Input::OutputPinDiameter),
            bore: inputs.get(Input::OutputPinBore),
            length: inputs.get(Input::OutputPinLength),
        };
        pin.require(checks);
        let flexibility = pin.flexibility(
            inputs.get(Input::YoungsModulus),
            inputs.get(Input::PoissonRatio),
        );
        let circle = inputs.get(Input::OutputPinCircleRadius);
        Self {
            compliance: pin_compliance(flexibility, circle),
            stress_per_force: pin.root_stress(1.0),
            circle_radius: circle,
        }
    }
}

impl Rating {
    /// The inputs this stage reads.
    pub(crate) const INPUTS: [Input; 6] = [
        Input::InputPower,
        Input::InputSpeed,
        Input::OutputTorque,
        Input::FreePlay,
        Input::InputInertia,
        Input::OutputStiffness,
    ];

    /// Computes. `needs_stiffness`: there is no shaft to compute it from.
    #[inline(always)]
    pub(crate) fn of(
        inputs: &impl Variant,
        needs_stiffness: bool,
        checks: &mut impl Checks,
    ) -> Self {
        let power = checks.positive("input_power", inputs.get(Input::InputPower));
        let speed = checks.positive("input_speed", inputs.get(Input::InputSpeed));
        let inertia = inputs.get(Input::InputInertia);
        let stiffness = inputs.get(Input::OutputStiffness);
        let given = if inertia.is_nan() { 1.0 } else { inertia };
        checks.positive("input_inertia", given);
        let is_given = needs_stiffness | !stiffness.is_nan();
        checks.positive("output_stiffness", if is_given { stiffness } else { 1.0 });
        Self {
            nominal_torque: power / speed,
            output_torque: checks.positive("output_torque", inputs.get(Input::OutputTorque)),
            free_play_deg: checks.non_negative("free_play", inputs.get(Input::FreePlay)),
            inertia,
            given_compliance: 1.0 / stiffness,
        }
    }
}
