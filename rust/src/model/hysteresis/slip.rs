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
    let solver = Solver::new(spring, elements, torque);
    with_widest(Piece {
        torque,
        offset,
        restart,
        start_angle,
        solver,
        angle,
        friction,
    });
    Ok(())
}

/// Most looks at the balance of one sample.
const MOST_LOOKS: usize = 100;

impl Wide for Piece<'_> {
    type Output = ();

    /// Solves pieces that know nothing of each other in step.
    ///
    /// A look at the balance of a sample waits for the one before it, while parts of the processor
    /// stand idle: two pieces together take about a tenth less time than one after the other.
    #[inline(always)]
    fn run(self) {
        match self.middle_restart() {
            Some(at) => {
                let (first, second) = self.split_at(at);
                let mut paths = [Path::new(first), Path::new(second)];
                let common = paths[0].piece.torque.len().min(paths[1].piece.torque.len());
                solve_in_step(&mut paths, 0..common);
                for path in paths {
                    let n = path.piece.torque.len();
                    solve_in_step(&mut [path], common..n);
                }
            }
            None => {
                let n = self.torque.len();
                solve_in_step(&mut [Path::new(self)], 0..n);
            }
        }
    }
}

/// Solves samples of some paths, each of which has so many.
#[inline(always)]
fn solve_in_step<const N: usize>(paths: &mut [Path<'_>; N], samples: std::ops::Range<usize>) {
    for i in samples {
        for path in paths.iter_mut() {
            path.begin(i);
        }
        for _ in 0..MOST_LOOKS {
            let mut balanced = true;
            for path in paths.iter_mut() {
                balanced &= path.is_balanced();
            }
            if balanced {
                break;
            }
            for path in paths.iter_mut() {
                path.look_further();
            }
        }
        for path in paths.iter_mut() {
            path.end(i);
        }
    }
}

/// A part of a history whose state does not depend on what came before.
struct Piece<'a> {
    torque: &'a [f64],
    offset: &'a [f64],
    restart: &'a [bool],
    start_angle: &'a [f64],
    solver: Solver<'a>,
    angle: &'a mut [f64],
    friction: &'a mut [f64],
}

impl<'a> Piece<'a> {
    /// The sample with fresh elements that is nearest to the middle; the first does not count.
    fn middle_restart(&self) -> Option<usize> {
        let n = self.restart.len();
        let fresh = (1..n).filter(|&i| self.restart[i]);
        fresh.min_by_key(|&i| (2 * i).abs_diff(n))
    }

    /// What comes before a sample, and the rest.
    fn split_at(self, at: usize) -> (Self, Self) {
        let (torque, next_torque) = self.torque.split_at(at);
        let (offset, next_offset) = self.offset.split_at(at);
        let (restart, next_restart) = self.restart.split_at(at);
        let (start_angle, next_start_angle) = self.start_angle.split_at(at);
        let (angle, next_angle) = self.angle.split_at_mut(at);
        let (friction, next_friction) = self.friction.split_at_mut(at);
        let first = Self {
            torque,
            offset,
            restart,
            start_angle,
            solver: self.solver.clone(),
            angle,
            friction,
        };
        let next = Self {
            torque: next_torque,
            offset: next_offset,
            restart: next_restart,
            start_angle: next_start_angle,
            solver: self.solver,
            angle: next_angle,
            friction: next_friction,
        };
        (first, next)
    }
}

/// A piece that is being solved, sample by sample.
struct Path<'a> {
    piece: Piece<'a>,
    /// Torque and offset of the sample that is looked at.
    torque: f64,
    offset: f64,
    /// Last step of the torque that was none.
    way: f64,
    /// Angles between which the sample lies.
    low: f64,
    high: f64,
    /// Torque that may be left.
    tolerance: f64,
    /// The last look at the sample.
    last: Balance,
}

impl<'a> Path<'a> {
    fn new(piece: Piece<'a>) -> Self {
        Self {
            piece,
            torque: 0.0,
            offset: 0.0,
            way: 0.0,
            low: 0.0,
            high: 0.0,
            tolerance: 0.0,
            last: Balance::default(),
        }
    }

    /// Goes to a sample and looks at a guess of its angle.
    #[inline(always)]
    fn begin(&mut self, i: usize) {
        let (torque, offset) = (self.piece.torque[i], self.piece.offset[i]);
        let mut guess = self.last.angle;
        if i == 0 || self.piece.restart[i] {
            guess = self.piece.start_angle[i];
            self.piece.solver.states.start(guess);
            self.way = 0.0;
        } else {
            // Along a branch hardly any element changes between sticking and sliding, so that
            // the slope at the last sample leads to the next one; behind a reversal it does not.
            let step = torque - self.torque;
            let shift = offset - self.offset;
            if step * self.way > 0.0 {
                guess += (step + self.last.stiffness * shift) / self.last.slope;
            }
            if step != 0.0 {
                self.way = step;
            }
        }
        (self.torque, self.offset) = (torque, offset);
        self.tolerance = 1e-12 * (1e-3 + torque.abs());
        let reach = self.piece.solver.reach;
        (self.low, self.high) = (offset - reach, offset + reach);
        let guess = within(guess, self.low, self.high);
        self.last = self.piece.solver.look_at(torque, offset, guess);
    }

    /// Whether the torques balance at the last look, or no angle is left to look at.
    #[inline(always)]
    fn is_balanced(&self) -> bool {
        // What rounding of the angle makes of the torque where the drive is nearly rigid.
        let rounding = 4.0 * f64::EPSILON * self.last.angle.abs() * self.last.slope;
        self.last.excess.abs() <= self.tolerance.max(rounding)
            || self.high - self.low <= 1e-13 * (1.0 + self.high.abs())
    }

    /// Looks at the angle that the last look leads to; at the same one where the torques balance.
    #[inline(always)]
    fn look_further(&mut self) {
        let last = self.last;
        let mut next = last.angle;
        if !self.is_balanced() {
            if last.excess > 0.0 {
                self.high = last.angle;
            } else {
                self.low = last.angle;
            }
            let newton = last.angle - last.excess / last.slope;
            next = if newton.is_finite() && newton > self.low && newton < self.high {
                newton
            } else {
                0.5 * (self.low + self.high)
            };
        }
        self.last = self.piece.solver.look_at(self.torque, self.offset, next);
    }

    /// Keeps what was found for a sample and moves the elements there.
    #[inline(always)]
    fn end(&mut self, i: usize) {
        let last = self.last;
        self.piece.solver.states.go(last.angle, last.stretch);
        self.piece.angle[i] = last.angle;
        self.piece.friction[i] = last.friction;
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
#[derive(Debug, Clone)]
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
