//! Operators on a load history: slip elements, play, creep, drag, and a datum that remembers.

mod checks;
mod dashpot;
mod elements;
mod exponential;
mod operators;
mod slip;
mod spring;
#[cfg(test)]
mod tests;

pub use checks::HistoryError;
pub use dashpot::{Dashpot, dragged};
pub use elements::SlipElements;
pub use operators::{creep_state, play, remembered_datum};
pub use slip::{slip_state, solve_slip};
pub use spring::Spring;
