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
    HistoryError, finite, not_negative, numbers, numbers_at_starts, positive, same_length, within,
};

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
    /// Share of every element that follows Dahl's law, from 0 to 1; the rest is Maxwell slip.
    pub forgetting: f64,
}

/// What the elements remember of the angles before.
#[derive(Debug, Clone)]
struct Past {
    /// Angle of the last sample.
    angle: f64,
    /// Anchor of each element by Maxwell slip.
    anchor: Vec<f64>,
    /// State of each element by Dahl's law, from -1 to 1.
    dahl: Vec<f64>,
}

impl Past {
    /// Fresh elements at an angle.
    fn fresh(angle: f64, elements: usize) -> Self {
        Self {
            angle,
            anchor: vec![angle; elements],
            dahl: vec![0.0; elements],
        }
    }
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
    pub(super) fn torque(&self, twist: f64) -> (f64, f64) {
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
        finite("share", self.share)?;
        numbers("limit", &[self.limit])?;
        numbers("load_factor", &[self.load_factor])?;
        numbers("growth", &[self.growth])?;
        numbers("reference_torque", &[self.reference_torque])?;
        not_negative("forgetting", &[self.forgetting])?;
        not_negative("one less forgetting", &[1.0 - self.forgetting])
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

    /// Sum of the elements' states (each within its share), its slope in the angle, and how much it
    /// falls with the stretch, relative to it.
    fn state(&self, angle: f64, past: &Past, stretch: f64) -> (f64, f64, f64) {
        let (slips, forgets) = (1.0 - self.forgetting, self.forgetting);
        let mut sum = 0.0;
        let mut slope = 0.0;
        let mut falls = 0.0;
        if slips > 0.0 {
            for ((&slip, &share), &z) in self.slip_angle.iter().zip(self.share).zip(&past.anchor) {
                let share = slips * share;
                let reach = slip * stretch;
                let ratio = (angle - z) / reach;
                let clipped = ratio.clamp(-1.0, 1.0);
                sum += share * clipped;
                if clipped == ratio {
                    slope += share / reach;
                    falls += share * clipped;
                }
            }
        }
        if forgets > 0.0 {
            for ((&slip, &share), &x) in self.slip_angle.iter().zip(self.share).zip(&past.dahl) {
                let share = forgets * share;
                let reach = slip * stretch;
                let way = (angle - past.angle) / reach;
                let (left, state) = dahl_step(x, way);
                sum += share * state;
                slope += share * left.abs() / reach;
                falls += share * left.abs() * way;
            }
        }
        (sum, slope, falls)
    }

    /// Moves the elements to an angle: no anchor is stretched beyond its reach.
    fn go(&self, angle: f64, past: &mut Past, stretch: f64) {
        for (&slip, z) in self.slip_angle.iter().zip(&mut past.anchor) {
            let reach = slip * stretch;
            *z = within(*z, angle - reach, angle + reach);
        }
        if self.forgetting > 0.0 {
            for (&slip, x) in self.slip_angle.iter().zip(&mut past.dahl) {
                *x = dahl_step(*x, (angle - past.angle) / (slip * stretch)).1;
            }
        }
        past.angle = angle;
    }
}

/// What is left to the limit of the way it goes, and the state, after a way in presliding distances.
fn dahl_step(state: f64, way: f64) -> (f64, f64) {
    let limit = if way < 0.0 { -1.0 } else { 1.0 };
    let left = (limit - state) * (-way.abs()).exp();
    (left, limit - left)
}

/// Angle and friction torque for a torque history.
///
/// `offset` is everything that shifts the datum, sample by sample; `restart[i]` marks a sample before
/// which the elements are fresh, anchored at `start_angle[i]`.
///
/// # Errors
/// [`HistoryError`] when columns differ in length or hold what is not a number, or a torque, offset
/// or share is infinite.
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
    let count = elements.slip_angle.len();
    let mut past = Past::fresh(0.0, count);
    let mut last = Balance::default();
    let mut way = 0.0;
    for i in 0..torque.len() {
        let mut guess = last.angle;
        if i == 0 || restart[i] {
            past = Past::fresh(start_angle[i], count);
            guess = start_angle[i];
            way = 0.0;
        } else {
            // Along a branch hardly any element changes between sticking and sliding, so that the
            // slope at the last sample leads to the next one; behind a reversal it does not.
            let step = torque[i] - torque[i - 1];
            let shift = offset[i] - offset[i - 1];
            if step * way > 0.0 {
                guess += (step + last.stiffness * shift) / last.slope;
            }
            if step != 0.0 {
                way = step;
            }
        }
        last = balance(torque[i], offset[i], spring, elements, &past, guess);
        elements.go(last.angle, &mut past, last.stretch);
        angle[i] = last.angle;
        friction[i] = last.friction;
    }
    Ok(())
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

/// The one angle at which elastic torque and friction add up to the applied torque.
fn balance(
    torque: f64,
    offset: f64,
    spring: Spring<'_>,
    elements: &SlipElements<'_>,
    past: &Past,
    guess: f64,
) -> Balance {
    let evaluate = |angle: f64| {
        let (elastic, stiffness) = spring.torque(angle - offset);
        let limit = elements.load_limit(elastic);
        let stretch = elements.stretch(limit);
        let (state, slope, falls) = elements.state(angle, past, stretch);
        // A growing limit also stretches the elements.
        let growth =
            elements.load_factor * stiffness * elastic.signum() * (state - elements.growth * falls);
        let force = limit * state;
        Balance {
            angle,
            friction: force,
            stretch,
            excess: elastic + force - torque,
            slope: stiffness + growth + limit * slope,
            stiffness: stiffness + growth,
        }
    };
    // The friction can never exceed its limit, which brackets the elastic torque.
    let bound = (torque.abs() + elements.limit) / (1.0 - elements.load_factor).max(0.05);
    let reach = spring.free_play + spring.reach(bound) * (1.0 + 1e-9) + 1e-9;
    let (mut low, mut high) = (offset - reach, offset + reach);
    let tolerance = 1e-12 * (1e-3 + torque.abs());
    let mut best = evaluate(within(guess, low, high));
    for _ in 0..100 {
        if best.excess.abs() <= tolerance || high - low <= 1e-13 * (1.0 + high.abs()) {
            break;
        }
        if best.excess > 0.0 {
            high = best.angle;
        } else {
            low = best.angle;
        }
        let newton = best.angle - best.excess / best.slope;
        best = evaluate(if newton.is_finite() && newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        });
    }
    best
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
    positive("slip_angle", elements.slip_angle)?;
    elements.check()?;
    let count = elements.slip_angle.len();
    let mut past = Past::fresh(0.0, count);
    for i in 0..angle.len() {
        if i == 0 || restart[i] {
            past = Past::fresh(start_angle[i], count);
        }
        elements.go(angle[i], &mut past, stretch[i]);
        out[i] = elements.state(angle[i], &past, stretch[i]).0;
    }
    Ok(())
}
