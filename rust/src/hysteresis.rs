//! History operators: slip elements solved in the angle, play, creep states, remembered datum.
//!
//! A locked-output torsion test is quasi-static, so at every sample the applied torque balances the
//! elastic torque of the drive and the friction in its contacts:
//!
//! ```text
//! T_i = T_e(theta_i - offset_i) + sum_j w_j (Y + mu |T_e|) clip((theta_i - z_j)/delta_j, -1, 1)
//! ```
//!
//! with `T_e` a spring behind a dead zone, linear or given point by point, and `z_j` the anchor of slip element `j`
//! (Maxwell-slip or generalised Prandtl-Ishlinskii model, see Al-Bender, Lampaert and Swevers,
//! IEEE Trans. Autom. Control 50(11), 2005, doi 10.1109/TAC.2005.858676). The equation is monotone in
//! the angle, so it has one solution a sample, found by a safeguarded Newton step.

use thiserror::Error;

/// Why a history cannot be evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum HistoryError {
    /// Two columns differ in length.
    #[error("arrays differ in length: {expected} and {found}")]
    Length {
        /// Length of the first column.
        expected: usize,
        /// Length of the other.
        found: usize,
    },
    /// A value is not a number.
    #[error("{what} is not a number at place {place}")]
    NotANumber {
        /// The column or parameter.
        what: &'static str,
        /// Its place in the column, from 0.
        place: usize,
    },
    /// A width or distance is negative.
    #[error("{what} must not be negative, found {value}")]
    Negative {
        /// The column or parameter.
        what: &'static str,
        /// The value found.
        value: f64,
    },
}

/// Requires equal lengths.
fn same_length(expected: usize, found: &[usize]) -> Result<(), HistoryError> {
    match found.iter().find(|n| **n != expected) {
        Some(found) => Err(HistoryError::Length {
            expected,
            found: *found,
        }),
        None => Ok(()),
    }
}

/// Requires numbers.
fn numbers(what: &'static str, values: &[f64]) -> Result<(), HistoryError> {
    if values.iter().all(|value| !value.is_nan()) {
        return Ok(());
    }
    let place = values.iter().position(|v| v.is_nan()).unwrap_or_default();
    Err(HistoryError::NotANumber { what, place })
}

/// Requires numbers where a history starts afresh; elsewhere a start is not read.
fn numbers_at_starts(
    what: &'static str,
    values: &[f64],
    restart: &[bool],
) -> Result<(), HistoryError> {
    let is_read = |place: usize| place == 0 || restart[place];
    match (0..values.len()).find(|place| is_read(*place) && values[*place].is_nan()) {
        Some(place) => Err(HistoryError::NotANumber { what, place }),
        None => Ok(()),
    }
}

/// Requires numbers not below zero.
fn not_negative(what: &'static str, values: &[f64]) -> Result<(), HistoryError> {
    numbers(what, values)?;
    match values.iter().find(|value| **value < 0.0) {
        Some(value) => Err(HistoryError::Negative {
            what,
            value: *value,
        }),
        None => Ok(()),
    }
}

/// `value`, or the end of the range beyond which it lies. Unlike `f64::clamp` it never panics.
#[inline]
fn within(value: f64, low: f64, high: f64) -> f64 {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

/// Friction of the contacts: slip elements in parallel that share one limit.
#[derive(Debug, Clone)]
pub struct SlipElements<'a> {
    /// Presliding distance of each element, in the unit of the angle, positive.
    pub slip_angle: &'a [f64],
    /// Share of the friction limit that each element carries; the shares normally add up to one.
    pub share: &'a [f64],
    /// Friction limit without load, in the unit of the torque.
    pub limit: f64,
    /// Friction limit in proportion to the transmitted torque, below one.
    pub load_factor: f64,
    /// 0: presliding distance independent of load. 1: it grows with the limit (constant stiffness).
    pub growth: f64,
    /// Elastic torque at which the given slip distances hold when they grow with the limit.
    pub reference_torque: f64,
}

