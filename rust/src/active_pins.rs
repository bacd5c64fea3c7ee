//! Which output pins are active over one turn of the mesh zone, in closed form, by three criteria.
//!
//! Angles in this file are in turns (1 turn = 2 pi rad): an eighth of a turn is then a binary
//! number and the ideal map comes out exact.

use crate::arrangement::{Arrangement, Counts, TIE, first_hole, fold, reduced_clocking};
use crate::rounding::floor;

/// Most output pins a design may have.
pub const MAX_PINS: usize = 64;

/// Rule by which a hole-pin contact counts as active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Criterion {
    /// A reconstruction that matches the published map; see [`PinMap::published_map`].
    PublishedMap = 0,
    /// The hole's centre lies inside the pins' pitch circle; see [`PinMap::inside`].
    Inside = 1,
    /// The hole pushes its pin in the sense of the torque; see [`PinMap::statics`].
    Statics = 2,
}

impl Criterion {
    /// Every criterion, in the order of its code.
    pub const ALL: [Criterion; 3] = [
        Criterion::PublishedMap,
        Criterion::Inside,
        Criterion::Statics,
    ];

    /// The word used in files and tables.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Criterion::PublishedMap => "published-map",
            Criterion::Inside => "inside",
            Criterion::Statics => "statics",
        }
    }
}

/// Number of active hole-pin contacts, all discs together, over one turn of the mesh zone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ActiveCount {
    /// Mean over one turn.
    pub mean: f64,
    /// Smallest.
    pub min: u32,
    /// Largest.
    pub max: u32,
}

impl From<Counts> for ActiveCount {
    fn from(counts: Counts) -> Self {
        Self {
            mean: counts.mean,
            min: counts.min as u32,
            max: counts.max as u32,
        }
    }
}

/// Participation p = sum of sin^2 over the loaded contacts / N_OP.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Participation {
    /// Mean over one turn of the mesh zone.
    pub mean: f64,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

/// A stretch of the mesh zone's travel over which the number of active contacts is constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Where it starts (turns).
    pub start: f64,
    /// Where it ends (turns).
    pub end: f64,
    /// Active contacts, all discs together.
    pub active: u32,
}

/// An arrangement of oversized holes and pins, checked by the caller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinMap {
    /// Reduction ratio i.
    pub ratio: f64,
    /// Discs, equally phased.
    pub discs: u32,
    /// Output pins N_OP.
    pub pins: u32,
    /// delta = asin(e / (2 R_OP)) (turns).
    pub delta: f64,
    /// Clocking of the hole pattern from the position symmetric about ring pin 0 (turns): hole j
    /// stands at `clocking + (j + 1/2) / N_OP`.
    pub clocking: f64,
}

impl PinMap {
    /// The same with real numbers, the clocking reduced.
    pub(crate) fn arrangement(&self) -> Arrangement {
        let pins = f64::from(self.pins);
        let clocking = if self.clocking.abs() <= 1.0 {
            self.clocking
        } else {
            reduced_clocking(self.clocking, pins)
        };
        let discs = f64::from(self.discs);
        Arrangement {
            ratio: self.ratio,
            discs,
            pins,
            delta: self.delta,
            first_hole: first_hole(clocking, pins),
            fold: fold(pins, discs),
        }
    }

    /// Torque transfer efficiency eta_OP (Eqs. 1-3) of a mean number of active contacts.
    #[must_use]
    pub fn efficiency(&self, mean: f64) -> f64 {
        self.arrangement().efficiency(mean)
    }

    /// Counts by the criterion `inside`: the hole's centre lies inside the pins' pitch circle.
    #[must_use]
    pub fn inside(&self) -> ActiveCount {
        self.arrangement().inside().into()
    }

    /// Counts by `statics`: the hole pushes its pin in the sense of the torque.
    #[must_use]
    pub fn statics(&self) -> ActiveCount {
        self.arrangement().statics().into()
    }

