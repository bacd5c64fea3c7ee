//! The stage of the active pins: counts by each criterion that is needed, and what goes with them.

use crate::kernel::lanes::{BLOCK, InputLanes, Lanes, Mask, Variant, for_each_lane};
use crate::kernel::stages::{Stage, WholeNumbers, blocks_of, stage};
use crate::model::active_pins::{Criterion, mean_participation, published_counts};
use crate::model::checks::Checks;
use crate::model::error::DesignError;
use crate::model::hypotrochoid::crossing_angle;
use crate::model::inputs::Input;
use crate::model::pin_force::{factors, tabulated_factor};
use crate::model::{Arrangement, Counts, first_hole, fold, reduced_clocking, statics_apply};

blocks_of!(
    Counts,
    CountsBlock {
        /// Mean.
        mean,
        /// Smallest.
        min,
        /// Largest.
        max,
    }
);

stage! {
    /// The active-pin map and what goes with its inputs alone.
    Map, MapBlock {
        /// Active contacts by the chosen criterion: mean over one turn of the mesh zone.
        active_mean,
        /// Smallest.
        active_min,
        /// Largest.
        active_max,
        /// eta_OP by the chosen criterion.
        efficiency,
        /// The factor on the compliance in Eq. (13): eta_OP, or one by statics.
        twist_factor,
        /// eta_OP by `inside`.
        efficiency_inside,
        /// eta_OP by `published-map`.
        efficiency_published_map,
        /// Mean participation by statics; NaN for more than two discs, where statics do not apply.
        participation,
        /// N_OP.
        pins,
        /// N_OP p where statics feeds the twist, N_OP elsewhere.
        pins_in_twist,
        /// i^2.
        ratio_squared,
        /// Largest pin force per output torque (1/m) at the worst position; see
        /// [`crate::model::pin_force`].
        force_per_torque,
        /// One where the statics hold: at most two discs.
        statics_applicable,
    }
}

/// Which criteria's figures are needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Criteria {
    /// Those of `published-map`.
    pub published_map: bool,
    /// Those of `inside`.
    pub inside: bool,
    /// Those of `statics`.
    pub statics: bool,
    /// The participation by statics.
    pub participation: bool,
    /// The largest pin force by statics.
    pub pin_force: bool,
}

impl Criteria {
    /// All of them.
    pub(crate) const ALL: Self = Self {
        published_map: true,
        inside: true,
        statics: true,
        participation: true,
        pin_force: true,
    };
    /// None of them: only the checks.
    pub(crate) const NONE: Self = Self {
        published_map: false,
        inside: false,
        statics: false,
        participation: false,
        pin_force: false,
    };
    /// What the chosen criterion needs, of which this is the code, and what columns of every
    /// criterion and the pin force need if they are asked for.
    #[inline(always)]
    pub(crate) fn of(code: f64, columns: bool, pin_force: bool) -> Self {
        let statics = code >= Criterion::Statics as u8 as f64;
        let published_map = code < Criterion::Inside as u8 as f64;
        Self {
            published_map: columns || published_map,
            inside: columns || !(published_map || statics),
            statics,
            participation: columns || statics,
            pin_force,
        }
    }
}

stage! {
    /// What the counts of an arrangement need of its inputs.
    Angles, AnglesBlock {
        /// delta = asin(e / (2 R_OP)) (turns).
        delta,
        /// Where the first hole from ring pin 0 on stands, from 0 to 1 pitch.
        first_hole,
        /// Greatest common divisor of pins and discs.
        fold,
    }
}

/// What comes before the map of a block.
pub(crate) struct MapParts {
    angles: Box<AnglesBlock>,
    published_map: Box<CountsBlock>,
    inside: Box<CountsBlock>,
    statics: Box<CountsBlock>,
    participation: Lanes,
    pin_force_factor: Lanes,
}

impl MapParts {
    /// Before anything is known.
    pub(crate) fn new() -> Self {
        Self {
            angles: Angles::NONE.block(),
            published_map: Counts::NONE.block(),
            inside: Counts::NONE.block(),
            statics: Counts::NONE.block(),
            participation: [f64::NAN; BLOCK],
            pin_force_factor: [f64::NAN; BLOCK],
        }
    }
}

impl Angles {
    /// Checks all that the stage reads, and computes.
    #[inline(always)]
    fn of(inputs: &impl Variant, checks: &mut impl Checks) -> Self {
        let WholeNumbers { pins, .. } = WholeNumbers::of(inputs, checks);
        let (e, circle) = (Input::Eccentricity, Input::OutputPinCircleRadius);
        let angle = crossing_angle(inputs.get(e), inputs.get(circle), checks);
        let clocking = checks.finite("hole_clocking", inputs.get(Input::HoleClocking));
        let code = checks.finite("criterion", inputs.get(Input::Criterion));
        checks.require((code >= 0.0) & (code < Criterion::ALL.len() as f64), || {
            DesignError::NonFinite {
                parameter: "criterion",
            }
        });
        let in_a_turn = checks.value_or_else(clocking.abs() <= 1.0, clocking, || {
            reduced_clocking(clocking, pins)
        });
        Self {
            delta: angle * std::f64::consts::TAU.recip(),
            first_hole: first_hole(in_a_turn, pins),
            fold: fold(pins, inputs.get(Input::DiscCount)),
        }
    }

    #[inline(always)]
    fn arrangement(&self, inputs: &impl Variant) -> Arrangement {
        Arrangement {
            ratio: inputs.get(Input::Ratio),
            discs: inputs.get(Input::DiscCount),
            pins: inputs.get(Input::OutputPinCount),
            delta: self.delta,
            first_hole: self.first_hole,
            fold: self.fold,
        }
    }

