//! The stages of a block of variants: looked up where they are computed beforehand, computed a block
//! at a time elsewhere, and once more, alone, for the few variants whose checks fail in the block.

use crate::kernel::cache::{OutcomeBlock, Precomputed};
use crate::kernel::lanes::{BLOCK, InputLanes, Mask, for_each_lane};
use crate::kernel::map_stage::{Criteria, Map, MapParts};
use crate::kernel::outputs::{Assembly, AssemblyBlock, Block, Output};
use crate::kernel::packed::Inputs;
use crate::kernel::shaft_plan::ShaftPlan;
use crate::kernel::stages::{Geometry, PinBending, Rating, Shaft, Stage};
use crate::model::checks::checked;
use crate::model::error::DesignError;
use crate::model::inputs::{Input, SCALARS, SEGMENT_FIELDS, factor};
use crate::model::shaft::SegmentKind;
use crate::sampling::{Rows, Space};

/// What of the stages is needed.
#[derive(Clone, Copy)]
pub(crate) struct Wanted {
    pub map: bool,
    pub every_criterion: bool,
    pub pin_force: bool,
    /// Whether every variant is to be looked at alone.
    pub one_by_one: bool,
}

/// A study's stages, with what of them is computed before any variant.
pub(crate) struct Stages {
    geometry: Precomputed<Geometry>,
    map: Precomputed<Map>,
    shaft: Precomputed<Shaft>,
    pin: Precomputed<PinBending>,
    rating: Precomputed<Rating>,
    /// What of the shaft is computed beforehand where the whole is not.
    plan: ShaftPlan,
    /// Axes that a stage computed for every variant reads: number and input.
    open_axes: Vec<(usize, usize)>,
    /// The criterion's code, unless it varies.
    criterion: Option<f64>,
}

/// A thread's working memory for one block.
pub(crate) struct Scratch {
    inputs: InputLanes,
    /// The inputs of a variant looked at alone.
    alone: Inputs,
    geometry: OutcomeBlock<Geometry>,
    map_parts: MapParts,
    map: OutcomeBlock<Map>,
    shaft: OutcomeBlock<Shaft>,
    pin: OutcomeBlock<PinBending>,
    rating: OutcomeBlock<Rating>,
    assembly: Box<AssemblyBlock>,
}

impl Stages {
    /// Computes what can be computed before any variant.
    pub(crate) fn new(space: &Space, base: &Inputs, kinds: &[SegmentKind]) -> Self {
        let axes = space.axes();
        let of_inputs = |inputs: &[Input]| inputs.iter().map(|i| *i as usize).collect();
        let mut shaft_inputs: Vec<usize> = of_inputs(&Shaft::INPUTS);
        shaft_inputs.extend(SCALARS..SCALARS + SEGMENT_FIELDS.len() * kinds.len());
        let mut geometry_inputs: Vec<usize> = of_inputs(&Geometry::INPUTS);
        geometry_inputs.extend(base.flange_input());
        let map_inputs: Vec<usize> = of_inputs(&Map::INPUTS);
        let pin_inputs: Vec<usize> = of_inputs(&PinBending::INPUTS);
        let rating_inputs: Vec<usize> = of_inputs(&Rating::INPUTS);
        let varies = |input| axes.iter().any(|axis| axis.input == input);
        let plan = ShaftPlan::new(kinds, base, varies);
        let needs_stiffness = plan.is_empty();
        let mut stages = Stages {
            geometry: Precomputed::of(space, base, &geometry_inputs, &geometry),
            map: Precomputed::of(space, base, &map_inputs, &|inputs| {
                map(inputs, Criteria::ALL)
            }),
            shaft: Precomputed::of(space, base, &shaft_inputs, &|inputs| shaft(inputs, &plan)),
            pin: Precomputed::of(space, base, &pin_inputs, &pin),
            rating: Precomputed::of(space, base, &rating_inputs, &|inputs| {
                rating(inputs, needs_stiffness)
            }),
            open_axes: Vec::new(),
            plan,
            criterion: (!varies(Input::Criterion as usize)).then(|| base.get(Input::Criterion)),
        };
        for (number, axis) in axes.iter().enumerate() {
            let reads = |open: bool, inputs: &[usize]| open && inputs.contains(&axis.input);
            if reads(stages.geometry.is_open(), &geometry_inputs)
                || reads(stages.map.is_open(), &map_inputs)
                || reads(stages.shaft.is_open(), &shaft_inputs)
                || reads(stages.pin.is_open(), &pin_inputs)
                || reads(stages.rating.is_open(), &rating_inputs)
            {
                stages.open_axes.push((number, axis.input));
            }
        }
        stages
    }

