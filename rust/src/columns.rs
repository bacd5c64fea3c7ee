//! A study's variants to columns of results, in parallel; the only rayon in the crate.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::error::{DesignError, Status};
use crate::inputs::{Input, Inputs, SCALARS, SEGMENT_FIELDS, factor};
use crate::known::{Known, filed};
use crate::outputs::{Assembly, Block, Output};
use crate::shaft::SegmentKind;
use crate::shaft_plan::ShaftPlan;
use crate::space::{Rows, Space};
use crate::stages::{Geometry, Map, PinBending, Rating, Shaft, Stage};

/// Variants computed together: their stages stay in the cache.
pub(crate) const BLOCK: usize = 128;
/// Variants a thread takes at a time.
const TASK: usize = 32 * BLOCK;

/// What a limit of a study looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limited {
    /// An input, by position.
    Input(usize),
    /// A result.
    Output(Output),
}

/// A range that a variant must keep, in the column's own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The column.
    pub column: Limited,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

/// The columns of a stretch of variants. Refused variants have NaN in every one.
#[derive(Debug, Clone, Default)]
pub struct Columns {
    /// Code of [`Status`], or `Status::ALL.len()` + number of the limit that is broken.
    pub status: Vec<u8>,
    /// True when any variant is refused.
    pub any_refused: bool,
    /// One column an asked output.
    pub values: Vec<Vec<f64>>,
}

struct Stages {
    geometry: Known<Geometry>,
    map: Known<Map>,
    shaft: Known<Shaft>,
    pin: Known<PinBending>,
    rating: Known<Rating>,
    /// What of the shaft is known where the whole is not.
    plan: ShaftPlan,
    /// Axes that a stage computed for every variant reads: number and input.
    open_axes: Vec<(usize, usize)>,
}

/// The definition of a study, ready to evaluate.
pub struct Study {
    space: Space,
    base: Inputs,
    kinds: Vec<SegmentKind>,
    loads: Vec<f64>,
    limits: Vec<Limit>,
    stages: OnceLock<Stages>,
    evaluated: AtomicU64,
}

/// What of the stages is needed.
#[derive(Clone, Copy)]
struct Wanted {
    map: bool,
    every_criterion: bool,
}

/// A stretch of the result columns that one thread writes.
struct Task<'a> {
    first: usize,
    status: &'a mut [u8],
    values: Vec<&'a mut [f64]>,
}

/// A thread's working memory for one block.
struct Scratch {
    /// Values of each axis, in the core's unit.
    axes: Vec<[f64; BLOCK]>,
    /// The inputs of the variant at hand.
    inputs: Inputs,
    geometry: [Geometry; BLOCK],
    map: [Map; BLOCK],
    shaft: [Shaft; BLOCK],
    pin: [PinBending; BLOCK],
    rating: [Rating; BLOCK],
    assembly: [Assembly; BLOCK],
}

impl Study {
    /// A study of a base design (core units, all inputs in order) varied over `space`.
    ///
    /// # Panics
    /// When `base` does not hold every input of a design with these segments, or an axis names
    /// an input beyond them; the bindings check both.
    #[must_use]
    pub fn new(
        space: Space,
        base: Vec<f64>,
        kinds: Vec<SegmentKind>,
        loads: Vec<f64>,
        limits: Vec<Limit>,
    ) -> Self {
        assert_eq!(base.len(), SCALARS + SEGMENT_FIELDS.len() * kinds.len());
        assert!(space.axes().iter().all(|axis| axis.input < base.len()));
        let base = Inputs::new(&base);
        let (stages, evaluated) = (OnceLock::new(), AtomicU64::new(0));
        Self {
            space,
            base,
            kinds,
            loads,
            limits,
            stages,
            evaluated,
        }
    }

    /// The space of variants.
    #[must_use]
    pub const fn space(&self) -> &Space {
        &self.space
    }

    /// Loads, in nominal torques, at which twists are computed.
    #[must_use]
    pub fn loads(&self) -> &[f64] {
        &self.loads
    }

