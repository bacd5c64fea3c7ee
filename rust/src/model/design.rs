//! One design: every input by name, in the units of a drive file.

use crate::model::active_pins::Criterion;
use crate::model::inputs::{Input, SCALARS, SEGMENT_FIELDS};
use crate::model::shaft::SegmentKind;

/// A segment of the output shaft, counted from its free end to the flange.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShaftSegment {
    /// Cylinder with a keyway, Eq. (5).
    Keyway {
        /// Diameter (mm).
        diameter_mm: f64,
        /// Length (mm).
        length_mm: f64,
        /// Depth of the keyway (mm).
        keyway_depth_mm: f64,
    },
    /// Plain cylinder.
    Cylinder {
        /// Diameter (mm).
        diameter_mm: f64,
        /// Length (mm).
        length_mm: f64,
    },
    /// Frustum of a cone, Eq. (7).
    Frustum {
        /// Diameter at the free end (mm).
        diameter_mm: f64,
        /// Diameter at the flange end (mm).
        end_diameter_mm: f64,
        /// Length (mm).
        length_mm: f64,
    },
}

impl ShaftSegment {
    /// What kind of segment it is.
    #[must_use]
    pub const fn kind(&self) -> SegmentKind {
        match self {
            ShaftSegment::Keyway { .. } => SegmentKind::Keyway,
            ShaftSegment::Cylinder { .. } => SegmentKind::Cylinder,
            ShaftSegment::Frustum { .. } => SegmentKind::Frustum,
        }
    }

    /// Its fields in the order of [`SEGMENT_FIELDS`], NaN for those it does not have.
    #[must_use]
    pub const fn fields(&self) -> [f64; SEGMENT_FIELDS.len()] {
        match *self {
            ShaftSegment::Keyway {
                diameter_mm,
                length_mm,
                keyway_depth_mm,
            } => [diameter_mm, f64::NAN, length_mm, keyway_depth_mm],
            ShaftSegment::Cylinder {
                diameter_mm,
                length_mm,
            } => [diameter_mm, f64::NAN, length_mm, f64::NAN],
            ShaftSegment::Frustum {
                diameter_mm,
                end_diameter_mm,
                length_mm,
            } => [diameter_mm, end_diameter_mm, length_mm, f64::NAN],
        }
    }

    /// The segment of a kind with these fields, of which it takes those it has.
    #[must_use]
    pub const fn of(kind: SegmentKind, fields: [f64; SEGMENT_FIELDS.len()]) -> Self {
        let [diameter_mm, end_diameter_mm, length_mm, keyway_depth_mm] = fields;
        match kind {
            SegmentKind::Keyway => ShaftSegment::Keyway {
                diameter_mm,
                length_mm,
                keyway_depth_mm,
            },
            SegmentKind::Cylinder => ShaftSegment::Cylinder {
                diameter_mm,
                length_mm,
            },
            SegmentKind::Frustum => ShaftSegment::Frustum {
                diameter_mm,
                end_diameter_mm,
                length_mm,
            },
        }
    }
}

/// A single-stage cycloidal drive. Any numbers may stand here: whether the drive can be built is
/// asked by [`crate::check`] and by the status of a study.
///
/// Counts are real numbers, because a study may vary them like every other input.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Reduction ratio i, a whole number from 3 to 300.
    pub ratio: f64,
    /// Cycloid discs, equally phased, 1 to 4.
    pub disc_count: f64,
    /// Eccentricity e (mm).
    pub eccentricity_mm: f64,
    /// Radius of the ring pins' circle (mm).
    pub ring_pin_circle_radius_mm: f64,
    /// Clocking of the hole pattern from the position symmetric about ring pin 0 (deg).
    pub hole_clocking_deg: f64,
    /// Output pins N_OP, 3 to 64.
    pub output_pin_count: f64,
    /// Radius R_OP of the output pins' circle (mm).
    pub output_pin_circle_radius_mm: f64,
    /// Outer diameter of an output pin (mm).
    pub output_pin_diameter_mm: f64,
    /// Bore of an output pin (mm), zero for a solid one.
    pub output_pin_bore_mm: f64,
    /// Free length of an output pin (mm).
    pub output_pin_length_mm: f64,
    /// Wall of the bush on an output pin (mm).
    pub bush_wall_mm: f64,
    /// Root radius of the disc (mm).
    pub disc_outer_radius_mm: f64,
    /// Radius of the disc's bore (mm).
    pub disc_bore_radius_mm: f64,
    /// Young's modulus of shaft and pins (GPa).
    pub youngs_modulus_gpa: f64,
    /// Poisson's ratio of shaft and pins.
    pub poisson_ratio: f64,
    /// Coefficient k of Eq. (5), 10 as printed.
    pub keyway_coefficient: f64,
    /// Rated input power (kW).
    pub input_power_kw: f64,
    /// Rated input speed (rpm).
    pub input_speed_rpm: f64,
    /// Rated output torque T_O (N m).
    pub output_torque_nm: f64,
    /// Free play gamma at the input, each side of the middle (deg).
    pub free_play_deg: f64,
    /// Inertia at the input (kg m^2), where it is known.
    pub input_inertia_kg_m2: Option<f64>,
    /// Torsional stiffness at the output (N m/arcmin), where it is measured instead of computed.
    pub output_stiffness_nm_per_arcmin: Option<f64>,
    /// Rule by which a pin counts as active in the twist.
    pub criterion: Criterion,
    /// Output shaft from its free end to the flange; empty where the stiffness is given.
    pub shaft: Vec<ShaftSegment>,
}