    /// Participation of the pins by statics, over one turn of the mesh zone.
    ///
    /// The forces of a rigid disc on equal springs go with sin(psi), so the stiffness is the sum
    /// of sin^2 over the loaded half. Pairs half a turn apart add to one: an even lattice gives
    /// n/4 at every position. An odd one pulsates about it by (sec(pi/M) - 1) / 4 of a contact,
    /// M = lcm(N, n). One spring per hole-pin contact; valid for one or two discs.
    #[must_use]
    pub fn participation(&self) -> Participation {
        let fold = self.arrangement().fold as u32;
        let lattice = self.pins / fold * self.discs;
        let share = f64::from(fold) / f64::from(self.pins);
        let m = f64::from(lattice);
        if lattice.is_multiple_of(2) {
            let mean = 0.25 * f64::from(self.discs);
            return Participation {
                mean,
                min: mean,
                max: mean,
            };
        }
        let half_swing = 0.25 * (1.0 / (std::f64::consts::PI / m).cos() - 1.0);
        let travel = 1.0 + 1.0 / self.ratio;
        let origin = self.first_hole();
        let total = odd_integral((travel - origin) * m, m) - odd_integral(-origin * m, m);
        Participation {
            mean: share * total / (m * travel),
            min: share * (0.25 * m - half_swing),
            max: share * (0.25 * m + half_swing),
        }
    }

    /// The sectors of one turn by a criterion, with equal neighbours joined.
    #[must_use]
    pub fn sectors(&self, criterion: Criterion) -> Vec<Sector> {
        let mut sectors: Vec<Sector> = Vec::new();
        let mut add = |start: f64, end: f64, active: u32| match sectors.last_mut() {
            Some(last) if last.active == active => last.end = end,
            _ => sectors.push(Sector { start, end, active }),
        };
        match criterion {
            Criterion::PublishedMap => self
                .published_windows()
                .for_each_sector(|start, end, count| add(start, end, count * self.discs)),
            Criterion::Inside => {
                self.equal_window_sectors(0.25 + self.delta, 0.75 - self.delta, add);
            }
            Criterion::Statics => self.equal_window_sectors(0.0, 0.5, add),
        }
        sectors
    }

    /// The stretch over which hole H1, the one of the left half nearest ring pin 0, is active:
    /// (start, end) in turns of the mesh zone.
    #[must_use]
    pub fn first_hole_window(&self) -> (f64, f64) {
        let shrink = self.ratio / (self.ratio + 1.0);
        let nearest = self.arrangement().nearest_left_hole() / f64::from(self.pins);
        (
            (nearest + 0.25 + self.delta) * shrink,
            (nearest + 0.75 - self.delta) * shrink,
        )
    }

    fn equal_window_sectors(&self, low: f64, high: f64, mut add: impl FnMut(f64, f64, u32)) {
        let fold = self.arrangement().fold as u32;
        let lattice = f64::from(self.pins / fold * self.discs);
        let origin = self.first_hole();
        let travel = 1.0 + 1.0 / self.ratio;
        let mut edges: Vec<f64> = Vec::new();
        for edge in [low, high] {
            let first = ((-origin - edge) * lattice).ceil();
            edges.extend(
                (0..)
                    .map(|k| (first + f64::from(k)) / lattice + origin + edge)
                    .take_while(|x| *x < travel),
            );
        }
        edges.push(travel);
        edges.sort_unstable_by(f64::total_cmp);
        let mut from = 0.0;
        for edge in edges {
            if edge - from > TIE {
                let middle = 0.5 * (from + edge) - origin;
                let count =
                    ((middle - low) * lattice).floor() - ((middle - high) * lattice).floor();
                add(from / travel, edge / travel, count as u32 * fold);
                from = edge;
            }
        }
    }

    /// Angle (turns) of the first hole from ring pin 0 on, within one pitch.
    fn first_hole(&self) -> f64 {
        self.arrangement().first_hole / f64::from(self.pins)
    }
}

