//! Which output pins are active over one turn of the mesh zone, in closed form, by three criteria.
//!
//! Angles in this file are in turns (1 turn = 2 pi rad): an eighth of a turn is then a binary
//! number and the ideal map comes out exact.

use crate::model::arrangement::{
    Arrangement, Counts, MAX_PINS, TIE, first_hole, fold, reduced_clocking,
};
use crate::model::error::DesignError;
use crate::model::published_map::{counts_by_walking, windows};
use crate::model::rounding::floor;

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

/// An arrangement of oversized holes and pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinMap {
    ratio: f64,
    discs: u32,
    pins: u32,
    delta: f64,
    clocking: f64,
}

impl PinMap {
    /// The arrangement of `pins` holes on each of `discs` equally phased discs.
    ///
    /// `delta` is asin(e / (2 R_OP)) (turns), `clocking` the turn of the hole pattern from the
    /// position symmetric about ring pin 0 (turns): hole j stands at `clocking + (j + 1/2) / N_OP`.
    ///
    /// # Errors
    /// [`DesignError`] for a ratio below 3, other than 1 to 4 discs or 3 to 64 pins, a `delta`
    /// outside 0 to a quarter turn, or what is not a number.
    pub fn new(
        ratio: f64,
        discs: u32,
        pins: u32,
        delta: f64,
        clocking: f64,
    ) -> Result<Self, DesignError> {
        if ratio.is_nan() || ratio < 3.0 {
            return Err(DesignError::RatioOutOfRange { ratio });
        }
        if !(1..=4).contains(&discs) {
            let discs = f64::from(discs);
            return Err(DesignError::DiscCountOutOfRange { discs });
        }
        if !(3..=MAX_PINS as u32).contains(&pins) {
            let pins = f64::from(pins);
            return Err(DesignError::PinCountOutOfRange { pins });
        }
        for (parameter, value) in [("delta", delta), ("hole_clocking", clocking)] {
            if !value.is_finite() {
                return Err(DesignError::NonFinite { parameter });
            }
        }
        if delta < 0.0 {
            let parameter = "delta";
            return Err(DesignError::Negative {
                parameter,
                value: delta,
            });
        }
        if delta >= 0.25 {
            let ratio = (delta * std::f64::consts::TAU).sin();
            return Err(DesignError::HoleNeverCrossesPitchCircle { ratio });
        }
        Ok(Self {
            ratio,
            discs,
            pins,
            delta,
            clocking,
        })
    }

    /// Reduction ratio i.
    #[must_use]
    pub const fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Number of discs.
    #[must_use]
    pub const fn discs(&self) -> u32 {
        self.discs
    }

    /// Number of output pins N_OP.
    #[must_use]
    pub const fn pins(&self) -> u32 {
        self.pins
    }

    /// delta = asin(e / (2 R_OP)) (turns).
    #[must_use]
    pub const fn delta(&self) -> f64 {
        self.delta
    }

    /// Clocking of the hole pattern (turns).
    #[must_use]
    pub const fn clocking(&self) -> f64 {
        self.clocking
    }

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
        published_counts(&self.arrangement()).into()
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
        Participation {
            mean: mean_participation(&self.arrangement()),
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
            Criterion::PublishedMap => windows(&self.arrangement())
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

/// Counts by `published-map`, in closed form where it holds.
pub(crate) fn published_counts(map: &Arrangement) -> Counts {
    let (counts, holds) = map.published_map();
    if holds {
        counts
    } else {
        counts_by_walking(map)
    }
}

/// Mean participation by statics; `first_hole` in pitches.
pub(crate) fn mean_participation(map: &Arrangement) -> f64 {
    let lattice = map.lattice();
    let travel = 1.0 + 1.0 / map.ratio;
    let origin = map.first_hole / map.pins;
    let total = odd_integral((travel - origin) * lattice, lattice)
        - odd_integral(-origin * lattice, lattice);
    map.fold / map.pins * total / (lattice * travel)
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
mod tests;
