//! Compliance of single-stage cycloidal drives.

pub mod active_pins;
pub mod columns;
pub mod compliance;
pub mod error;
pub mod hypotrochoid;
pub mod hysteresis;
pub mod inputs;
mod joe_kuo;
pub mod outputs;
pub mod pin;
pub mod sampling;
pub mod shaft;
pub mod space;
pub mod stages;

#[cfg(feature = "python")]
mod py;
