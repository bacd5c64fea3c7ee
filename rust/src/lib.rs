//! Compliance of single-stage cycloidal drives.
#[cfg(feature = "python")]
mod py;
