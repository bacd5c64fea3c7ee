//! Slip elements: their numbers, and their states along a history of angles.

use crate::model::hysteresis::checks::{
    HistoryError, finite, not_negative, numbers, positive, same_length, within,
};
use crate::model::hysteresis::exponential::{LANES, decay};

/// Load over the reference torque up to which the ratio of limit and load changes with the load:
/// beyond it, a growing one would hold whatever is applied.
const MOST_BENT: f64 = 4.0;

/// Friction of the contacts: slip elements in parallel that share one limit.
#[derive(Debug, Clone)]
pub struct SlipElements<'a> {
    /// Presliding distance of each element, in the unit of the angle, positive.
    pub slip_angle: &'a [f64],
    /// Share of the friction limit that each element carries; the shares normally add up to one.
    pub share: &'a [f64],
    /// Friction limit without load, in the unit of the torque.
    pub limit: f64,
    /// Friction limit over the transmitted torque at the reference torque, below one.
    pub load_factor: f64,
    /// Power by which that ratio grows with the load; 0: the limit is in proportion to the load.
    pub load_power: f64,
    /// 0: presliding distance independent of load. 1: it grows with the limit (constant stiffness).
    pub growth: f64,
    /// Elastic torque at which the given slip distances and load factor hold.
    pub reference_torque: f64,
    /// Share of every element that follows Dahl's law, from 0 to 1; the rest is Maxwell slip.
    pub forgetting: f64,
}

impl SlipElements<'_> {
    /// Requires what the elements' own numbers must be.
    pub(super) fn check(&self) -> Result<(), HistoryError> {
        same_length(self.slip_angle.len(), &[self.share.len()])?;
        positive("slip_angle", self.slip_angle)?;
        finite("share", self.share)?;
        numbers("limit", &[self.limit])?;
        numbers("load_factor", &[self.load_factor])?;
        finite("load_power", &[self.load_power])?;
        if self.load_power != 0.0 {
            positive("reference_torque", &[self.reference_torque])?;
        }
        numbers("growth", &[self.growth])?;
        numbers("reference_torque", &[self.reference_torque])?;
        not_negative("forgetting", &[self.forgetting])?;
        not_negative("one less forgetting", &[1.0 - self.forgetting])
    }

    /// Friction limit under an elastic torque.
    #[inline(always)]
    pub(super) fn load_limit(&self, elastic_torque: f64) -> f64 {
        let load = elastic_torque.abs();
        self.limit + self.load_share(load) * load
    }

    /// Friction limit over a load, less what is there without load.
    #[inline(always)]
    fn load_share(&self, load: f64) -> f64 {
        if self.load_power == 0.0 {
            return self.load_factor;
        }
        let relative = (load / self.reference_torque).min(MOST_BENT);
        self.load_factor * (0.5 * (1.0 + relative)).powf(self.load_power)
    }

    /// Slope of the friction limit in the elastic torque.
    #[inline(always)]
    pub(super) fn limit_slope(&self, elastic_torque: f64) -> f64 {
        let load = elastic_torque.abs();
        let bends = if self.load_power == 0.0 || load > MOST_BENT * self.reference_torque {
            0.0
        } else {
            self.load_power * load / (self.reference_torque + load)
        };
        self.load_share(load) * (1.0 + bends) * elastic_torque.signum()
    }

    /// How much longer than given the slip distances are under this limit.
    #[inline(always)]
    pub(super) fn stretch(&self, limit: f64) -> f64 {
        if self.growth == 0.0 || self.load_factor == 0.0 {
            return 1.0;
        }
        let reference = self.load_limit(self.reference_torque);
        (limit / reference).max(1e-9).powf(self.growth)
    }
}

/// A number for each element of a block.
type Block = [f64; LANES];

/// Some elements side by side; those that fill up the last block carry nothing.
///
/// A block of numbers fills one line of the cache, and is read far slower from two.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct ElementBlock {
    /// Presliding distance.
    slip: Block,
    /// One over it.
    per_slip: Block,
    /// Share of the friction limit.
    share: Block,
    /// Angle to which the element is tied, by Maxwell slip.
    anchor: Block,
    /// State by Dahl's law, from -1 to 1.
    dahl: Block,
    /// That state at the angle looked at last.
    dahl_there: Block,
}

/// States of all elements, and the angle where they are.
#[derive(Debug, Clone)]
pub(super) struct ElementStates {
    blocks: Vec<ElementBlock>,
    angle: f64,
    forgetting: f64,
}

/// Sums over all elements at an angle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ElementSums {
    /// States, each within its share.
    pub state: f64,
    /// Slope of the states in the angle.
    pub slope: f64,
    /// How much the states fall with the stretch, relative to it.
    pub falls: f64,
}

