//! The drive that studies in tests vary.

use cyclosweep::inputs::{SCALARS, SEGMENT_FIELDS, factor};
use cyclosweep::shaft::SegmentKind;

/// Its shaft.
pub const KINDS: [SegmentKind; 3] = [
    SegmentKind::Keyway,
    SegmentKind::Cylinder,
    SegmentKind::Frustum,
];
/// Loads at which twists are computed.
pub const LOADS: [f64; 2] = [1.0, 4.5];

/// A drive that can be built, in the user's units.
pub fn base() -> Vec<f64> {
    let mut base = vec![
        87.0,
        2.0,
        0.62,
        75.0,
        -1.2,
        8.0,
        45.0,
        16.0,
        0.0,
        40.0,
        2.0,
        70.0,
        25.0,
        206.0,
        0.3,
        10.0,
        1.14,
        1500.0,
        585.0,
        28.0,
        0.002,
        f64::NAN,
        0.0,
    ];
    assert_eq!(base.len(), SCALARS);
    base.extend([50.0, f64::NAN, 100.0, 5.5]);
    base.extend([55.0, f64::NAN, 60.0, f64::NAN]);
    base.extend([60.0, 90.0, 15.0, f64::NAN]);
    assert_eq!(base.len(), SCALARS + KINDS.len() * SEGMENT_FIELDS.len());
    base
}

/// The same in the core's units.
pub fn core_units(base: &[f64]) -> Vec<f64> {
    base.iter()
        .enumerate()
        .map(|(k, value)| value * factor(k))
        .collect()
}