/// Elastic law of the drive behind a symmetric dead zone: a line, or points joined by lines.
#[derive(Debug, Clone, Copy)]
pub struct Spring<'a> {
    /// Half width of the dead zone, in the unit of the angle.
    pub free_play: f64,
    /// Twist for one unit of torque where no points are given.
    pub compliance: f64,
    /// Points of the law: torques, rising through zero; none for a line.
    pub law_torque: &'a [f64],
    /// Twist beyond the dead zone at these torques, rising strictly.
    pub law_twist: &'a [f64],
}

impl Spring<'_> {
    /// Requires what the law's own numbers must be.
    fn check(&self) -> Result<(), HistoryError> {
        same_length(self.law_torque.len(), &[self.law_twist.len()])?;
        numbers("free_play", &[self.free_play])?;
        numbers("compliance", &[self.compliance])?;
        numbers("law_torque", self.law_torque)?;
        numbers("law_twist", self.law_twist)
    }

    /// Elastic torque and its slope at a twist measured from the datum.
    fn torque(&self, twist: f64) -> (f64, f64) {
        let beyond = if twist > self.free_play {
            twist - self.free_play
        } else if twist < -self.free_play {
            twist + self.free_play
        } else {
            return (0.0, 0.0);
        };
        if self.law_twist.len() < 2 {
            let slope = 1.0 / self.compliance;
            return (beyond * slope, slope);
        }
        let (from, to) = self.segment(self.law_twist, beyond);
        let slope = (self.law_torque[to] - self.law_torque[from])
            / (self.law_twist[to] - self.law_twist[from]);
        (
            self.law_torque[from] + slope * (beyond - self.law_twist[from]),
            slope,
        )
    }

    /// Largest twist beyond the dead zone that a torque of this magnitude can make.
    fn reach(&self, torque: f64) -> f64 {
        if self.law_twist.len() < 2 {
            return self.compliance * torque;
        }
        let at = |value: f64| {
            let (from, to) = self.segment(self.law_torque, value);
            let slope = (self.law_twist[to] - self.law_twist[from])
                / (self.law_torque[to] - self.law_torque[from]);
            self.law_twist[from] + slope * (value - self.law_torque[from])
        };
        at(torque).abs().max(at(-torque).abs())
    }

    /// The two points of the law around a value; the outermost pair goes on beyond the ends.
    fn segment(&self, points: &[f64], value: f64) -> (usize, usize) {
        let to = points
            .partition_point(|&p| p < value)
            .clamp(1, points.len() - 1);
        (to - 1, to)
    }
}

impl SlipElements<'_> {
    /// Requires what the elements' own numbers must be.
    fn check(&self) -> Result<(), HistoryError> {
        same_length(self.slip_angle.len(), &[self.share.len()])?;
        not_negative("slip_angle", self.slip_angle)?;
        numbers("share", self.share)?;
        numbers("limit", &[self.limit])?;
        numbers("load_factor", &[self.load_factor])?;
        numbers("growth", &[self.growth])?;
        numbers("reference_torque", &[self.reference_torque])
    }

    fn load_limit(&self, elastic_torque: f64) -> f64 {
        self.limit + self.load_factor * elastic_torque.abs()
    }

    /// How much longer than given the slip distances are under this limit.
    fn stretch(&self, limit: f64) -> f64 {
        if self.growth == 0.0 {
            return 1.0;
        }
        let reference = self.load_limit(self.reference_torque);
        (limit / reference).max(1e-9).powf(self.growth)
    }

    /// Sum of the elements' states (each within its share), its slope in the angle, and the part of
    /// the sum that elements hold which do not slide.
    fn state(&self, angle: f64, anchor: &[f64], stretch: f64) -> (f64, f64, f64) {
        let mut sum = 0.0;
        let mut slope = 0.0;
        let mut held = 0.0;
        for ((&slip, &share), &z) in self.slip_angle.iter().zip(self.share).zip(anchor) {
            let reach = slip * stretch;
            let ratio = (angle - z) / reach;
            let clipped = ratio.clamp(-1.0, 1.0);
            sum += share * clipped;
            if clipped == ratio {
                slope += share / reach;
                held += share * clipped;
            }
        }
        (sum, slope, held)
    }

    /// Drags every anchor along so that no element is stretched beyond its reach.
    fn settle(&self, angle: f64, anchor: &mut [f64], stretch: f64) {
        for (&slip, z) in self.slip_angle.iter().zip(anchor) {
            let reach = slip * stretch;
            *z = within(*z, angle - reach, angle + reach);
        }
    }
}

