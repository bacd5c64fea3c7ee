//! Operators without friction limits: play, creep, drag, and a datum that remembers earlier runs.

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

/// Resistance to motion that grows with a power of the rate.
#[derive(Clone, Copy, Debug)]
pub struct Dashpot {
    /// Drag over rate at the reference rate, as a time.
    pub lag: f64,
    /// Power of the rate, above zero and up to one.
    pub power: f64,
    /// Rate at which the drag is `lag` times the rate.
    pub reference_rate: f64,
}

impl Dashpot {
    /// Way `w` in which the balance `w + factor |w|^power = |gap|` holds, with the sign of the gap.
    fn way(self, gap: f64, lapse: f64) -> f64 {
        // Without a lapse nothing can have moved.
        let lapse = lapse.max(1e-12 * self.lag.abs().max(1e-300));
        if self.power == 1.0 {
            return gap / (1.0 + self.lag / lapse);
        }
        let drag_at_reference = self.lag * self.reference_rate;
        let factor = drag_at_reference / (self.reference_rate * lapse).powf(self.power);
        let (size, inverse) = (gap.abs(), 1.0 / self.power);
        if size == 0.0 || factor == 0.0 {
            return gap;
        }
        // In y = |w|^power the balance is convex and rises: from above Newton's steps only descend.
        let mut y = (size / factor).min(size.powf(self.power));
        for _ in 0..60 {
            let way = y.powf(inverse);
            let step = (way + factor * y - size) / (inverse * way / y + factor);
            if step <= 1e-14 * y {
                break;
            }
            y -= step;
        }
        gap.signum() * y.powf(inverse)
    }
}

/// Input that a dashpot in parallel lets through: the torque balance `u = x + drag(dx/dt)`, solved
/// sample by sample with the rate taken backwards.
///
/// `lapse[i]` is the time that led to sample `i`; `restart[i]` marks a sample reached from rest.
///
/// # Errors
/// [`HistoryError`] when columns differ in length.
pub fn dragged(
    input: &[f64],
    lapse: &[f64],
    restart: &[bool],
    dashpot: Dashpot,
    out: &mut [f64],
) -> Result<(), HistoryError> {
    same_length(input.len(), &[lapse.len(), restart.len(), out.len()])?;
    let mut state = 0.0;
    for i in 0..input.len() {
        if i == 0 || restart[i] {
            state = 0.0;
        }
        state += dashpot.way(input[i] - state, lapse[i]);
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
