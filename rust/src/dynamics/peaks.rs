//! The largest torque of a spring along a branch, found by bounds instead of by dense samples.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Part of the largest torque so far within which no other turn is looked for. The turn that is
/// found is then followed to the last digits.
const CLOSE_ENOUGH: f64 = 1e-7;
/// Newton steps with which a turn is followed; two or three are enough.
const STEPS: usize = 6;

/// Largest torque so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Peak {
    /// With its sign (N m).
    pub torque: f64,
    /// When (s).
    pub time: f64,
}

/// A torque around a moment: a parabola, and what it is never farther from it within a radius.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearby {
    /// Value and first two derivatives.
    pub(super) parabola: [f64; 3],
    /// Largest distance from the parabola.
    pub(super) margin: f64,
    /// Whether the parabola touches the torque at its middle.
    pub(super) touches: bool,
}

/// A stretch that may hold a larger torque.
#[derive(PartialEq)]
struct Stretch {
    most: f64,
    from: f64,
    to: f64,
}

impl Eq for Stretch {}

impl PartialOrd for Stretch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Stretch {
    fn cmp(&self, other: &Self) -> Ordering {
        self.most.total_cmp(&other.most)
    }
}

impl Peak {
    pub(super) fn take(&mut self, torque: f64, time: f64) {
        if torque.abs() > self.torque.abs() {
            *self = Self { torque, time };
        }
    }

    /// Looks for a larger torque between two times of a branch.
    ///
    /// `around` describes the torque around a time after `start` within a radius. The stretch that
    /// may hold most is halved first, until none may hold more than the largest torque found; a
    /// turn that has been found is followed by Newton steps.
    pub(super) fn search(
        &mut self,
        start: f64,
        length: f64,
        mut around: impl FnMut(f64, f64) -> Nearby,
    ) {
        let before = *self;
        let mut open = BinaryHeap::new();
        let mut look = |peak: &mut Self, open: &mut BinaryHeap<Stretch>, from: f64, to: f64| {
            let (middle, radius) = (0.5 * (from + to), 0.5 * (to - from));
            let near = around(middle, radius);
            if near.touches {
                peak.take(near.parabola[0], start + middle);
            }
            let most = largest(near.parabola, radius) + near.margin;
            if most > peak.torque.abs() * (1.0 + CLOSE_ENOUGH) && middle > from && middle < to {
                open.push(Stretch { most, from, to });
            }
        };
        look(self, &mut open, 0.0, length);
        while let Some(Stretch { most, from, to }) = open.pop() {
            if most <= self.torque.abs() * (1.0 + CLOSE_ENOUGH) {
                break;
            }
            let middle = 0.5 * (from + to);
            look(self, &mut open, from, middle);
            look(self, &mut open, middle, to);
        }
        if *self != before {
            self.follow(start, length, around);
        }
    }

    /// Follows the turn near the largest torque found.
    fn follow(&mut self, start: f64, length: f64, mut around: impl FnMut(f64, f64) -> Nearby) {
        let mut after = self.time - start;
        for _ in 0..STEPS {
            let [torque, rate, curvature] = around(after, 0.0).parabola;
            self.take(torque, start + after);
            let next = after - rate / curvature;
            if !(next > 0.0 && next < length) || next == after {
                break;
            }
            after = next;
        }
    }
}

/// Largest magnitude of a parabola, given by value and derivatives, within a radius.
fn largest([value, rate, curvature]: [f64; 3], radius: f64) -> f64 {
    let at = |s: f64| (value + s * (rate + 0.5 * curvature * s)).abs();
    let turn = -rate / curvature;
    let ends = at(radius).max(at(-radius)).max(value.abs());
    if turn.abs() < radius {
        ends.max(at(turn))
    } else {
        ends
    }
}
