//! The variants of a study: which inputs vary, and each variant's values from its index alone.

mod joe_kuo;
mod quantile;
mod sequences;
pub mod space;
mod values;

pub use space::{Axis, Layout, Rows, Space, SpaceError};
pub use values::Values;
