//! Operators without friction limits: play, creep, and a datum that remembers earlier runs.

use crate::model::hysteresis::checks::{
    HistoryError, not_negative, numbers, numbers_at_starts, same_length, within,
};

/// Play operator: the output follows the input once the gap of half width `half_width` is taken up.
///
/// # Errors
/// [`HistoryError`] when columns differ in length or hold what is not a number, or the half width
/// is negative.
pub fn play(
    input: &[f64],
    half_width: f64,
    restart: &[bool],
    start: &[f64],
    out: &mut [f64],
) -> Result<(), HistoryError> {
    same_length(input.len(), &[restart.len(), start.len(), out.len()])?;
    numbers("signal", input)?;
    numbers_at_starts("start", start, restart)?;
    not_negative("half_width", &[half_width])?;
    let mut state = 0.0;
    for i in 0..input.len() {
        if i == 0 || restart[i] {
            state = start[i];
        }
        state = within(state, input[i] - half_width, input[i] + half_width);
        out[i] = state;
    }
    Ok(())
}

/// Kelvin-Voigt state: follows the input with a time constant, exactly for a piecewise linear input.
///
/// # Errors
/// [`HistoryError`] when columns differ in length.
pub fn creep_state(
    input: &[f64],
    time: &[f64],
    restart: &[bool],
    time_constant: f64,
    out: &mut [f64],
) -> Result<(), HistoryError> {
    same_length(input.len(), &[time.len(), restart.len(), out.len()])?;
    let mut state = 0.0;
    for i in 0..input.len() {
        if i == 0 || restart[i] {
            // Fresh: the load was put on just before the first sample.
            state = 0.0;
        } else {
            let step = ((time[i] - time[i - 1]) / time_constant).max(0.0);
            let decay = (-step).exp();
            let slope = if step > 1e-12 {
                (input[i] - input[i - 1]) / step
            } else {
                0.0
            };
            // x' = (u - x)/tau with u linear over the step.
            state = input[i] - slope + (state - input[i - 1] + slope) * decay;
        }
        out[i] = state;
    }
    Ok(())
}

/// Datum that remembers earlier runs: after each run it moves by that run's push, and forgets slowly.
///
/// `push[r]` is what run `r` does to the datum, `memory` the part of the shift kept from run to run.
pub fn remembered_datum(push: &[f64], memory: f64, out: &mut [f64]) {
    let mut shift = 0.0;
    for (value, &p) in out.iter_mut().zip(push) {
        *value = shift;
        shift = memory * shift + p;
    }
}