impl ElementStates {
    /// Fresh elements at the angle 0.
    pub(super) fn new(elements: &SlipElements<'_>) -> Self {
        let filled = |values: &[f64], rest: f64| {
            let mut block = [rest; LANES];
            block[..values.len()].copy_from_slice(values);
            block
        };
        let pairs = elements.slip_angle.chunks(LANES);
        let blocks = pairs
            .zip(elements.share.chunks(LANES))
            .map(|(slip, share)| {
                let slip = filled(slip, 1.0);
                ElementBlock {
                    slip,
                    per_slip: slip.map(|slip| 1.0 / slip),
                    share: filled(share, 0.0),
                    anchor: [0.0; LANES],
                    dahl: [0.0; LANES],
                    dahl_there: [0.0; LANES],
                }
            });
        Self {
            blocks: blocks.collect(),
            angle: 0.0,
            forgetting: elements.forgetting,
        }
    }

    /// Makes all elements fresh at an angle.
    pub(super) fn start(&mut self, angle: f64) {
        for block in &mut self.blocks {
            block.anchor = [angle; LANES];
            block.dahl = [0.0; LANES];
        }
        self.angle = angle;
    }

    /// Sums over the elements if they were moved to an angle.
    #[inline(always)]
    pub(super) fn look_at(&mut self, angle: f64, stretch: f64) -> ElementSums {
        let (slips, forgets) = (1.0 - self.forgetting, self.forgetting);
        let mut sums = ElementSums::default();
        let per_stretch = 1.0 / stretch;
        if slips > 0.0 {
            let [state, slope, falls] = self.maxwell_slip(angle, per_stretch);
            sums.state += slips * state;
            sums.slope += slips * slope * per_stretch;
            sums.falls += slips * falls;
        }
        if forgets > 0.0 {
            let way = (angle - self.angle) * per_stretch;
            let [state, slope] = self.dahl(way);
            sums.state += forgets * state;
            sums.slope += forgets * slope * per_stretch;
            sums.falls += forgets * slope * way;
        }
        sums
    }

    /// State, slope over the given slip distances, and fall with the stretch by Maxwell slip.
    #[inline(always)]
    fn maxwell_slip(&self, angle: f64, per_stretch: f64) -> [f64; 3] {
        let [mut state, mut slope, mut falls] = [[0.0; LANES]; 3];
        for block in &self.blocks {
            for lane in 0..LANES {
                let ratio = (angle - block.anchor[lane]) * (block.per_slip[lane] * per_stretch);
                let clipped = ratio.clamp(-1.0, 1.0);
                let part = block.share[lane] * clipped;
                let sticks = if clipped == ratio { 1.0 } else { 0.0 };
                state[lane] += part;
                slope[lane] += sticks * (block.share[lane] * block.per_slip[lane]);
                falls[lane] += sticks * part;
            }
        }
        [state, slope, falls].map(total)
    }

    /// State, and slope over the given slip distances, by Dahl's law after a way.
    #[inline(always)]
    fn dahl(&mut self, way: f64) -> [f64; 2] {
        let limit = if way < 0.0 { -1.0 } else { 1.0 };
        let length = way.abs();
        let [mut state, mut slope] = [[0.0; LANES]; 2];
        for block in &mut self.blocks {
            let decayed = decay(block.per_slip.map(|per_slip| length * per_slip));
            for lane in 0..LANES {
                let left = (limit - block.dahl[lane]) * decayed[lane];
                block.dahl_there[lane] = limit - left;
                state[lane] += block.share[lane] * (limit - left);
                slope[lane] += block.share[lane] * left.abs() * block.per_slip[lane];
            }
        }
        [state, slope].map(total)
    }

    /// Moves the elements to the angle looked at last: no anchor is stretched beyond its reach.
    #[inline(always)]
    pub(super) fn go(&mut self, angle: f64, stretch: f64) {
        for block in &mut self.blocks {
            for lane in 0..LANES {
                let reach = block.slip[lane] * stretch;
                block.anchor[lane] = within(block.anchor[lane], angle - reach, angle + reach);
            }
            block.dahl = block.dahl_there;
        }
        self.angle = angle;
    }
}

/// A block in one line of the cache.
#[repr(align(64))]
struct Aligned(Block);

/// Sum of a block.
///
/// The block is read back from memory: left alone, the compiler splits all sums that lead to it into
/// pairs, and the loops over elements are no longer as wide as a block.
#[inline(always)]
fn total(block: Block) -> f64 {
    let [a, b, c, d, e, f, g, h] = std::hint::black_box(&Aligned(block)).0;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}