/// Angle and friction torque for a torque history.
///
/// `offset` is everything that shifts the datum, sample by sample; `restart[i]` marks a sample before
/// which the elements are fresh, anchored at `start_angle[i]`.
///
/// # Errors
/// [`HistoryError`] when columns differ in length or hold what is not a number.
#[expect(
    clippy::too_many_arguments,
    reason = "one slice per column of the history, two of them to fill"
)]
pub fn solve_slip(
    torque: &[f64],
    offset: &[f64],
    restart: &[bool],
    start_angle: &[f64],
    spring: Spring<'_>,
    elements: &SlipElements<'_>,
    angle: &mut [f64],
    friction: &mut [f64],
) -> Result<(), HistoryError> {
    let columns = [offset.len(), restart.len(), start_angle.len()];
    same_length(torque.len(), &columns)?;
    same_length(torque.len(), &[angle.len(), friction.len()])?;
    numbers("torque", torque)?;
    numbers("offset", offset)?;
    numbers_at_starts("start_angle", start_angle, restart)?;
    spring.check()?;
    elements.check()?;
    let mut anchor = vec![0.0; elements.slip_angle.len()];
    let mut guess = 0.0;
    for i in 0..torque.len() {
        if i == 0 || restart[i] {
            anchor.fill(start_angle[i]);
            guess = start_angle[i];
        }
        let (solved, force, stretch) =
            balance(torque[i], offset[i], spring, elements, &anchor, guess);
        elements.settle(solved, &mut anchor, stretch);
        angle[i] = solved;
        friction[i] = force;
        guess = solved;
    }
    Ok(())
}

/// The one angle at which elastic torque and friction add up to the applied torque.
fn balance(
    torque: f64,
    offset: f64,
    spring: Spring<'_>,
    elements: &SlipElements<'_>,
    anchor: &[f64],
    guess: f64,
) -> (f64, f64, f64) {
    let evaluate = |angle: f64| {
        let (elastic, stiffness) = spring.torque(angle - offset);
        let limit = elements.load_limit(elastic);
        let stretch = elements.stretch(limit);
        let (state, slope, held) = elements.state(angle, anchor, stretch);
        // A growing limit also stretches the elements that hold.
        let growth =
            elements.load_factor * stiffness * elastic.signum() * (state - elements.growth * held);
        let force = limit * state;
        (
            elastic + force - torque,
            stiffness + growth + limit * slope,
            force,
            stretch,
        )
    };
    // The friction can never exceed its limit, which brackets the elastic torque.
    let bound = (torque.abs() + elements.limit) / (1.0 - elements.load_factor).max(0.05);
    let reach = spring.free_play + spring.reach(bound) * (1.0 + 1e-9) + 1e-9;
    let (mut low, mut high) = (offset - reach, offset + reach);
    let mut angle = within(guess, low, high);
    let tolerance = 1e-9 * (1e-3 + torque.abs());
    let mut best = evaluate(angle);
    for _ in 0..100 {
        if best.0.abs() <= tolerance || high - low <= 1e-13 * (1.0 + high.abs()) {
            break;
        }
        if best.0 > 0.0 {
            high = angle;
        } else {
            low = angle;
        }
        let newton = angle - best.0 / best.1;
        angle = if newton.is_finite() && newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        best = evaluate(angle);
    }
    (angle, best.2, best.3)
}

