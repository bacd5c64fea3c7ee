//! The bench study in Rust: the one of `benches/study.py`, plus its full-grid form.

use cyclosweep::columns::Study;
use cyclosweep::inputs::{Input, SCALARS, SEGMENT_FIELDS, factor, segment_input};
use cyclosweep::shaft::SegmentKind;
use cyclosweep::space::{Axis, Layout, Space, Values};

/// Loads (nominal torques) at which twists are computed.
const LOADS: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 4.5];

/// The drive of `benches/drive.toml`, in the user's units.
const DRIVE: [(Input, f64); 22] = [
    (Input::Ratio, 87.0),
    (Input::DiscCount, 2.0),
    (Input::Eccentricity, 0.62),
    (Input::RingPinCircleRadius, 75.0),
    (Input::HoleClocking, -1.2),
    (Input::OutputPinCount, 8.0),
    (Input::OutputPinCircleRadius, 45.0),
    (Input::OutputPinDiameter, 16.0),
    (Input::OutputPinBore, 0.0),
    (Input::OutputPinLength, 40.0),
    (Input::BushWall, 2.0),
    (Input::DiscOuterRadius, 70.0),
    (Input::DiscBoreRadius, 25.0),
    (Input::YoungsModulus, 206.0),
    (Input::PoissonRatio, 0.3),
    (Input::KeywayCoefficient, 10.0),
    (Input::InputPower, 1.14),
    (Input::InputSpeed, 1500.0),
    (Input::OutputTorque, 585.0),
    (Input::FreePlay, 28.0),
    (Input::InputInertia, 0.002),
    (Input::Criterion, 0.0),
];
/// Its shaft: kind, then diameter, end diameter, length, keyway depth (mm).
const SHAFT: [(SegmentKind, [f64; 4]); 5] = [
    (SegmentKind::Keyway, [50.0, f64::NAN, 60.0, 5.5]),
    (SegmentKind::Cylinder, [50.0, f64::NAN, 30.0, f64::NAN]),
    (SegmentKind::Cylinder, [55.0, f64::NAN, 30.0, f64::NAN]),
    (SegmentKind::Cylinder, [60.0, f64::NAN, 20.0, f64::NAN]),
    (SegmentKind::Frustum, [62.0, 84.0, 15.0, f64::NAN]),
];

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
    let mut base = vec![f64::NAN; SCALARS + SEGMENT_FIELDS.len() * SHAFT.len()];
    for (input, value) in DRIVE {
        base[input as usize] = value * factor(input as usize);
    }
    for (segment, (_, fields)) in SHAFT.iter().enumerate() {
        for (field, value) in fields.iter().enumerate() {
            let input = segment_input(segment, field);
            base[input] = value * factor(input);
        }
    }
    let kinds = SHAFT.iter().map(|(kind, _)| *kind).collect();
    Study::new(space, base, kinds, LOADS.to_vec(), Vec::new()).expect("a study that can be")
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
