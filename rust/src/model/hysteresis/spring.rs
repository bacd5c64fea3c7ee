//! Elastic law of the drive behind its dead zone.

use crate::model::hysteresis::checks::{HistoryError, numbers, same_length};

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
    pub(super) fn check(&self) -> Result<(), HistoryError> {
        same_length(self.law_torque.len(), &[self.law_twist.len()])?;
        numbers("free_play", &[self.free_play])?;
        numbers("compliance", &[self.compliance])?;
        numbers("law_torque", self.law_torque)?;
        numbers("law_twist", self.law_twist)
    }

    /// Elastic torque and its slope at a twist measured from the datum.
    ///
    /// `near` is the point of the law where it was looked for last, and is moved.
    #[inline(always)]
    pub(super) fn torque(&self, twist: f64, near: &mut usize) -> (f64, f64) {
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
        let to = *near;
        let is_there = to > 0
            && to < self.law_twist.len()
            && self.law_twist[to - 1] < beyond
            && beyond <= self.law_twist[to];
        let (from, to) = if is_there {
            (to - 1, to)
        } else {
            self.segment(self.law_twist, beyond)
        };
        *near = to;
        let slope = (self.law_torque[to] - self.law_torque[from])
            / (self.law_twist[to] - self.law_twist[from]);
        (
            self.law_torque[from] + slope * (beyond - self.law_twist[from]),
            slope,
        )
    }

    /// Largest twist beyond the dead zone that a torque of this magnitude can make.
    pub(super) fn reach(&self, torque: f64) -> f64 {
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
