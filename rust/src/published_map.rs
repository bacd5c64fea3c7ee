//! The criterion `published-map`: windows of one disc's holes, and their counts by walking over
//! them where the closed form of [`crate::arrangement`] does not hold.
//!
//! Angles are in turns, as in [`crate::active_pins`].

use crate::active_pins::{ActiveCount, MAX_PINS, PinMap};
use crate::arrangement::TIE;

/// Windows of one disc's holes: starts and ends, each ascending (turns).
pub(crate) struct Windows {
    starts: [f64; MAX_PINS + 2],
    ends: [f64; MAX_PINS + 2],
    len: usize,
}

impl Windows {
    #[inline]
    fn push(&mut self, start: f64, end: f64) {
        if end > start {
            self.starts[self.len] = start;
            self.ends[self.len] = end;
            self.len += 1;
        }
    }

    /// Calls `visit(start, end, count)` for every stretch longer than rounding; count is that of
    /// one disc. The stretches cover the turn from 0 to 1.
    #[inline]
    pub(crate) fn for_each_sector(&self, mut visit: impl FnMut(f64, f64, u32)) {
        let (mut opened, mut closed, mut from) = (0, 0, 0.0);
        while opened < self.len || closed < self.len {
            let opens = if opened < self.len {
                self.starts[opened]
            } else {
                f64::INFINITY
            };
            let closes = self.ends[closed];
            let next = opens.min(closes);
            if next - from > TIE {
                visit(from, next, (opened - closed) as u32);
                from = next;
            }
            if opened < self.len && opens <= closes {
                opened += 1;
            } else {
                closed += 1;
            }
        }
        if 1.0 - from > TIE {
            visit(from, 1.0, 0);
        }
    }
}

impl PinMap {
    /// Counts by the criterion `published-map`, a reconstruction that matches the published map
    /// and not the authors' own rule.
    ///
    /// Hole angles are reduced to (-180, 180] deg; a hole at or below zero belongs to the left
    /// half. A left hole's window is `[phi + 90 + delta, phi + 270 - delta] i / (i + 1)`; its
    /// start is clipped at 0, its end at 180 except for the hole of that half nearest ring pin 0
    /// (which, at a low ratio, opens a second time before the turn ends). The right half follows
    /// the same rule on its own holes and is then mirrored, theta -> 360 - theta. One disc's
    /// count is multiplied by the number of discs.
    #[must_use]
    pub fn published_map(&self) -> ActiveCount {
        let (counts, holds) = self.arrangement().published_map();
        if holds {
            counts.into()
        } else {
            self.counts_by_walking()
        }
    }

    pub(crate) fn counts_by_walking(&self) -> ActiveCount {
        let windows = self.published_windows();
        let mut sum = 0.0;
        for k in 0..windows.len {
            sum += windows.ends[k] - windows.starts[k];
        }
        let (mut min, mut max) = (u32::MAX, 0);
        windows.for_each_sector(|_, _, count| {
            min = min.min(count);
            max = max.max(count);
        });
        ActiveCount {
            mean: sum * f64::from(self.discs),
            min: min * self.discs,
            max: max * self.discs,
        }
    }

    pub(crate) fn published_windows(&self) -> Windows {
        let mut windows = Windows {
            starts: [0.0; MAX_PINS + 2],
            ends: [0.0; MAX_PINS + 2],
            len: 0,
        };
        let shrink = self.ratio / (self.ratio + 1.0);
        let pitch = 1.0 / f64::from(self.pins);
        let (open, close) = (0.25 + self.delta, 0.75 - self.delta);
        let nearest = self.arrangement().nearest_left_hole() * pitch;
        let left = (((0.5 - TIE + nearest) / pitch).floor() as u32 + 1).min(self.pins);
        for m in (0..left).rev() {
            let phi = nearest - f64::from(m) * pitch;
            let end = (phi + close) * shrink;
            let end = if m == 0 { end } else { end.min(0.5) };
            windows.push(((phi + open) * shrink).max(0.0), end);
        }
        for m in 0..self.pins - left {
            let phi = -(nearest + pitch) - f64::from(m) * pitch;
            let end = (phi + close) * shrink;
            let end = if m == 0 { end } else { end.min(0.5) };
            windows.push(1.0 - end, 1.0 - ((phi + open) * shrink).max(0.0));
        }
        let again_left = (nearest + 1.0 + open) * shrink;
        let again_right = (1.0 + open - nearest - pitch) * shrink;
        if again_left < 1.0 || (left < self.pins && again_right < 1.0) {
            if again_left < 1.0 {
                windows.push(again_left, ((nearest + 1.0 + close) * shrink).min(1.0));
            }
            if left < self.pins && again_right < 1.0 {
                let end = ((1.0 + close - nearest - pitch) * shrink).min(1.0);
                windows.push(1.0 - end, 1.0 - again_right);
            }
            windows.starts[..windows.len].sort_unstable_by(f64::total_cmp);
            windows.ends[..windows.len].sort_unstable_by(f64::total_cmp);
        }
        windows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::random;

    #[test]
    fn the_closed_form_is_the_walk() {
        let mut closed_forms = 0;
        let total = 400_000;
        for k in 0..total {
            let u = |axis: u64| random(axis, k);
            let map = PinMap {
                ratio: 3.0 + (u(1) * u(1) * 298.0).floor(),
                discs: 1 + (u(2) * 4.0) as u32,
                pins: 3 + (u(3) * u(3) * 62.0) as u32,
                delta: 0.2 * u(4).powi(4),
                clocking: (u(5) - 0.5) * if k % 2 == 0 { 0.02 } else { 1.0 },
            };
            let walked = map.counts_by_walking();
            let (counts, holds) = map.arrangement().published_map();
            if !holds {
                continue;
            }
            let closed = ActiveCount::from(counts);
            closed_forms += 1;
            assert_eq!(
                (closed.min, closed.max),
                (walked.min, walked.max),
                "{map:?}"
            );
            let error = (closed.mean / walked.mean - 1.0).abs();
            assert!(error < 1e-14, "{map:?}: {error:e}");
        }
        assert!(closed_forms > total / 3, "{closed_forms} of {total}");
    }
}
