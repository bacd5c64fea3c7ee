//! The criterion `published-map`: windows of one disc's holes, and their counts by walking over
//! them where the closed form of [`crate::model::arrangement`] does not hold.
//!
//! Angles are in turns.

use crate::model::arrangement::{Arrangement, Counts, MAX_PINS, TIE};

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

/// Counts by walking over all windows: the slow way, which always holds.
pub(crate) fn counts_by_walking(map: &Arrangement) -> Counts {
    let windows = windows(map);
    let mut sum = 0.0;
    for k in 0..windows.len {
        sum += windows.ends[k] - windows.starts[k];
    }
    let (mut min, mut max) = (u32::MAX, 0);
    windows.for_each_sector(|_, _, count| {
        min = min.min(count);
        max = max.max(count);
    });
    Counts {
        mean: sum * map.discs,
        min: f64::from(min) * map.discs,
        max: f64::from(max) * map.discs,
    }
}

/// Windows of one disc's holes.
pub(crate) fn windows(map: &Arrangement) -> Windows {
    let mut windows = Windows {
        starts: [0.0; MAX_PINS + 2],
        ends: [0.0; MAX_PINS + 2],
        len: 0,
    };
    let pins = map.pins as u32;
    let shrink = map.ratio / (map.ratio + 1.0);
    let pitch = 1.0 / map.pins;
    let (open, close) = (0.25 + map.delta, 0.75 - map.delta);
    let nearest = map.nearest_left_hole() * pitch;
    let left = (((0.5 - TIE + nearest) / pitch).floor() as u32 + 1).min(pins);
    for m in (0..left).rev() {
        let phi = nearest - f64::from(m) * pitch;
        let end = (phi + close) * shrink;
        let end = if m == 0 { end } else { end.min(0.5) };
        windows.push(((phi + open) * shrink).max(0.0), end);
    }
    for m in 0..pins - left {
        let phi = -(nearest + pitch) - f64::from(m) * pitch;
        let end = (phi + close) * shrink;
        let end = if m == 0 { end } else { end.min(0.5) };
        windows.push(1.0 - end, 1.0 - ((phi + open) * shrink).max(0.0));
    }
    let again_left = (nearest + 1.0 + open) * shrink;
    let again_right = (1.0 + open - nearest - pitch) * shrink;
    if again_left < 1.0 || (left < pins && again_right < 1.0) {
        if again_left < 1.0 {
            windows.push(again_left, ((nearest + 1.0 + close) * shrink).min(1.0));
        }
        if left < pins && again_right < 1.0 {
            let end = ((1.0 + close - nearest - pitch) * shrink).min(1.0);
            windows.push(1.0 - end, 1.0 - again_right);
        }
        windows.starts[..windows.len].sort_unstable_by(f64::total_cmp);
        windows.ends[..windows.len].sort_unstable_by(f64::total_cmp);
    }
    windows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::arrangement::{first_hole, fold};
    use crate::model::random;

    #[test]
    fn the_closed_form_is_the_walk() {
        let mut closed_forms = 0;
        let total = 400_000;
        for k in 0..total {
            let u = |axis: u64| random(axis, k);
            let pins = 3.0 + (u(3) * u(3) * 62.0).floor();
            let discs = 1.0 + (u(2) * 4.0).floor();
            let clocking = (u(5) - 0.5) * if k % 2 == 0 { 0.02 } else { 1.0 };
            let map = Arrangement {
                ratio: 3.0 + (u(1) * u(1) * 298.0).floor(),
                discs,
                pins,
                delta: 0.2 * u(4).powi(4),
                first_hole: first_hole(clocking, pins),
                fold: fold(pins, discs),
            };
            let walked = counts_by_walking(&map);
            let (closed, holds) = map.published_map();
            if !holds {
                continue;
            }
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
