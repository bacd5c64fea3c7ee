//! The model cut into stages by the inputs each needs, so that a study computes a stage once per
//! combination of the axes it depends on.

use crate::active_pins::{ActiveCount, Criterion, MAX_PINS, PinMap};
use crate::error::{DesignError, Status, finite, non_negative, positive};
use crate::hypotrochoid::crossing_angle;
use crate::inputs::{Input, Inputs};
use crate::pin::{Pin, pin_compliance};
use crate::rounding::{is_whole_within, smaller};
use crate::shaft_plan::ShaftPlan;

/// What a stage gives for one variant. Where the status is not ok the rest is meaningless.
pub trait Stage: Copy + Send + Sync {
    /// The first reason of this stage to refuse the variant.
    fn status(&self) -> Status;
    /// The stage's outcome for a variant it refuses.
    fn refused(status: Status) -> Self;
}

macro_rules! stage {
    ($name:ident) => {
        impl Stage for $name {
            #[inline]
            fn status(&self) -> Status {
                self.status
            }
            #[inline]
            fn refused(status: Status) -> Self {
                Self {
                    status,
                    ..Self::NONE
                }
            }
        }
    };
}

/// Whether discs, holes and pins fit; hole and web.
#[derive(Debug, Clone, Copy)]
pub struct Geometry {
    status: Status,
    /// Hole diameter (m): pin + 2 bush walls + 2 e.
    pub hole_diameter: f64,
    /// Least material (m) between two holes, hole and rim, hole and bore.
    pub hole_web: f64,
    /// Short-width coefficient K1 = e (i + 1) / R_ring.
    pub short_width_coefficient: f64,
}
stage!(Geometry);

