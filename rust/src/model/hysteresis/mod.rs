//! Operators on a load history: slip elements, play, creep, drag, and a datum that remembers.

mod checks;
mod operators;
mod slip;
#[cfg(test)]
mod tests;

pub use checks::HistoryError;
pub use operators::{creep_state, dragged, play, remembered_datum};
pub use slip::{SlipElements, Spring, slip_state, solve_slip};
