//! Drag: what a dashpot in parallel lets through of a torque.

use crate::model::hysteresis::checks::{HistoryError, not_negative, numbers, same_length};

/// Share of a step after which the first stage of the integration stands, `1 - sqrt(1/2)`.
const STAGE: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Fewest steps of the integration from one sample to the next,
const FEWEST_STEPS: f64 = 2.0;

/// and most: of a lag of a hundredth of that time next to nothing of a change is then left.
const MOST_STEPS: f64 = 4.0;

/// Share of the largest possible way from which Newton's steps begin at the least,
const LEAST_NEAR: f64 = 0.05;

/// their number at most,
const MOST_ITERATIONS: usize = 60;

/// and a step, in shares of the power of the way, after which the next one is about its square.
const CLOSE: f64 = 1e-5;

/// Resistance to motion that grows with a power of the rate.
#[derive(Clone, Copy, Debug)]
pub struct Dashpot {
    /// Drag over rate at the reference rate, as a time.
    pub lag: f64,
    /// Power of the rate, above zero and up to one.
    pub power: f64,
    /// Rate at which the drag is `lag` times the rate.
    pub reference_rate: f64,
    /// Whether the rate is taken from sample to sample, and not of the motion between them.
    pub by_sample: bool,
}

impl Dashpot {
    /// State after a time in which the input grew evenly, with drag in proportion to the rate.
    ///
    /// This is exact, but for one implicit step where the rate is taken from sample to sample.
    fn follow_exactly(self, state: f64, from: f64, to: f64, lapse: f64) -> f64 {
        if self.by_sample {
            return state + (to - state) / (1.0 + self.lag / lapse);
        }
        let spans = lapse / self.lag.max(1e-300);
        let (passed, ramp) = (-(-spans).exp_m1(), (to - from) / spans);
        let gap = from - state;
        to - gap * (1.0 - passed) - ramp * passed
    }

    /// The same with drag that grows with a power of the rate, in a few steps.
    ///
    /// They are those of a singly diagonally implicit Runge-Kutta method of second order, which is
    /// L-stable and exact for an even motion (Alexander 1977, SIAM J. Numer. Anal. 14: 1006).
    /// `near` is a way to the power, near which each stage looks for its own.
    fn follow(self, state: f64, from: f64, to: f64, lapse: f64, near: &mut f64) -> f64 {
        if self.by_sample {
            return state + self.way(to - state, self.factor(lapse), near);
        }
        let count = (2.0 * lapse / self.lag.max(1e-300)).ceil();
        let count = count.clamp(FEWEST_STEPS, MOST_STEPS);
        let (step, ramp) = (lapse / count, (to - from) / count);
        let factor = self.factor(STAGE * step);
        let (mut state, mut begun) = (state, from);
        for _ in 0..count as usize {
            let way = self.way(begun + STAGE * ramp - state, factor, near);
            state += (1.0 / STAGE - 1.0) * way;
            begun += ramp;
            state += self.way(begun - state, factor, near);
        }
        state
    }

    /// Drag of a way of one that takes a time.
    fn factor(self, lapse: f64) -> f64 {
        self.lag * self.reference_rate / (self.reference_rate * lapse).powf(self.power)
    }

    /// Way `w` in which the balance `w + factor |w|^power = |gap|` holds, with the sign of the gap.
    fn way(self, gap: f64, factor: f64, near: &mut f64) -> f64 {
        let (size, inverse) = (gap.abs(), 1.0 / self.power);
        if size == 0.0 || factor == 0.0 {
            return gap;
        }
        // In y = |w|^power the balance is convex and rises: once above, Newton's steps descend.
        let highest = size / factor;
        let mut y = near.max(LEAST_NEAR * highest).min(highest);
        for _ in 0..MOST_ITERATIONS {
            let way = y.powf(inverse);
            let step = (way + factor * y - size) / (inverse * way / y + factor);
            y -= step;
            if step.abs() <= CLOSE * y {
                break;
            }
        }
        *near = y;
        // As the balance has it, of which the drag is the larger part where this is inexact.
        gap.signum() * (size - factor * y).max(0.0)
    }
}

/// Input that a dashpot in parallel lets through: the torque balance `u = x + drag(dx/dt)`, with an
/// input `u` that grows evenly from sample to sample.
///
/// `lapse[i]` is the time that led to sample `i`; `restart[i]` marks a sample reached from rest.
///
/// # Errors
/// [`HistoryError`] when columns differ in length, the signal holds what is not a number, or the lag
/// is negative.
pub fn dragged(
    input: &[f64],
    lapse: &[f64],
    restart: &[bool],
    dashpot: Dashpot,
    out: &mut [f64],
) -> Result<(), HistoryError> {
    same_length(input.len(), &[lapse.len(), restart.len(), out.len()])?;
    numbers("signal", input)?;
    not_negative("lag", &[dashpot.lag])?;
    let (mut state, mut before, mut near) = (0.0, 0.0, 0.0);
    for i in 0..input.len() {
        if i == 0 || restart[i] {
            (state, before) = (0.0, 0.0);
        }
        // Without a lapse nothing can have moved.
        let passed = lapse[i].max(1e-12 * dashpot.lag.abs().max(1e-300));
        state = if dashpot.power == 1.0 {
            dashpot.follow_exactly(state, before, input[i], passed)
        } else {
            dashpot.follow(state, before, input[i], passed, &mut near)
        };
        before = input[i];
        out[i] = state;
    }
    Ok(())
}