impl Geometry {
    const NONE: Self = Self {
        status: Status::Ok,
        hole_diameter: f64::NAN,
        hole_web: f64::NAN,
        short_width_coefficient: f64::NAN,
    };
    /// The inputs this stage reads.
    pub const INPUTS: [Input; 11] = [
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
    ///
    /// # Errors
    /// The first [`DesignError`] met.
    #[inline(always)]
    pub fn of(inputs: &Inputs) -> Result<Self, DesignError> {
        let Counts { ratio, pins, .. } = Counts::of(inputs)?;
        let e = positive("eccentricity", inputs.get(Input::Eccentricity))?;
        let ring = positive(
            "ring_pin_circle_radius",
            inputs.get(Input::RingPinCircleRadius),
        )?;
        let circle = positive(
            "output_pin_circle_radius",
            inputs.get(Input::OutputPinCircleRadius),
        )?;
        let diameter = positive("output_pin_diameter", inputs.get(Input::OutputPinDiameter))?;
        let bore = non_negative("output_pin_bore", inputs.get(Input::OutputPinBore))?;
        let wall = non_negative("bush_wall", inputs.get(Input::BushWall))?;
        let rim = positive("disc_outer_radius", inputs.get(Input::DiscOuterRadius))?;
        let hub = non_negative("disc_bore_radius", inputs.get(Input::DiscBoreRadius))?;
        let k1 = e * (ratio + 1.0) / ring;
        if k1 >= 1.0 {
            return Err(DesignError::EccentricityTooLargeForRing { k1 });
        }
        if rim >= ring {
            return Err(DesignError::DiscExceedsRing {
                disc_radius: rim,
                ring_radius: ring,
            });
        }
        if e >= 2.0 * circle {
            return Err(DesignError::HoleNeverCrossesPitchCircle {
                ratio: e / (2.0 * circle),
            });
        }
        if bore >= diameter {
            return Err(DesignError::PinBoreTooLarge { bore, diameter });
        }
        let hole = diameter + 2.0 * wall + 2.0 * e;
        let between = 2.0 * circle * SIN_HALF_PITCH.0[pins as usize] - hole;
        let outer = rim - circle - 0.5 * hole;
        let inner = circle - 0.5 * hole - hub;
        if between <= 0.0 {
            return Err(DesignError::HolesOverlap { web: between });
        }
        if outer <= 0.0 {
            return Err(DesignError::HoleBreaksRim { web: outer });
        }
        if inner <= 0.0 {
            return Err(DesignError::HoleBreaksBore { web: inner });
        }
        Ok(Self {
            status: Status::Ok,
            hole_diameter: hole,
            hole_web: smaller(smaller(between, outer), inner),
            short_width_coefficient: k1,
        })
    }
}

/// The three whole numbers of a design, checked.
struct Counts {
    ratio: f64,
    discs: f64,
    pins: f64,
}

impl Counts {
    #[inline(always)]
    fn of(inputs: &Inputs) -> Result<Self, DesignError> {
        let ratio = finite("ratio", inputs.get(Input::Ratio))?;
        if !is_whole_within(ratio, 3.0, 300.0) {
            return Err(DesignError::RatioOutOfRange { ratio });
        }
        let discs = finite("disc_count", inputs.get(Input::DiscCount))?;
        if !is_whole_within(discs, 1.0, 4.0) {
            return Err(DesignError::DiscCountOutOfRange { discs });
        }
        let pins = finite("output_pin_count", inputs.get(Input::OutputPinCount))?;
        if !is_whole_within(pins, 3.0, MAX_PINS as f64) {
            return Err(DesignError::PinCountOutOfRange { pins });
        }
        Ok(Self { ratio, discs, pins })
    }
}

/// sin(pi / N) for every allowed number of pins.
struct SinHalfPitch([f64; MAX_PINS + 1]);
static SIN_HALF_PITCH: std::sync::LazyLock<SinHalfPitch> = std::sync::LazyLock::new(|| {
    SinHalfPitch(std::array::from_fn(|n| {
        (std::f64::consts::PI / n.max(1) as f64).sin()
    }))
});

/// The active-pin map and what goes with its inputs alone.
#[derive(Debug, Clone, Copy)]
pub struct Map {
    status: Status,
    /// Active contacts by the chosen criterion.
    pub active: ActiveCount,
    /// eta_OP by the chosen criterion.
    pub efficiency: f64,
    /// The factor on the compliance in Eq. (13): eta_OP, or one by statics.
    pub twist_factor: f64,
    /// eta_OP by `inside`.
    pub efficiency_inside: f64,
    /// eta_OP by `published-map`.
    pub efficiency_published_map: f64,
    /// Mean participation by statics.
    pub participation: f64,
    /// N_OP.
    pub pins: f64,
    /// N_OP p where statics feeds the twist, N_OP elsewhere.
    pub pins_in_twist: f64,
    /// i^2.
    pub ratio_squared: f64,
    /// Largest pin force per output torque (1/m): 4 / (n N R).
    pub force_per_torque: f64,
    /// One where the statics hold: at most two discs.
    pub statics_applicable: f64,
}
stage!(Map);

impl Map {
    const NONE: Self = Self {
        status: Status::Ok,
        active: ActiveCount {
            mean: f64::NAN,
            min: 0,
            max: 0,
        },
        efficiency: f64::NAN,
        twist_factor: f64::NAN,
        efficiency_inside: f64::NAN,
        efficiency_published_map: f64::NAN,
        participation: f64::NAN,
        pins: f64::NAN,
        pins_in_twist: f64::NAN,
        ratio_squared: f64::NAN,
        force_per_torque: f64::NAN,
        statics_applicable: f64::NAN,
    };
    /// The inputs this stage reads.
    pub const INPUTS: [Input; 7] = [
        Input::Ratio,
        Input::DiscCount,
        Input::Eccentricity,
        Input::OutputPinCount,
        Input::OutputPinCircleRadius,
        Input::HoleClocking,
        Input::Criterion,
    ];

