//! Counts of active pins in closed form, without branches: what a block of variants is computed by.
//!
//! Angles are in turns (1 turn = 2 pi rad) or in pitches of the pins.

use crate::model::rounding::{ceil, floor, larger, nearest, smaller};

/// Angles closer than this (turns) count as equal: sectors shorter than it are rounding.
pub(crate) const TIE: f64 = 1e-12;
/// Most output pins a design may have.
pub const MAX_PINS: usize = 64;
/// Whole numbers of pitches closer than this to a tie are left to the walk over all windows.
const NEAR_TIE: f64 = 1e-9;

/// An arrangement of oversized holes and pins, checked by the caller; its whole numbers are reals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrangement {
    /// Reduction ratio i.
    pub ratio: f64,
    /// Discs, equally phased.
    pub discs: f64,
    /// Output pins N_OP.
    pub pins: f64,
    /// delta = asin(e / (2 R_OP)) (turns).
    pub delta: f64,
    /// Where the first hole from ring pin 0 on stands, from 0 to 1 pitch.
    pub first_hole: f64,
    /// See [`fold`].
    pub fold: f64,
}

/// Active contacts, all discs together, over one turn of the mesh zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Counts {
    /// Mean.
    pub mean: f64,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

impl Counts {
    /// `a` where a choice falls on it, `b` elsewhere.
    #[inline(always)]
    pub(crate) fn choose(is_first: bool, a: Self, b: Self) -> Self {
        Self {
            mean: if is_first { a.mean } else { b.mean },
            min: if is_first { a.min } else { b.min },
            max: if is_first { a.max } else { b.max },
        }
    }
}

/// Whether statics apply: one spring a contact holds while a pin meets one disc at a time.
#[inline(always)]
pub(crate) fn statics_apply(discs: f64) -> bool {
    discs <= 2.0
}

/// Where the first hole from ring pin 0 on stands, from 0 to 1 pitch, for a clocking (turns)
/// within one turn.
#[inline(always)]
pub(crate) fn first_hole(clocking: f64, pins: f64) -> f64 {
    let place = clocking * pins + 0.5;
    place - floor(place)
}

/// A clocking of many turns in less than one pitch: holes bear no numbers, and the turns would
/// cost digits.
#[inline(never)]
pub(crate) fn reduced_clocking(clocking: f64, pins: f64) -> f64 {
    clocking % (1.0 / pins)
}

/// Integral of the floor function from 0 to `y`.
#[inline(always)]
fn floor_integral(y: f64) -> f64 {
    let n = floor(y);
    n * (0.5 * (n - 1.0) + (y - n))
}

/// True when `x` is no whole number within rounding.
#[inline(always)]
fn is_clear(x: f64) -> bool {
    let rest = x - floor(x);
    (rest > NEAR_TIE) & (rest < 1.0 - NEAR_TIE)
}

/// True when `divisor`, given with its reciprocal, divides a whole number.
#[inline(always)]
fn divides(divisor: f64, reciprocal: f64, whole: f64) -> bool {
    nearest(whole * reciprocal) * divisor == whole
}

/// Greatest common divisor of the pins and the discs, of which there are one to four.
#[inline(always)]
pub(crate) fn fold(pins: f64, discs: f64) -> f64 {
    let mut fold = 1.0;
    for (divisor, reciprocal) in [(2.0, 0.5), (3.0, 1.0 / 3.0), (4.0, 0.25)] {
        let is_common = divides(divisor, reciprocal, pins) & divides(divisor, reciprocal, discs);
        fold = if is_common { divisor } else { fold };
    }
    fold
}

impl Arrangement {
    /// Torque transfer efficiency eta_OP (Eqs. 1-3) of a mean number of active contacts:
    /// `mean / (n_discs N_OP / 2)`, which is Eq. (2) for two discs.
    #[inline(always)]
    pub(crate) fn efficiency(&self, mean: f64) -> f64 {
        mean / (0.5 * (self.discs * self.pins))
    }

    /// Counts by the criterion `inside`: hole j of disc d is active while
    /// `cos(theta (1 + 1/i) + 2 pi d / n - phi_j) < -e / (2 R_OP)`.
    #[inline(always)]
    pub(crate) fn inside(&self) -> Counts {
        self.equal_windows(0.25 + self.delta, 0.75 - self.delta)
    }

    /// Counts by `statics`: the hole pushes its pin along the eccentricity's direction, so a
    /// contact carries load while `sin(psi) > 0`, half a turn.
    #[inline(always)]
    pub(crate) fn statics(&self) -> Counts {
        self.equal_windows(0.0, 0.5)
    }

    /// Counts for windows alike on every hole, open while psi lies in (`low`, `high`) turns.
    ///
    /// All holes of all discs stand on one lattice of lcm(N, n) points, each gcd(N, n)-fold, so
    /// the count is a difference of two floor functions: its extremes are the window's width in
    /// lattice steps rounded down and up, and its integral is that of a floor function.
    #[inline(always)]
    fn equal_windows(&self, low: f64, high: f64) -> Counts {
        let fold = self.fold;
        let per_pitch = self.discs / fold;
        let lattice = self.pins * per_pitch;
        let width = (high - low) * lattice;
        let (min, max) = (floor(width) * fold, ceil(width) * fold);
        let origin = self.first_hole * per_pitch;
        let travel = 1.0 + 1.0 / self.ratio;
        let up = |edge: f64| {
            floor_integral((travel - edge) * lattice - origin)
                - floor_integral(-edge * lattice - origin)
        };
        let mean = fold * (up(low) - up(high)) / (lattice * travel);
        let mean = if min == max { min } else { mean };
        Counts { mean, min, max }
    }