    /// Working memory for a block of a study with these unvaried inputs.
    pub(crate) fn scratch(&self, base: &Inputs) -> Scratch {
        Scratch {
            inputs: InputLanes::new(base),
            alone: base.clone(),
            geometry: self.geometry.block(),
            map_parts: MapParts::new(),
            map: self.map.block(),
            shaft: self.shaft.block(),
            pin: self.pin.block(),
            rating: self.rating.block(),
            assembly: Assembly::NONE.block(),
        }
    }

    /// Stages and assembly of one block, and the status that follows from them; `fill` writes the
    /// values of an axis, in the user's unit.
    #[inline(always)]
    pub(crate) fn evaluate(
        &self,
        rows: Rows<'_>,
        fill: impl Fn(usize, &mut [f64]),
        wanted: Wanted,
        scratch: &mut Scratch,
        status: &mut [u8],
    ) {
        let len = status.len();
        self.geometry.look_up(rows, len, &mut scratch.geometry);
        self.map.look_up(rows, len, &mut scratch.map);
        self.shaft.look_up(rows, len, &mut scratch.shaft);
        self.pin.look_up(rows, len, &mut scratch.pin);
        self.rating.look_up(rows, len, &mut scratch.rating);
        if !self.open_axes.is_empty() {
            for (axis, input) in &self.open_axes {
                let lanes = scratch.inputs.at_mut(*input);
                fill(*axis, &mut lanes[..len]);
                let factor = factor(*input);
                if factor != 1.0 {
                    for value in lanes {
                        *value *= factor;
                    }
                }
            }
            self.compute(wanted, scratch, len);
        }
        Block {
            geometry: &scratch.geometry.values,
            map: &scratch.map.values,
            shaft: &scratch.shaft.values,
            pin: &scratch.pin.values,
            rating: &scratch.rating.values,
        }
        .assemble(&mut scratch.assembly);
        for (row, status) in status.iter_mut().enumerate() {
            *status = scratch.geometry.statuses[row]
                .or(scratch.map.statuses[row])
                .or(scratch.shaft.statuses[row])
                .or(scratch.pin.statuses[row])
                .or(scratch.rating.statuses[row]) as u8;
        }
    }

    /// Computes the open stages of a block.
    #[inline(always)]
    fn compute(&self, wanted: Wanted, scratch: &mut Scratch, len: usize) {
        let mut mask: Mask = [u64::from(!wanted.one_by_one); BLOCK];
        let inputs = &mut scratch.inputs;
        if self.geometry.is_open() {
            inputs.find_half_pitch_sines();
            let out = scratch.geometry.open();
            for_each_lane!(inputs, mask, |row, lane, checks| {
                Geometry::of(lane, checks).put(out, row);
            });
        }
        if self.map.is_open() {
            let needed = criteria(wanted, self.criterion);
            let (parts, out) = (&mut scratch.map_parts, scratch.map.open());
            Map::compute_block(inputs, needed, parts, out, &mut mask);
        }
        if self.shaft.is_open() {
            let out = scratch.shaft.open();
            self.plan
                .compliances(inputs, &mut mask, &mut out.compliance);
        }
        if self.pin.is_open() {
            let out = scratch.pin.open();
            for_each_lane!(inputs, mask, |row, lane, checks| {
                PinBending::of(lane, checks).put(out, row);
            });
        }
        if self.rating.is_open() {
            let out = scratch.rating.open();
            let needs_stiffness = self.plan.is_empty();
            for_each_lane!(inputs, mask, |row, lane, checks| {
                Rating::of(lane, needs_stiffness, checks).put(out, row);
            });
        }
        if mask[..len].iter().fold(1, |all, holds| all & holds) == 0 {
            for (row, holds) in mask[..len].iter().enumerate() {
                if *holds == 0 {
                    self.compute_alone(wanted, scratch, row);
                }
            }
        }
    }