    /// The arrangement of holes and pins, and the criterion.
    ///
    /// # Errors
    /// The first [`DesignError`] met.
    #[inline(always)]
    pub fn arrangement(inputs: &Inputs) -> Result<(PinMap, Criterion), DesignError> {
        let Counts { ratio, discs, pins } = Counts::of(inputs)?;
        let e = inputs.get(Input::Eccentricity);
        let circle = inputs.get(Input::OutputPinCircleRadius);
        let map = PinMap {
            ratio,
            discs: discs as u32,
            pins: pins as u32,
            delta: crossing_angle(e, circle)? * std::f64::consts::TAU.recip(),
            clocking: finite("hole_clocking", inputs.get(Input::HoleClocking))?,
        };
        let code = finite("criterion", inputs.get(Input::Criterion))?;
        let criterion = Criterion::ALL.get(code as usize);
        Ok((
            map,
            *criterion.ok_or(DesignError::NonFinite {
                parameter: "criterion",
            })?,
        ))
    }

    /// Checks only what [`Map::of`] checks.
    ///
    /// # Errors
    /// The first [`DesignError`] met.
    #[inline]
    pub fn check(inputs: &Inputs) -> Result<Self, DesignError> {
        Self::arrangement(inputs).map(|_| Self::NONE)
    }

    /// Computes. Figures of a criterion that is not the chosen one stay NaN unless
    /// `every_criterion`.
    ///
    /// # Errors
    /// See [`Map::arrangement`].
    #[inline(always)]
    pub fn of(inputs: &Inputs, every_criterion: bool) -> Result<Self, DesignError> {
        let (map, criterion) = Self::arrangement(inputs)?;
        let (discs, pins) = (f64::from(map.discs), f64::from(map.pins));
        let mut out = Self {
            pins,
            pins_in_twist: pins,
            ratio_squared: map.ratio * map.ratio,
            force_per_torque: 4.0 / (discs * pins * inputs.get(Input::OutputPinCircleRadius)),
            statics_applicable: f64::from(u8::from(map.discs <= 2)),
            ..Self::NONE
        };
        if every_criterion || criterion == Criterion::PublishedMap {
            out.active = map.published_map();
            out.efficiency_published_map = map.efficiency(out.active.mean);
            out.efficiency = out.efficiency_published_map;
        }
        if every_criterion || criterion == Criterion::Inside {
            let inside = map.inside();
            out.efficiency_inside = map.efficiency(inside.mean);
            if criterion == Criterion::Inside {
                out.active = inside;
                out.efficiency = out.efficiency_inside;
            }
        }
        if every_criterion || criterion == Criterion::Statics {
            out.participation = map.participation().mean;
            if criterion == Criterion::Statics {
                out.active = map.statics();
                out.efficiency = map.efficiency(out.active.mean);
                out.pins_in_twist = pins * out.participation;
            }
        }
        out.twist_factor = if criterion == Criterion::Statics {
            1.0
        } else {
            out.efficiency
        };
        Ok(out)
    }
}

/// The output shaft.
#[derive(Debug, Clone, Copy)]
pub struct Shaft {
    status: Status,
    /// C_OS^t (rad/(N m)); NaN for a drive that gives its stiffness instead of a shaft.
    pub compliance: f64,
}
stage!(Shaft);

impl Shaft {
    const NONE: Self = Self {
        status: Status::Ok,
        compliance: f64::NAN,
    };
    /// The scalar inputs this stage reads; it reads every segment's too.
    pub const INPUTS: [Input; 3] = [
        Input::YoungsModulus,
        Input::PoissonRatio,
        Input::KeywayCoefficient,
    ];