/// Integral from 0 to `y` (in lattice steps) of the sum of sin^2 over the loaded half of an odd
/// lattice of `m` points.
#[inline]
fn odd_integral(y: f64, m: f64) -> f64 {
    use std::f64::consts::PI;
    let steps = floor(y);
    let rest = y - steps;
    let swing = 0.25 / (PI / m).cos();
    // One step holds (m + 1)/2 loaded points over its first half and (m - 1)/2 over its second.
    let wave = |from_centre: f64| swing * m / (4.0 * PI) * (4.0 * PI * from_centre / m).sin();
    let half = |length: f64| wave(length - 0.25) - wave(-0.25);
    let first = |length: f64| 0.25 * (m + 1.0) * length - half(length);
    let second = |length: f64| 0.25 * (m - 1.0) * length + half(length);
    let whole = first(0.5) + second(0.5);
    steps * whole
        + if rest < 0.5 {
            first(rest)
        } else {
            first(0.5) + second(rest - 0.5)
        }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// e -> 0, no spin, symmetric clocking.
    const IDEAL: PinMap = PinMap {
        ratio: 1e30,
        discs: 2,
        pins: 8,
        delta: 0.0,
        clocking: 0.0,
    };

    #[test]
    fn the_ideal_map_is_the_published_one_exactly() {
        let count = IDEAL.published_map();
        assert_eq!(
            count,
            ActiveCount {
                mean: 6.75,
                min: 4,
                max: 8
            }
        );
        assert_eq!(IDEAL.efficiency(count.mean), 0.84375);
        let at = |turn: f64| {
            let turn = turn.rem_euclid(1.0);
            let inside = |s: &&Sector| s.start <= turn && turn < s.end;
            IDEAL
                .sectors(Criterion::PublishedMap)
                .iter()
                .find(inside)
                .map(|s| s.active)
        };
        let centres: Vec<_> = (0..8).map(|k| at(f64::from(k) / 8.0 + 1e-6)).collect();
        assert_eq!(centres, [4, 6, 8, 8, 6, 8, 8, 6].map(Some));
    }

    #[test]
    fn with_its_own_spin_and_clocking_the_mean_falls_by_a_percent() {
        let delta = (0.0125_f64 / 2.0).asin() / std::f64::consts::TAU;
        let clocking = 66.0 / 360.0 * 88.0 / 87.0 - 0.1875 - delta;
        let map = PinMap {
            ratio: 87.0,
            delta,
            clocking,
            ..IDEAL
        };
        assert_relative_eq!(
            map.first_hole_window().0 * 360.0,
            66.0,
            max_relative = 1e-12
        );
        assert_abs_diff_eq!(map.published_map().mean, 6.676, epsilon = 5e-4);
    }

    #[test]
    fn statics_shares_agree_with_a_direct_sum() {
        for (pins, discs) in [(3, 1), (5, 3), (7, 1), (8, 1), (9, 2), (9, 3), (64, 4)] {
            let map = PinMap {
                ratio: 11.0,
                discs,
                pins,
                delta: 0.01,
                clocking: 0.013,
            };
            let steps = 200_000;
            let (mut sum, mut low, mut high) = (0.0, f64::INFINITY, 0.0_f64);
            for k in 0..steps {
                let x = (f64::from(k) + 0.5) / f64::from(steps) * (1.0 + 1.0 / map.ratio);
                let mut total = 0.0;
                for d in 0..discs {
                    for j in 0..pins {
                        let phi = map.clocking + (f64::from(j) + 0.5) / f64::from(pins);
                        let psi = x + f64::from(d) / f64::from(discs) - phi;
                        total += (psi * std::f64::consts::TAU).sin().max(0.0).powi(2);
                    }
                }
                let p = total / f64::from(pins);
                sum += p;
                low = low.min(p);
                high = high.max(p);
            }
            let p = map.participation();
            assert_abs_diff_eq!(p.mean, sum / f64::from(steps), epsilon = 1e-7);
            assert_abs_diff_eq!(p.min, low, epsilon = 1e-7);
            assert_abs_diff_eq!(p.max, high, epsilon = 1e-7);
        }
    }

    #[test]
    fn sectors_cover_the_turn_and_average_to_the_mean() {
        for criterion in Criterion::ALL {
            for (pins, discs, ratio) in [(8, 2, 87.0), (9, 2, 3.0), (3, 4, 5.0), (64, 3, 299.0)] {
                let map = PinMap {
                    ratio,
                    discs,
                    pins,
                    delta: 0.004,
                    clocking: -0.003,
                };
                let sectors = map.sectors(criterion);
                let mut at = 0.0;
                let mut mean = 0.0;
                for s in &sectors {
                    assert_abs_diff_eq!(s.start, at, epsilon = 1e-11);
                    mean += (s.end - s.start) * f64::from(s.active);
                    at = s.end;
                }
                assert_abs_diff_eq!(at, 1.0, epsilon = 1e-11);
                let count = match criterion {
                    Criterion::PublishedMap => map.published_map(),
                    Criterion::Inside => map.inside(),
                    Criterion::Statics => map.statics(),
                };
                assert_abs_diff_eq!(mean, count.mean, epsilon = 1e-9);
                assert_eq!(sectors.iter().map(|s| s.active).min(), Some(count.min));
                assert_eq!(sectors.iter().map(|s| s.active).max(), Some(count.max));
            }
        }
    }
}