    /// Computes the open stages of one variant, with the reason where it is refused.
    #[inline(never)]
    fn compute_alone(&self, wanted: Wanted, scratch: &mut Scratch, row: usize) {
        let Scratch { inputs, alone, .. } = scratch;
        for (_, input) in &self.open_axes {
            alone.set(*input, inputs.at(*input, row));
        }
        if self.geometry.is_open() {
            scratch.geometry.put(geometry(alone).into(), row);
        }
        if self.map.is_open() {
            let needed = criteria(wanted, Some(alone.get(Input::Criterion)));
            scratch.map.put(map(alone, needed).into(), row);
        }
        if self.shaft.is_open() {
            scratch.shaft.put(shaft(alone, &self.plan).into(), row);
        }
        if self.pin.is_open() {
            scratch.pin.put(pin(alone).into(), row);
        }
        if self.rating.is_open() {
            let needs_stiffness = self.plan.is_empty();
            scratch
                .rating
                .put(rating(alone, needs_stiffness).into(), row);
        }
    }
}

impl Scratch {
    /// Writes one column of the block's first variants.
    #[inline(always)]
    pub(crate) fn write(&self, output: Output, loads: &[f64], out: &mut [f64]) {
        Block {
            geometry: &self.geometry.values,
            map: &self.map.values,
            shaft: &self.shaft.values,
            pin: &self.pin.values,
            rating: &self.rating.values,
        }
        .write(&self.assembly, output, loads, out);
    }
}

/// The criteria whose figures are needed where the chosen one has this code, if it is known.
fn criteria(wanted: Wanted, code: Option<f64>) -> Criteria {
    match (wanted.map, code) {
        (false, _) => Criteria::NONE,
        (true, None) => Criteria::ALL,
        (true, Some(code)) => Criteria::of(code, wanted.every_criterion, wanted.pin_force),
    }
}

fn geometry(inputs: &Inputs) -> Result<Geometry, DesignError> {
    checked(|checks| Geometry::of(inputs, checks))
}

fn map(inputs: &Inputs, needed: Criteria) -> Result<Map, DesignError> {
    checked(|checks| Map::of(inputs, needed, checks))
}

fn shaft(inputs: &Inputs, plan: &ShaftPlan) -> Result<Shaft, DesignError> {
    checked(|checks| plan.compliance(inputs, checks)).map(|compliance| Shaft { compliance })
}

fn pin(inputs: &Inputs) -> Result<PinBending, DesignError> {
    checked(|checks| PinBending::of(inputs, checks))
}

fn rating(inputs: &Inputs, needs_stiffness: bool) -> Result<Rating, DesignError> {
    checked(|checks| Rating::of(inputs, needs_stiffness, checks))
}

/// Why a design cannot be built: the first reason of its stages, in their order.
pub(crate) fn explained(inputs: &Inputs, kinds: &[SegmentKind]) -> Option<DesignError> {
    let plan = ShaftPlan::open(kinds);
    geometry(inputs)
        .and_then(|_| map(inputs, Criteria::NONE))
        .and_then(|_| shaft(inputs, &plan))
        .and_then(|_| pin(inputs))
        .and_then(|_| rating(inputs, plan.is_empty()))
        .err()
}