/// State of slip elements along a given angle history: sum of the shares, each between -1 and 1.
///
/// `stretch[i]` is how much longer than given the slip distances are at sample `i`.
///
/// # Errors
/// [`HistoryError`] when columns differ in length or hold what is not a number, or a slip distance
/// or its stretch is negative.
pub fn slip_state(
    angle: &[f64],
    restart: &[bool],
    start_angle: &[f64],
    stretch: &[f64],
    elements: &SlipElements<'_>,
    out: &mut [f64],
) -> Result<(), HistoryError> {
    let columns = [restart.len(), start_angle.len(), stretch.len(), out.len()];
    same_length(angle.len(), &columns)?;
    numbers("angle", angle)?;
    numbers_at_starts("start_angle", start_angle, restart)?;
    not_negative("stretch", stretch)?;
    elements.check()?;
    let mut anchor = vec![0.0; elements.slip_angle.len()];
    for i in 0..angle.len() {
        if i == 0 || restart[i] {
            anchor.fill(start_angle[i]);
        }
        elements.settle(angle[i], &mut anchor, stretch[i]);
        out[i] = elements.state(angle[i], &anchor, stretch[i]).0;
    }
    Ok(())
}

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

/// Input that a dashpot in parallel lets through: the torque balance `u = x + tau dx/dt`, solved sample
/// by sample with the rate taken backwards.
///
/// `lapse[i]` is the time that led to sample `i`; `restart[i]` marks a sample reached from rest.
///
/// # Errors
/// [`HistoryError`] when columns differ in length.
pub fn dragged(
    input: &[f64],
    lapse: &[f64],
    restart: &[bool],
    lag: f64,
    out: &mut [f64],
) -> Result<(), HistoryError> {
    same_length(input.len(), &[lapse.len(), restart.len(), out.len()])?;
    let mut state = 0.0;
    for i in 0..input.len() {
        if i == 0 || restart[i] {
            state = 0.0;
        }
        // Without a lapse nothing can have moved.
        let held = lag / lapse[i].max(1e-12 * lag.abs().max(1e-300));
        state = (input[i] + held * state) / (1.0 + held);
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn single(limit: f64, slip: &[f64]) -> SlipElements<'_> {
        SlipElements {
            slip_angle: slip,
            share: &[1.0],
            limit,
            load_factor: 0.0,
            growth: 0.0,
            reference_torque: 1.0,
        }
    }

    #[test]
    fn loop_width_is_twice_friction_times_compliance() {
        let up: Vec<f64> = (0..=100).map(|k| k as f64 * 0.1).collect();
        let torque: Vec<f64> = up.iter().chain(up.iter().rev()).copied().collect();
        let n = torque.len();
        let (mut angle, mut friction) = (vec![0.0; n], vec![0.0; n]);
        let spring = Spring {
            free_play: 0.0,
            compliance: 2.0,
            law_torque: &[],
            law_twist: &[],
        };
        solve_slip(
            &torque,
            &vec![0.0; n],
            &vec![false; n],
            &vec![0.0; n],
            spring,
            &single(0.5, &[0.01]),
            &mut angle,
            &mut friction,
        )
        .expect("numbers");
        let width = angle[151] - angle[50];
        assert!((width - 2.0 * 0.5 * 2.0).abs() < 1e-9, "{width}");
    }

    #[test]
    fn creep_reaches_the_load_and_a_ramp_lags_by_the_time_constant() {
        let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.1).collect();
        let mut out = vec![0.0; time.len()];
        let mut restart = vec![false; time.len()];
        restart[0] = true;
        creep_state(&time, &time, &restart, 5.0, &mut out).expect("lengths");
        assert!((time[1999] - out[1999] - 5.0).abs() < 1e-9);
    }

    #[test]
    fn drag_delays_a_ramp_by_its_lag() {
        let ramp: Vec<f64> = (1..=400).map(|k| f64::from(k) * 0.1).collect();
        let mut out = vec![0.0; ramp.len()];
        dragged(&ramp, &vec![0.1; 400], &vec![false; 400], 2.0, &mut out).expect("lengths");
        assert!((ramp[399] - out[399] - 2.0).abs() < 1e-6);
        dragged(&ramp, &vec![0.1; 400], &vec![false; 400], 0.0, &mut out).expect("lengths");
        assert_eq!(ramp, out);
    }

    #[test]
    fn remembered_datum_saturates() {
        let mut out = vec![0.0; 200];
        remembered_datum(&[1.0; 200], 0.5, &mut out);
        assert!(out[0] == 0.0 && (out[199] - 2.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_a_number_is_refused_and_does_not_panic() {
        let (mut out, mut force) = (vec![0.0; 2], vec![0.0; 2]);
        let (zero, fresh) = ([0.0; 2], [false; 2]);
        let bad = [0.0, f64::NAN];
        let elements = single(0.5, &[0.01]);
        let refused = |what| HistoryError::NotANumber { what, place: 1 };
        assert_eq!(
            slip_state(&bad, &fresh, &zero, &[1.0; 2], &elements, &mut out),
            Err(refused("angle"))
        );
        assert_eq!(
            slip_state(&zero, &fresh, &zero, &bad, &elements, &mut out),
            Err(refused("stretch"))
        );
        assert_eq!(
            play(&bad, 1.0, &fresh, &zero, &mut out),
            Err(refused("signal"))
        );
        assert_eq!(
            play(&zero, -1.0, &fresh, &zero, &mut out),
            Err(HistoryError::Negative {
                what: "half_width",
                value: -1.0
            })
        );
        let spring = Spring {
            free_play: 0.0,
            compliance: 2.0,
            law_torque: &[],
            law_twist: &[],
        };
        let mut solve = |torque: &[f64], slip: &[f64]| {
            let elements = single(0.5, slip);
            let (angle, friction) = (&mut out[..], &mut force[..]);
            solve_slip(
                torque, &zero, &fresh, &zero, spring, &elements, angle, friction,
            )
        };
        assert_eq!(solve(&bad, &[0.01]), Err(refused("torque")));
        assert_eq!(
            solve(&zero[..1], &[0.01]),
            Err(HistoryError::Length {
                expected: 1,
                found: 2
            })
        );
        assert!(solve(&zero, &[-0.01]).is_err());
        assert!(solve(&[f64::INFINITY, 1.0], &[0.01]).is_ok());
    }

    proptest! {
        #[test]
        fn balance_holds_and_friction_stays_within_its_limit(
            torque in prop::collection::vec(-30.0..30.0f64, 2..60),
            limit in 0.0..2.0f64, load in 0.0..0.3f64, growth in prop::sample::select(vec![0.0, 1.0]),
            curved: bool,
        ) {
            let torques = [-60.0, -20.0, -2.0, 0.0, 2.0, 20.0, 60.0];
            let n = torque.len();
            let slip = [0.05, 0.4, 2.0];
            let elements = SlipElements {
                slip_angle: &slip, share: &[0.5, 0.3, 0.2], limit, load_factor: load, growth,
                reference_torque: 10.0,
            };
            let bent = [-90.0, -60.0, -2.0, 0.0, 2.0, 60.0, 90.0];
            let spring = if curved {
                Spring { free_play: 3.0, compliance: 2.5, law_torque: &torques, law_twist: &bent }
            } else {
                Spring { free_play: 3.0, compliance: 2.5, law_torque: &[], law_twist: &[] }
            };
            let (mut angle, mut friction) = (vec![0.0; n], vec![0.0; n]);
            solve_slip(&torque, &vec![0.0; n], &vec![false; n], &vec![0.0; n], spring, &elements,
                       &mut angle, &mut friction).expect("numbers");
            for i in 0..n {
                let elastic = spring.torque(angle[i]).0;
                prop_assert!(friction[i].abs() <= limit + load * elastic.abs() + 1e-9);
                prop_assert!((elastic + friction[i] - torque[i]).abs() < 1e-6);
            }
        }
    }
}