    #[inline(always)]
    fn published_map(&self, inputs: &impl Variant, checks: &mut impl Checks) -> Counts {
        let map = self.arrangement(inputs);
        let (counts, holds) = map.published_map();
        checks.value_or_else(holds, counts, || published_counts(&map))
    }

    #[inline(always)]
    fn participation(&self, inputs: &impl Variant, checks: &mut impl Checks) -> f64 {
        let map = self.arrangement(inputs);
        let (even, holds) = map.even_participation();
        checks.value_or_else(holds, even, || mean_participation(&map))
    }
}

impl Map {
    /// The inputs this stage reads.
    pub(crate) const INPUTS: [Input; 7] = [
        Input::Ratio,
        Input::DiscCount,
        Input::Eccentricity,
        Input::OutputPinCount,
        Input::OutputPinCircleRadius,
        Input::HoleClocking,
        Input::Criterion,
    ];

    /// Checks and computes; figures that go with a criterion that is not needed are NaN.
    #[inline]
    pub(crate) fn of(inputs: &impl Variant, needed: Criteria, checks: &mut impl Checks) -> Self {
        let angles = Angles::of(inputs, checks);
        let (mut published_map, mut participation) = (Counts::NONE, f64::NAN);
        let (mut inside, mut statics) = (Counts::NONE, Counts::NONE);
        if needed.published_map {
            published_map = angles.published_map(inputs, checks);
        }
        if needed.inside {
            inside = angles.arrangement(inputs).inside();
        }
        if needed.statics {
            statics = angles.arrangement(inputs).statics();
        }
        if needed.participation {
            participation = angles.participation(inputs, checks);
        }
        let map = angles.arrangement(inputs);
        let force_factor = if needed.pin_force {
            tabulated_factor(factors(), map.lattice())
        } else {
            f64::NAN
        };
        let shares = (participation, force_factor);
        Self::assemble(inputs, &map, published_map, inside, statics, shares)
    }

    /// [`Map::of`] for every variant of a block.
    ///
    /// In loops of a few dozen instructions: the processor then works on several variants at once.
    #[inline(always)]
    pub(crate) fn compute_block(
        inputs: &InputLanes,
        needed: Criteria,
        parts: &mut MapParts,
        block: &mut MapBlock,
        mask: &mut Mask,
    ) {
        let angles = &mut *parts.angles;
        for_each_lane!(inputs, mask, |row, lane, checks| {
            Angles::of(lane, checks).put(angles, row);
        });
        if needed.published_map {
            let out = &mut *parts.published_map;
            for_each_lane!(inputs, mask, |row, lane, checks| {
                let angles = Angles::get(angles, row);
                angles.published_map(lane, checks).put(out, row);
            });
        }
        if needed.inside {
            let out = &mut *parts.inside;
            for_each_lane!(inputs, mask, |row, lane, _checks| {
                let angles = Angles::get(angles, row);
                angles.arrangement(lane).inside().put(out, row);
            });
        }
        if needed.statics {
            let out = &mut *parts.statics;
            for_each_lane!(inputs, mask, |row, lane, _checks| {
                let angles = Angles::get(angles, row);
                angles.arrangement(lane).statics().put(out, row);
            });
        }
        if needed.participation {
            let out = &mut parts.participation;
            for_each_lane!(inputs, mask, |row, lane, checks| {
                out[row] = Angles::get(angles, row).participation(lane, checks);
            });
        }
        if needed.pin_force {
            let (out, factors) = (&mut parts.pin_force_factor, factors());
            for_each_lane!(inputs, mask, |row, lane, _checks| {
                let map = Angles::get(angles, row).arrangement(lane);
                out[row] = tabulated_factor(factors, map.lattice());
            });
        }
        let (published_map, inside) = (&*parts.published_map, &*parts.inside);
        let (statics, participation) = (&*parts.statics, &parts.participation);
        let force_factor = &parts.pin_force_factor;
        for_each_lane!(inputs, mask, |row, lane, _checks| {
            let map = Self::assemble(
                lane,
                &Angles::get(angles, row).arrangement(lane),
                Counts::get(published_map, row),
                Counts::get(inside, row),
                Counts::get(statics, row),
                (participation[row], force_factor[row]),
            );
            map.put(block, row);
        });
    }

    #[inline(always)]
    fn assemble(
        inputs: &impl Variant,
        arrangement: &Arrangement,
        published_map: Counts,
        inside: Counts,
        statics: Counts,
        (participation, force_factor): (f64, f64),
    ) -> Self {
        let Arrangement {
            ratio, discs, pins, ..
        } = *arrangement;
        let code = inputs.get(Input::Criterion);
        let by_statics = code >= Criterion::Statics as u8 as f64;
        let by_map = code < Criterion::Inside as u8 as f64;
        let others = Counts::choose(by_statics, statics, inside);
        let active = Counts::choose(by_map, published_map, others);
        let efficiency = arrangement.efficiency(active.mean);
        Self {
            active_mean: active.mean,
            active_min: active.min,
            active_max: active.max,
            efficiency,
            twist_factor: if by_statics { 1.0 } else { efficiency },
            efficiency_inside: arrangement.efficiency(inside.mean),
            efficiency_published_map: arrangement.efficiency(published_map.mean),
            participation,
            pins,
            pins_in_twist: if by_statics {
                pins * participation
            } else {
                pins
            },
            ratio_squared: ratio * ratio,
            force_per_torque: 4.0 * force_factor
                / (discs * pins * inputs.get(Input::OutputPinCircleRadius)),
            statics_applicable: if statics_apply(discs) { 1.0 } else { 0.0 },
        }
    }
}
