//! Evaluation of many variants: stages computed once where they can be, in blocks on all cores.

mod blocks;
mod cache;
mod columns;
mod evaluate;
pub(crate) mod lanes;
mod map_stage;
mod outputs;
mod packed;
mod shaft_plan;
mod stages;
mod study;
mod train;

pub use columns::{Source, Target};
pub use evaluate::Columns;
pub use outputs::{Kind, Output};
pub use study::{Limit, Limited, Study, StudyError, check};
