//! The drive that studies in tests vary.

use cyclosweep::model::active_pins::Criterion;
use cyclosweep::model::design::{Design, ShaftSegment};

/// Loads at which twists are computed.
pub const LOADS: [f64; 2] = [1.0, 4.5];

/// Its shaft.
pub const SHAFT: [ShaftSegment; 3] = [
    ShaftSegment::Keyway {
        diameter_mm: 50.0,
        length_mm: 100.0,
        keyway_depth_mm: 5.5,
    },
    ShaftSegment::Cylinder {
        diameter_mm: 55.0,
        length_mm: 60.0,
    },
    ShaftSegment::Frustum {
        diameter_mm: 60.0,
        end_diameter_mm: 90.0,
        length_mm: 15.0,
    },
];

/// A drive that can be built.
pub fn base() -> Design {
    Design {
        ratio: 87.0,
        disc_count: 2.0,
        eccentricity_mm: 0.62,
        ring_pin_circle_radius_mm: 75.0,
        hole_clocking_deg: -1.2,
        output_pin_count: 8.0,
        output_pin_circle_radius_mm: 45.0,
        output_pin_diameter_mm: 16.0,
        output_pin_bore_mm: 0.0,
        output_pin_length_mm: 40.0,
        bush_wall_mm: 2.0,
        disc_outer_radius_mm: 70.0,
        disc_bore_radius_mm: 25.0,
        youngs_modulus_gpa: 206.0,
        poisson_ratio: 0.3,
        keyway_coefficient: 10.0,
        input_power_kw: 1.14,
        input_speed_rpm: 1500.0,
        output_torque_nm: 585.0,
        free_play_deg: 28.0,
        input_inertia_kg_m2: Some(0.002),
        output_stiffness_nm_per_arcmin: None,
        criterion: Criterion::PublishedMap,
        shaft: SHAFT.to_vec(),
    }
}
