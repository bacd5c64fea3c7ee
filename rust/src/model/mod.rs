//! The published model: one design, its formulas and the reasons to refuse it.

pub mod active_pins;
mod arrangement;
pub(crate) mod checks;
pub mod compliance;
pub mod design;
pub(crate) mod elementary;
pub mod error;
pub mod hypotrochoid;
pub mod hysteresis;
pub mod inputs;
pub mod pin;
pub mod pin_force;
mod published_map;
pub(crate) mod rounding;
pub mod shaft;
pub mod whitening;

pub(crate) use arrangement::{
    Arrangement, Counts, MAX_PINS, first_hole, fold, reduced_clocking, statics_apply,
};

/// A number in [0, 1) for tests: SplitMix64 of a stream and an index.
#[cfg(test)]
pub(crate) fn random(stream: u64, index: u64) -> f64 {
    let mut x = (stream << 40)
        .wrapping_add(index)
        .wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
