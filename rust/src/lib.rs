//! Compliance of single-stage cycloidal drives.
pub mod hysteresis;
#[cfg(feature = "python")]
mod py;