    /// Number of angles at which the holes of all discs stand: lcm(N, n).
    #[inline(always)]
    pub(crate) fn lattice(&self) -> f64 {
        self.pins * (self.discs / self.fold)
    }

    /// Participation by statics, NaN where they do not apply, and whether it is the same at every
    /// position of the mesh zone: pairs of lattice points half a turn apart add to one, so that an
    /// even lattice gives n/4.
    #[inline(always)]
    pub(crate) fn even_participation(&self) -> (f64, bool) {
        let apply = statics_apply(self.discs);
        let share = if apply { 0.25 * self.discs } else { f64::NAN };
        (share, divides(2.0, 0.5, self.lattice()) | !apply)
    }

    /// Angle (pitches) of the left half's hole nearest ring pin 0, above minus one and not above
    /// zero.
    #[inline(always)]
    pub(crate) fn nearest_left_hole(&self) -> f64 {
        if self.first_hole < TIE * self.pins {
            self.first_hole
        } else {
            self.first_hole - 1.0
        }
    }

    /// Counts by the criterion `published-map` without looking at each hole, and whether they hold:
    /// not where windows of neighbours interleave, open twice or meet within rounding.
    ///
    /// Over its own half turn a half's count rises while holes open, stands at all of them, and
    /// falls while they close; the other half's nearest hole joins before the half turn ends.
    /// The count is therefore least at the start, where that hole joins, or at the end.
    #[inline(always)]
    pub(crate) fn published_map(&self) -> (Counts, bool) {
        let nearest = self.nearest_left_hole();
        let holes = smaller(
            floor(0.5 * self.pins - TIE * self.pins + nearest) + 1.0,
            self.pins,
        );
        let spin = self.pins / self.ratio;
        let left = Half::of(self, nearest, holes, spin);
        let right = Half::of(self, -nearest - 1.0, self.pins - holes, spin);
        let (low_left, high_left, left_holds) = left.extremes(right.late);
        let (low_right, high_right, right_holds) = right.extremes(left.late);
        let travel = self.pins + spin;
        let counts = Counts {
            mean: self.discs * (left.open_length + right.open_length) / travel,
            min: smaller(low_left, low_right) * self.discs,
            max: larger(high_left, high_right) * self.discs,
        };
        let holds = left.is_plain & right.is_plain & left_holds & right_holds;
        (counts, holds)
    }
}

/// One half's holes, in pitches of psi: hole m of them opens at `opens - m`, closes at
/// `closes - m`, clipped to the half turn.
struct Half {
    holes: f64,
    /// Where the last one to close first of all closes.
    first_close: f64,
    /// Where its nearest hole closes.
    closes: f64,
    /// The half turn's length.
    end: f64,
    /// Open holes at the half turn's start and just before its end.
    at_start: f64,
    at_end: f64,
    /// Sum of the windows' lengths.
    open_length: f64,
    /// Where, seen from the other half, its nearest hole joins.
    late: f64,
    /// Whether windows neither interleave, nor open twice, nor meet within rounding.
    is_plain: bool,
}

impl Half {
    #[inline(always)]
    fn of(map: &Arrangement, nearest: f64, holes: f64, spin: f64) -> Self {
        let end = 0.5 * (map.pins + spin);
        let opens = nearest + (0.25 + map.delta) * map.pins;
        let closes = nearest + (0.75 - map.delta) * map.pins;
        let first_close = closes - (holes - 1.0);
        let late = 2.0 * end - closes;
        let is_plain = (opens > spin + NEAR_TIE)
            & (first_close > opens + NEAR_TIE)
            & (first_close < end - NEAR_TIE)
            & (late > NEAR_TIE)
            & is_clear(opens)
            & is_clear(closes - end);
        let opened_late = smaller(ceil(opens), holes);
        let still_open = smaller(larger(floor(closes - end) + 1.0, 0.0), holes);
        let clipped = larger(still_open, 1.0);
        let ends = (clipped - 1.0) * end + (holes - clipped) * closes + closes
            - 0.5 * (holes * (holes - 1.0) - clipped * (clipped - 1.0));
        let starts = opened_late * (opens - 0.5 * (opened_late - 1.0));
        Self {
            holes,
            first_close,
            closes,
            end,
            at_start: holes - opened_late,
            at_end: still_open,
            open_length: ends - starts,
            late,
            is_plain,
        }
    }

    /// Least and largest count over the half turn, when the other half's nearest hole joins at
    /// `joins`, and whether they hold.
    #[inline(always)]
    fn extremes(&self, joins: f64) -> (f64, f64, bool) {
        let holds = ((joins - self.first_close).abs() > NEAR_TIE)
            & ((joins - self.end).abs() > NEAR_TIE)
            & is_clear(self.closes - joins);
        let before = smaller(floor(self.closes - joins) + 1.0, self.holes);
        let most = if joins < self.first_close { 1.0 } else { 0.0 };
        let least = smaller(smaller(self.at_start, before), self.at_end + 1.0);
        let is_late = joins > self.end;
        let least = if is_late {
            smaller(self.at_start, self.at_end)
        } else {
            least
        };
        let most = if is_late { 0.0 } else { most };
        (least, self.holes + most, holds)
    }
}
