//! The bench study in Rust: the one of `benches/study.py`, plus its full-grid form.

use cyclosweep::Study;
use cyclosweep::model::active_pins::Criterion;
use cyclosweep::model::design::{Design, ShaftSegment};
use cyclosweep::model::inputs::{Input, segment_input};
use cyclosweep::sampling::{Axis, Layout, Space, Values};

/// Loads (nominal torques) at which twists are computed.
const LOADS: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 4.5];

/// The drive of `benches/drive.toml`.
fn drive() -> Design {
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
        shaft: vec![
            ShaftSegment::Keyway {
                diameter_mm: 50.0,
                length_mm: 60.0,
                keyway_depth_mm: 5.5,
            },
            cylinder(50.0, 30.0),
            cylinder(55.0, 30.0),
            cylinder(60.0, 20.0),
            ShaftSegment::Frustum {
                diameter_mm: 62.0,
                end_diameter_mm: 84.0,
                length_mm: 15.0,
            },
        ],
    }
}

const fn cylinder(diameter_mm: f64, length_mm: f64) -> ShaftSegment {
    ShaftSegment::Cylinder {
        diameter_mm,
        length_mm,
    }
}

/// The eight axes: input, lowest and highest value, values in the full grid.
fn ranges() -> [(usize, f64, f64, u64); 8] {
    [
        (Input::Eccentricity as usize, 0.3, 0.8, 8),
        (Input::OutputPinCount as usize, 6.0, 12.0, 7),
        (Input::OutputPinCircleRadius as usize, 42.0, 50.0, 8),
        (Input::OutputPinDiameter as usize, 10.0, 17.0, 8),
        (Input::OutputPinLength as usize, 25.0, 50.0, 8),
        (Input::HoleClocking as usize, -2.0, 2.0, 5),
        (segment_input(0, 2), 50.0, 80.0, 10),
        (segment_input(2, 0), 51.0, 59.0, 10),
    ]
}

/// The study over a space of its axes.
fn study(space: Space) -> Study {
    Study::new(space, &drive(), LOADS.to_vec(), Vec::new()).expect("a study that can be")
}

/// Scrambled Sobol points over eight axes.
pub fn sobol() -> Study {
    let axes = ranges()
        .into_iter()
        .map(|(input, low, high, _)| Axis {
            input,
            values: if input == Input::OutputPinCount as usize {
                Values::Whole { low, high }
            } else {
                Values::Interval { low, high }
            },
        })
        .collect();
    study(Space::new(axes, Layout::Sobol, 1 << 40, 1).expect("a valid space"))
}

/// Every combination of a few values on each of the eight axes.
pub fn grid() -> Study {
    let axes = ranges()
        .into_iter()
        .map(|(input, from, to, steps)| Axis {
            input,
            values: Values::Linspace { from, to, steps },
        })
        .collect();
    study(Space::new(axes, Layout::Grid, 0, 0).expect("a valid space"))
}