impl Design {
    /// Value of the input at this position among all inputs, in its own unit; NaN where the design
    /// has none.
    #[must_use]
    pub fn value(&self, input: usize) -> f64 {
        if let Some(input) = Input::ALL.get(input) {
            return self.scalar(*input);
        }
        let place = input - SCALARS;
        let segment = self.shaft.get(place / SEGMENT_FIELDS.len());
        segment.map_or(f64::NAN, |segment| {
            segment.fields()[place % SEGMENT_FIELDS.len()]
        })
    }

    /// Value of a scalar input, in its own unit; NaN where it is left out.
    #[must_use]
    pub fn scalar(&self, input: Input) -> f64 {
        match input {
            Input::Ratio => self.ratio,
            Input::DiscCount => self.disc_count,
            Input::Eccentricity => self.eccentricity_mm,
            Input::RingPinCircleRadius => self.ring_pin_circle_radius_mm,
            Input::HoleClocking => self.hole_clocking_deg,
            Input::OutputPinCount => self.output_pin_count,
            Input::OutputPinCircleRadius => self.output_pin_circle_radius_mm,
            Input::OutputPinDiameter => self.output_pin_diameter_mm,
            Input::OutputPinBore => self.output_pin_bore_mm,
            Input::OutputPinLength => self.output_pin_length_mm,
            Input::BushWall => self.bush_wall_mm,
            Input::DiscOuterRadius => self.disc_outer_radius_mm,
            Input::DiscBoreRadius => self.disc_bore_radius_mm,
            Input::YoungsModulus => self.youngs_modulus_gpa,
            Input::PoissonRatio => self.poisson_ratio,
            Input::KeywayCoefficient => self.keyway_coefficient,
            Input::InputPower => self.input_power_kw,
            Input::InputSpeed => self.input_speed_rpm,
            Input::OutputTorque => self.output_torque_nm,
            Input::FreePlay => self.free_play_deg,
            Input::InputInertia => self.input_inertia_kg_m2.unwrap_or(f64::NAN),
            Input::OutputStiffness => self.output_stiffness_nm_per_arcmin.unwrap_or(f64::NAN),
            Input::Criterion => f64::from(self.criterion as u8),
        }
    }

    /// How many inputs it has: the scalar ones and four a segment.
    #[must_use]
    pub const fn input_count(&self) -> usize {
        SCALARS + SEGMENT_FIELDS.len() * self.shaft.len()
    }

    /// The kinds of the shaft's segments.
    #[must_use]
    pub fn segment_kinds(&self) -> Vec<SegmentKind> {
        self.shaft.iter().map(ShaftSegment::kind).collect()
    }

    /// A design with these values of the scalar inputs, in their own units and NaN where left out.
    #[cfg_attr(
        not(feature = "python"),
        expect(dead_code, reason = "the bindings read names")
    )]
    pub(crate) fn of_values(
        value: impl Fn(Input) -> f64,
        criterion: Criterion,
        shaft: Vec<ShaftSegment>,
    ) -> Self {
        let given = |input| Some(value(input)).filter(|value| !value.is_nan());
        Self {
            ratio: value(Input::Ratio),
            disc_count: value(Input::DiscCount),
            eccentricity_mm: value(Input::Eccentricity),
            ring_pin_circle_radius_mm: value(Input::RingPinCircleRadius),
            hole_clocking_deg: value(Input::HoleClocking),
            output_pin_count: value(Input::OutputPinCount),
            output_pin_circle_radius_mm: value(Input::OutputPinCircleRadius),
            output_pin_diameter_mm: value(Input::OutputPinDiameter),
            output_pin_bore_mm: value(Input::OutputPinBore),
            output_pin_length_mm: value(Input::OutputPinLength),
            bush_wall_mm: value(Input::BushWall),
            disc_outer_radius_mm: value(Input::DiscOuterRadius),
            disc_bore_radius_mm: value(Input::DiscBoreRadius),
            youngs_modulus_gpa: value(Input::YoungsModulus),
            poisson_ratio: value(Input::PoissonRatio),
            keyway_coefficient: value(Input::KeywayCoefficient),
            input_power_kw: value(Input::InputPower),
            input_speed_rpm: value(Input::InputSpeed),
            output_torque_nm: value(Input::OutputTorque),
            free_play_deg: value(Input::FreePlay),
            input_inertia_kg_m2: given(Input::InputInertia),
            output_stiffness_nm_per_arcmin: given(Input::OutputStiffness),
            criterion,
            shaft,
        }
    }
}