    /// Computes.
    ///
    /// # Errors
    /// See [`ShaftPlan::compliance`].
    #[inline(always)]
    pub fn of(inputs: &Inputs, plan: &ShaftPlan) -> Result<Self, DesignError> {
        let compliance = plan.compliance(inputs)?;
        let compliance = if plan.is_empty() {
            f64::NAN
        } else {
            compliance
        };
        Ok(Self {
            status: Status::Ok,
            compliance,
        })
    }
}

/// One output pin.
#[derive(Debug, Clone, Copy)]
pub struct PinBending {
    status: Status,
    /// C_OP (rad/(N m)).
    pub compliance: f64,
    /// Root stress per force (Pa/N).
    pub stress_per_force: f64,
}
stage!(PinBending);

impl PinBending {
    const NONE: Self = Self {
        status: Status::Ok,
        compliance: f64::NAN,
        stress_per_force: f64::NAN,
    };
    /// The inputs this stage reads.
    pub const INPUTS: [Input; 7] = [
        Input::YoungsModulus,
        Input::PoissonRatio,
        Input::OutputPinDiameter,
        Input::OutputPinBore,
        Input::OutputPinLength,
        Input::OutputPinCircleRadius,
        Input::OutputTorque,
    ];

    /// Computes at the rated output torque, which one pin carries in Eqs. (8)-(10).
    ///
    /// # Errors
    /// The first [`DesignError`] met.
    #[inline(always)]
    pub fn of(inputs: &Inputs) -> Result<Self, DesignError> {
        let pin = Pin {
            diameter: inputs.get(Input::OutputPinDiameter),
            bore: inputs.get(Input::OutputPinBore),
            length: inputs.get(Input::OutputPinLength),
        };
        pin.check()?;
        let torque = positive("output_torque", inputs.get(Input::OutputTorque))?;
        let flexibility = pin.flexibility(
            inputs.get(Input::YoungsModulus),
            inputs.get(Input::PoissonRatio),
        );
        let circle = inputs.get(Input::OutputPinCircleRadius);
        Ok(Self {
            status: Status::Ok,
            compliance: pin_compliance(flexibility, circle, torque),
            stress_per_force: pin.root_stress(1.0),
        })
    }
}

/// Ratings and what is measured rather than computed.
#[derive(Debug, Clone, Copy)]
pub struct Rating {
    status: Status,
    /// T_N = P / omega (N m).
    pub nominal_torque: f64,
    /// Rated output torque (N m).
    pub output_torque: f64,
    /// gamma (deg).
    pub free_play_deg: f64,
    /// Input inertia (kg m^2), or NaN.
    pub inertia: f64,
    /// Output compliance given as measured (rad/(N m)), or NaN.
    pub given_compliance: f64,
}
stage!(Rating);

impl Rating {
    const NONE: Self = Self {
        status: Status::Ok,
        nominal_torque: f64::NAN,
        output_torque: f64::NAN,
        free_play_deg: f64::NAN,
        inertia: f64::NAN,
        given_compliance: f64::NAN,
    };
    /// The inputs this stage reads.
    pub const INPUTS: [Input; 6] = [
        Input::InputPower,
        Input::InputSpeed,
        Input::OutputTorque,
        Input::FreePlay,
        Input::InputInertia,
        Input::OutputStiffness,
    ];

    /// Computes. `needs_stiffness`: there is no shaft to compute it from.
    ///
    /// # Errors
    /// The first [`DesignError`] met.
    #[inline(always)]
    pub fn of(inputs: &Inputs, needs_stiffness: bool) -> Result<Self, DesignError> {
        let power = positive("input_power", inputs.get(Input::InputPower))?;
        let speed = positive("input_speed", inputs.get(Input::InputSpeed))?;
        let inertia = inputs.get(Input::InputInertia);
        let stiffness = inputs.get(Input::OutputStiffness);
        if !inertia.is_nan() {
            positive("input_inertia", inertia)?;
        }
        if needs_stiffness || !stiffness.is_nan() {
            positive("output_stiffness", stiffness)?;
        }
        Ok(Self {
            status: Status::Ok,
            nominal_torque: power / speed,
            output_torque: positive("output_torque", inputs.get(Input::OutputTorque))?,
            free_play_deg: non_negative("free_play", inputs.get(Input::FreePlay))?,
            inertia,
            given_compliance: 1.0 / stiffness,
        })
    }
}
