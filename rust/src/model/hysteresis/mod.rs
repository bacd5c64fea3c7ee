//! Operators on a load history: slip elements, play, creep, drag, and a datum that remembers.

mod checks;
mod elements;
mod exponential;
mod operators;
mod slip;
mod spring;
#[cfg(test)]
mod tests;

pub use checks::HistoryError;
pub use elements::SlipElements;
pub use operators::{Dashpot, creep_state, dragged, play, remembered_datum};
pub use slip::{slip_state, solve_slip};
pub use spring::Spring;
