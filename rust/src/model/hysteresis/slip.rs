//! Slip elements: angle and friction of a torque history, state of a given angle history.
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
//! IEEE Trans. Autom. Control 50(11), 2005, doi 10.1109/TAC.2005.858676). A share `forgetting` of each
//! element follows Dahl's law instead (AIAA J. 14, 1976), whose state approaches the limit of the way it
//! goes, `dx = (sign(d theta) - x) |d theta| / delta_j`, and remembers no turning points. The equation is
//! monotone in the angle, so it has one solution a sample, found by a safeguarded Newton step.

use crate::model::hysteresis::checks::{
    HistoryError, finite, numbers_at_starts, positive, same_length, within,
};
use crate::model::hysteresis::elements::{ElementStates, SlipElements};
use crate::model::hysteresis::spring::Spring;
use crate::wide::{Wide, with_widest};

/// Angle and friction torque for a torque history.
///
/// `offset` is everything that shifts the datum, sample by sample; `restart[i]` marks a sample before
/// which the elements are fresh, anchored at `start_angle[i]`.
///
/// # Errors
/// [`HistoryError`] when columns differ in length or hold what is not a number, a torque, offset or
/// share is infinite, or a slip distance is not above zero.
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
    finite("torque", torque)?;
    finite("offset", offset)?;
    numbers_at_starts("start_angle", start_angle, restart)?;
    spring.check()?;
    elements.check()?;
    with_widest(SlipWork {
        torque,
        offset,
        restart,
        start_angle,
        solver: Solver::new(spring, elements, torque),
        angle,
        friction,
    });
    Ok(())
}

/// A history to solve.
struct SlipWork<'a> {
    torque: &'a [f64],
    offset: &'a [f64],
    restart: &'a [bool],
    start_angle: &'a [f64],
    solver: Solver<'a>,
    angle: &'a mut [f64],
    friction: &'a mut [f64],
}

impl Wide for SlipWork<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let mut last = Balance::default();
        let mut way = 0.0;
        for i in 0..self.torque.len() {
            let (torque, offset) = (self.torque[i], self.offset[i]);
            let mut guess = last.angle;
            if i == 0 || self.restart[i] {
                guess = self.start_angle[i];
                self.solver.states.start(guess);
                way = 0.0;
            } else {
                // Along a branch hardly any element changes between sticking and sliding, so that
                // the slope at the last sample leads to the next one; behind a reversal it does not.
                let step = torque - self.torque[i - 1];
                let shift = offset - self.offset[i - 1];
                if step * way > 0.0 {
                    guess += (step + last.stiffness * shift) / last.slope;
                }
                if step != 0.0 {
                    way = step;
                }
            }
            last = self.solver.balance(torque, offset, guess);
            self.solver.states.go(last.angle, last.stretch);
            self.angle[i] = last.angle;
            self.friction[i] = last.friction;
        }
    }
}

/// State of a sample at which all torques balance.
#[derive(Debug, Clone, Copy, Default)]
struct Balance {
    /// Angle of the shaft.
    angle: f64,
    /// Friction torque.
    friction: f64,
    /// How much longer than given the slip distances are.
    stretch: f64,
    /// What balances the applied torque, less that torque.
    excess: f64,
    /// Slope of the balancing torque in the angle.
    slope: f64,
    /// Part of that slope that moves with the datum.
    stiffness: f64,
}

/// The drive with its friction, wherever the elements are.
struct Solver<'a> {
    spring: Spring<'a>,
    elements: &'a SlipElements<'a>,
    states: ElementStates,
    /// Point of the elastic law where the last angle was.
    near: usize,
    /// Largest twist from the datum that the history can lead to.
    reach: f64,
}

impl<'a> Solver<'a> {
    /// Fresh elements, for a history of these torques.
    fn new(spring: Spring<'a>, elements: &'a SlipElements<'a>, torque: &[f64]) -> Self {
        // The friction can never exceed its limit, which brackets the elastic torque.
        let largest = torque
            .iter()
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        let least_elastic = if elements.load_power == 0.0 {
            1.0 - elements.load_factor
        } else {
            0.0
        };
        let bound = (largest + elements.limit) / least_elastic.max(0.05);
        Self {
            spring,
            elements,
            states: ElementStates::new(elements),
            near: 0,
            reach: spring.free_play + spring.reach(bound) * (1.0 + 1e-9) + 1e-9,
        }
    }

    /// How far an angle is from balance with the applied torque.
    #[inline(always)]
    fn look_at(&mut self, torque: f64, offset: f64, angle: f64) -> Balance {
        let elements = self.elements;
        let (elastic, stiffness) = self.spring.torque(angle - offset, &mut self.near);
        let limit = elements.load_limit(elastic);
        let stretch = elements.stretch(limit);
        let sums = self.states.look_at(angle, stretch);
        // A growing limit also stretches the elements.
        let growth =
            elements.limit_slope(elastic) * stiffness * (sums.state - elements.growth * sums.falls);
        let force = limit * sums.state;
        Balance {
            angle,
            friction: force,
            stretch,
            excess: elastic + force - torque,
            slope: stiffness + growth + limit * sums.slope,
            stiffness: stiffness + growth,
        }
    }

    /// The one angle at which elastic torque and friction add up to the applied torque.
    #[inline(always)]
    fn balance(&mut self, torque: f64, offset: f64, guess: f64) -> Balance {
        let (mut low, mut high) = (offset - self.reach, offset + self.reach);
        let tolerance = 1e-12 * (1e-3 + torque.abs());
        let mut best = self.look_at(torque, offset, within(guess, low, high));
        for _ in 0..100 {
            // What rounding of the angle makes of the torque where the drive is nearly rigid.
            let rounding = 4.0 * f64::EPSILON * best.angle.abs() * best.slope;
            let is_balanced = best.excess.abs() <= tolerance.max(rounding);
            if is_balanced || high - low <= 1e-13 * (1.0 + high.abs()) {
                break;
            }
            if best.excess > 0.0 {
                high = best.angle;
            } else {
                low = best.angle;
            }
            let newton = best.angle - best.excess / best.slope;
            let next = if newton.is_finite() && newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            best = self.look_at(torque, offset, next);
        }
        best
    }
}

/// State of slip elements along a given angle history: sum of the shares, each between -1 and 1.
///
/// `stretch[i]` is how much longer than given the slip distances are at sample `i`.
///
/// # Errors
/// [`HistoryError`] when columns differ in length or hold what is not a number, an angle or share is
/// infinite, or a slip distance or its stretch is not above zero.
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
    finite("angle", angle)?;
    numbers_at_starts("start_angle", start_angle, restart)?;
    positive("stretch", stretch)?;
    elements.check()?;
    let mut states = ElementStates::new(elements);
    for i in 0..angle.len() {
        if i == 0 || restart[i] {
            states.start(start_angle[i]);
        }
        out[i] = states.look_at(angle[i], stretch[i]).state;
        states.go(angle[i], stretch[i]);
    }
    Ok(())
}