    /// Number of shaft segments.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.kinds.len()
    }

    /// How many variants the kernel has evaluated since the study was made.
    #[must_use]
    pub fn evaluated(&self) -> u64 {
        self.evaluated.load(Ordering::Relaxed)
    }

    /// Values of one axis for `len` variants, in the user's unit.
    #[must_use]
    pub fn axis_values(&self, axis: usize, rows: Rows<'_>, len: usize) -> Vec<f64> {
        let mut values = vec![0.0; len];
        values
            .par_chunks_mut(TASK)
            .enumerate()
            .for_each(|(task, out)| {
                self.space
                    .fill(axis, part(rows, task * TASK, out.len()), out);
            });
        values
    }

    /// Why one variant cannot be built, with its numbers; limits are not looked at.
    #[must_use]
    pub fn explain(&self, variant: u64) -> Option<DesignError> {
        let mut inputs = self.base.clone();
        for (number, axis) in self.space.axes().iter().enumerate() {
            let mut value = [0.0];
            self.fill_axis(number, axis.input, Rows::At(&[variant]), &mut value);
            inputs.set(axis.input, value[0]);
        }
        let plan = ShaftPlan::open(&self.kinds);
        Geometry::of(&inputs)
            .and_then(|_| Map::check(&inputs))
            .and_then(|_| Shaft::of(&inputs, &plan))
            .and_then(|_| PinBending::of(&inputs))
            .and_then(|_| Rating::of(&inputs, plan.is_empty()))
            .err()
    }

    /// Evaluates `len` variants. Bits do not depend on the number of threads, nor on how a
    /// study is cut.
    #[must_use]
    pub fn evaluate(&self, rows: Rows<'_>, len: usize, outputs: &[Output]) -> Columns {
        let mut status = vec![0; len];
        let mut values: Vec<Vec<f64>> = outputs.iter().map(|_| vec![0.0; len]).collect();
        let slices = values.iter_mut().map(Vec::as_mut_slice).collect();
        let any_refused = self.evaluate_into(rows, outputs, &mut status, slices);
        Columns {
            status,
            any_refused,
            values,
        }
    }

    /// [`Study::evaluate`] into memory of the caller's, one column an output, each as long as
    /// `status`. True when any variant is refused.
    pub fn evaluate_into(
        &self,
        rows: Rows<'_>,
        outputs: &[Output],
        status: &mut [u8],
        values: Vec<&mut [f64]>,
    ) -> bool {
        self.evaluated
            .fetch_add(status.len() as u64, Ordering::Relaxed);
        let stages = self.stages();
        let wanted = self.wanted(outputs);
        tasks(status, values)
            .into_par_iter()
            .map_init(
                || self.scratch(stages),
                |scratch, mut task| {
                    let mut any = false;
                    let len = task.status.len();
                    for from in (0..len).step_by(BLOCK) {
                        let to = (from + BLOCK).min(len);
                        let rows = part(rows, task.first + from, to - from);
                        let status = &mut task.status[from..to];
                        self.stage_block(stages, scratch, rows, wanted, status);
                        any |= self.limit_block(scratch, rows, status);
                        let values = task.values.iter_mut().map(|column| &mut column[from..to]);
                        self.write_block(scratch, outputs, status, values);
                    }
                    any
                },
            )
            .reduce(|| false, |a, b| a | b)
    }

    /// What of the stages the outputs and limits need.
    fn wanted(&self, outputs: &[Output]) -> Wanted {
        let limited = self.limits.iter().filter_map(|limit| match limit.column {
            Limited::Output(output) => Some(output),
            Limited::Input(_) => None,
        });
        let needed = || outputs.iter().copied().chain(limited.clone());
        Wanted {
            map: needed().any(|output| !output.is_free_of_map()),
            every_criterion: needed().any(Output::needs_every_criterion),
        }
    }

    /// Stages of one block and the status that follows from them.
    fn stage_block(
        &self,
        stages: &Stages,
        scratch: &mut Scratch,
        rows: Rows<'_>,
        wanted: Wanted,
        status: &mut [u8],
    ) {
        let len = status.len();
        let Scratch {
            axes,
            inputs,
            geometry,
            map,
            shaft,
            pin,
            rating,
            assembly,
            ..
        } = scratch;
        stages.geometry.look_up(rows, &mut geometry[..len]);
        stages.map.look_up(rows, &mut map[..len]);
        stages.shaft.look_up(rows, &mut shaft[..len]);
        stages.pin.look_up(rows, &mut pin[..len]);
        stages.rating.look_up(rows, &mut rating[..len]);
        if !stages.open_axes.is_empty() {
            for (number, input) in &stages.open_axes {
                self.fill_axis(*number, *input, rows, &mut axes[*number][..len]);
            }
            for row in 0..len {
                for (number, input) in &stages.open_axes {
                    inputs.set(*input, axes[*number][row]);
                }
                if stages.geometry.is_open() {
                    geometry[row] = filed(Geometry::of(inputs));
                }
                if stages.map.is_open() {
                    map[row] = filed(if wanted.map {
                        Map::of(inputs, wanted.every_criterion)
                    } else {
                        Map::check(inputs)
                    });
                }
                if stages.shaft.is_open() {
                    shaft[row] = filed(Shaft::of(inputs, &stages.plan));
                }
                if stages.pin.is_open() {
                    pin[row] = filed(PinBending::of(inputs));
                }
                if stages.rating.is_open() {
                    rating[row] = filed(Rating::of(inputs, stages.plan.is_empty()));
                }
            }
        }
        for (k, status) in status.iter_mut().enumerate() {
            assembly[k] = Assembly::of(&map[k], &shaft[k], &pin[k], &rating[k]);
            *status = geometry[k]
                .status()
                .or(map[k].status())
                .or(shaft[k].status())
                .or(pin[k].status())
                .or(rating[k].status()) as u8;
        }
    }

    /// Files variants outside a limit under that limit. True when any variant is refused.
    fn limit_block(&self, scratch: &mut Scratch, rows: Rows<'_>, status: &mut [u8]) -> bool {
        let len = status.len();
        for (number, limit) in self.limits.iter().enumerate() {
            let mut limited = [0.0; BLOCK];
            let limited = &mut limited[..len];
            let unit = match limit.column {
                Limited::Output(output) => {
                    scratch.block(len).write(output, &self.loads, limited);
                    1.0
                }
                Limited::Input(input) => self.fill_limited(input, rows, limited),
            };
            let range = limit.min * unit..=limit.max * unit;
            for (status, value) in status.iter_mut().zip(limited) {
                if *status == Status::Ok as u8 && !range.contains(value) {
                    *status = (Status::ALL.len() + number) as u8;
                }
            }
        }
        status.iter().any(|status| *status != Status::Ok as u8)
    }

    /// Results of one block, NaN where a variant is refused.
    fn write_block<'a>(
        &self,
        scratch: &Scratch,
        outputs: &[Output],
        status: &[u8],
        values: impl Iterator<Item = &'a mut [f64]>,
    ) {
        let block = scratch.block(status.len());
        let any_refused = status.iter().any(|status| *status != Status::Ok as u8);
        for (output, column) in outputs.iter().zip(values) {
            block.write(*output, &self.loads, column);
            if any_refused {
                for (value, status) in column.iter_mut().zip(status) {
                    if *status != Status::Ok as u8 {
                        *value = f64::NAN;
                    }
                }
            }
        }
    }

    /// Values of an input, whether it varies or not, and what turns the user's unit into theirs:
    /// neither is converted back, which would cost the last digit.
    fn fill_limited(&self, input: usize, rows: Rows<'_>, out: &mut [f64]) -> f64 {
        match self
            .space
            .axes()
            .iter()
            .position(|axis| axis.input == input)
        {
            Some(axis) => {
                self.space.fill(axis, rows, out);
                1.0
            }
            None => {
                out.fill(self.base.at(input));
                factor(input)
            }
        }
    }

    /// Values of an axis in the core's unit.
    fn fill_axis(&self, axis: usize, input: usize, rows: Rows<'_>, out: &mut [f64]) {
        self.space.fill(axis, rows, out);
        let factor = factor(input);
        if factor != 1.0 {
            for value in out {
                *value *= factor;
            }
        }
    }

    fn scratch(&self, stages: &Stages) -> Scratch {
        Scratch {
            axes: vec![[0.0; BLOCK]; self.space.axes().len()],
            inputs: self.base.clone(),
            geometry: stages.geometry.block(),
            map: stages.map.block(),
            shaft: stages.shaft.block(),
            pin: stages.pin.block(),
            rating: stages.rating.block(),
            assembly: [Assembly::NONE; BLOCK],
        }
    }

    /// What of each stage is known before any variant: computed once, on first use.
    fn stages(&self) -> &Stages {
        self.stages.get_or_init(|| {
            let axes = self.space.axes();
            let of_inputs = |inputs: &[Input]| inputs.iter().map(|i| *i as usize).collect();
            let mut shaft_inputs: Vec<usize> = of_inputs(&Shaft::INPUTS);
            shaft_inputs.extend(SCALARS..SCALARS + SEGMENT_FIELDS.len() * self.kinds.len());
            let geometry_inputs: Vec<usize> = of_inputs(&Geometry::INPUTS);
            let map_inputs: Vec<usize> = of_inputs(&Map::INPUTS);
            let pin_inputs: Vec<usize> = of_inputs(&PinBending::INPUTS);
            let rating_inputs: Vec<usize> = of_inputs(&Rating::INPUTS);
            let varies = |input| axes.iter().any(|axis| axis.input == input);
            let plan = ShaftPlan::new(&self.kinds, &self.base, varies);
            let (space, base, needs_stiffness) = (&self.space, &self.base, plan.is_empty());
            let mut stages = Stages {
                geometry: Known::of(space, base, &geometry_inputs, &Geometry::of),
                map: Known::of(space, base, &map_inputs, &|inputs| Map::of(inputs, true)),
                shaft: Known::of(space, base, &shaft_inputs, &|inputs| {
                    Shaft::of(inputs, &plan)
                }),
                pin: Known::of(space, base, &pin_inputs, &PinBending::of),
                rating: Known::of(space, base, &rating_inputs, &|inputs| {
                    Rating::of(inputs, needs_stiffness)
                }),
                open_axes: Vec::new(),
                plan,
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
        })
    }
}

impl Scratch {
    /// The first `len` rows.
    fn block(&self, len: usize) -> Block<'_> {
        Block {
            geometry: &self.geometry[..len],
            map: &self.map[..len],
            shaft: &self.shaft[..len],
            pin: &self.pin[..len],
            rating: &self.rating[..len],
            assembly: &self.assembly[..len],
        }
    }
}

/// The result columns cut into stretches, one a task.
fn tasks<'a>(status: &'a mut [u8], values: Vec<&'a mut [f64]>) -> Vec<Task<'a>> {
    let mut tasks: Vec<Task<'a>> = status
        .chunks_mut(TASK)
        .enumerate()
        .map(|(k, status)| Task {
            first: k * TASK,
            status,
            values: Vec::with_capacity(values.len()),
        })
        .collect();
    for column in values {
        for (task, part) in tasks.iter_mut().zip(column.chunks_mut(TASK)) {
            task.values.push(part);
        }
    }
    tasks
}

/// Rows `first .. first + len` of the rows asked for.
fn part(rows: Rows<'_>, first: usize, len: usize) -> Rows<'_> {
    match rows {
        Rows::From(start) => Rows::From(start + first as u64),
        Rows::At(indices) => Rows::At(&indices[first..first + len]),
    }
}
