//! A study's variants to columns of results, in parallel; the only rayon in the crate.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use crate::active_pins::Criterion;
use crate::blocks::{Scratch, Stages, Wanted, explained};
use crate::error::{DesignError, Status};

use crate::inputs::{Input, Inputs, SCALARS, SEGMENT_FIELDS, factor};
use crate::lanes::{BLOCK, Wide, with_widest};
use crate::outputs::Output;
use crate::shaft::SegmentKind;
use crate::space::{Rows, Space};

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

/// Why a study cannot be.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StudyError {
    /// A load is no number.
    #[error("loads_tn: found {load}, expected finite numbers")]
    LoadNotFinite {
        /// The load found.
        load: f64,
    },
    /// The base design lacks inputs, or has too many.
    #[error("a design with this shaft has {expected} inputs, found {found}")]
    InputCount {
        /// How many there are to be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// An axis or a limit is on an input that the design does not have.
    #[error("no input number {input} in a design of {inputs} inputs")]
    NoSuchInput {
        /// Place of the input.
        input: usize,
        /// Inputs of the design.
        inputs: usize,
    },
    /// A limit is on the twist at a load that the study does not have.
    #[error("no load number {load} in a study of {loads} loads")]
    NoSuchLoad {
        /// Place of the load.
        load: usize,
        /// Loads of the study.
        loads: usize,
    },
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

/// How variants are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Path {
    Blocks,
    OneByOne,
}

/// A stretch of the result columns that one thread writes.
struct Task<'a> {
    first: usize,
    status: &'a mut [u8],
    values: Vec<&'a mut [f64]>,
}

impl std::fmt::Debug for Study {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Study")
            .field("space", &self.space)
            .field("base", &self.base)
            .field("kinds", &self.kinds)
            .field("loads", &self.loads)
            .field("limits", &self.limits)
            .finish_non_exhaustive()
    }
}

impl Study {
    /// A study of a base design (core units, all inputs in order) varied over `space`.
    ///
    /// # Errors
    /// [`StudyError`] when `base` does not hold every input of a design with these segments, an axis
    /// or a limit is on an input or a load beyond them, or a load is no number.
    pub fn new(
        space: Space,
        base: Vec<f64>,
        kinds: Vec<SegmentKind>,
        loads: Vec<f64>,
        limits: Vec<Limit>,
    ) -> Result<Self, StudyError> {
        let inputs = SCALARS + SEGMENT_FIELDS.len() * kinds.len();
        if base.len() != inputs {
            return Err(StudyError::InputCount {
                expected: inputs,
                found: base.len(),
            });
        }
        let limited = limits.iter().filter_map(|limit| match limit.column {
            Limited::Input(input) => Some(input),
            Limited::Output(_) => None,
        });
        let mut named = space.axes().iter().map(|axis| axis.input).chain(limited);
        if let Some(input) = named.find(|input| *input >= inputs) {
            return Err(StudyError::NoSuchInput { input, inputs });
        }
        for limit in &limits {
            if let Limited::Output(Output::Twist(load)) = limit.column
                && load >= loads.len()
            {
                let loads = loads.len();
                return Err(StudyError::NoSuchLoad { load, loads });
            }
        }
        if let Some(load) = loads.iter().find(|load| !load.is_finite()) {
            return Err(StudyError::LoadNotFinite { load: *load });
        }
        let base = Inputs::new(&base, &kinds);
        let (stages, evaluated) = (OnceLock::new(), AtomicU64::new(0));
        Ok(Self {
            space,
            base,
            kinds,
            loads,
            limits,
            stages,
            evaluated,
        })
    }

    /// Whether a column may be NaN for a variant that can be built: without an inertia or a shaft,
    /// and what rests on statics for more than two discs.
    #[must_use]
    pub fn may_not_apply(&self, output: Output) -> bool {
        let axes = self.space.axes();
        let may_be = |input: Input, is: fn(f64) -> bool| {
            let varies = axes.iter().any(|axis| axis.input == input as usize);
            varies || is(self.base.get(input))
        };
        let beyond_statics = may_be(Input::DiscCount, |discs| discs > 2.0);
        let by_statics = may_be(Input::Criterion, |code| {
            code >= f64::from(Criterion::Statics as u8)
        });
        match output {
            Output::ShaftCompliance => self.kinds.is_empty(),
            Output::PinParticipationStatics | Output::OutputComplianceStatics => beyond_statics,
            Output::NaturalFrequency | Output::NaturalFrequencyWithEfficiency => {
                may_be(Input::InputInertia, f64::is_nan) || (beyond_statics && by_statics)
            }
            Output::OutputCompliance
            | Output::ReflectedCompliance
            | Output::ReflectedStiffness
            | Output::OutputStiffness
            | Output::Twist(_) => beyond_statics && by_statics,
            _ => false,
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
        self.axes_into(&[axis], rows, vec![&mut values]);
        values
    }

    /// Values of some axes, in the user's unit, into memory of the caller's: one column an axis,
    /// all of a length.
    pub fn axes_into(&self, axes: &[usize], rows: Rows<'_>, values: Vec<&mut [f64]>) {
        let (space, mut nothing) = (&self.space, Vec::new());
        nothing.resize(values.first().map_or(0, |column| column.len()), 0);
        tasks(&mut nothing, values)
            .into_par_iter()
            .for_each(|task| {
                with_widest(AxesWork {
                    space,
                    axes,
                    rows,
                    task,
                })
            });
    }

    /// Why one variant cannot be built, with its numbers; limits are not looked at.
    #[must_use]
    pub fn explain(&self, variant: u64) -> Option<DesignError> {
        let mut inputs = self.base.clone();
        for (number, axis) in self.space.axes().iter().enumerate() {
            let mut value = [0.0];
            self.space.fill(number, Rows::At(&[variant]), &mut value);
            inputs.set(axis.input, value[0] * factor(axis.input));
        }
        explained(&inputs, &self.kinds)
    }

    /// Evaluates `len` variants. Bits do not depend on the number of threads, nor on how a
    /// study is cut.
    #[must_use]
    pub fn evaluate(&self, rows: Rows<'_>, len: usize, outputs: &[Output]) -> Columns {
        self.columns(rows, len, outputs, Path::Blocks)
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
        self.run(rows, outputs, status, values, Path::Blocks)
    }

    /// [`Study::evaluate`] the slow way, for tests: every variant alone, without the machine's own
    /// vector instructions. The bits are the same.
    #[must_use]
    pub fn evaluate_one_by_one(&self, rows: Rows<'_>, len: usize, outputs: &[Output]) -> Columns {
        self.columns(rows, len, outputs, Path::OneByOne)
    }

    fn columns(&self, rows: Rows<'_>, len: usize, outputs: &[Output], path: Path) -> Columns {
        let mut status = vec![0; len];
        let mut values: Vec<Vec<f64>> = outputs.iter().map(|_| vec![0.0; len]).collect();
        let slices = values.iter_mut().map(Vec::as_mut_slice).collect();
        let any_refused = self.run(rows, outputs, &mut status, slices, path);
        Columns {
            status,
            any_refused,
            values,
        }
    }

    fn run(
        &self,
        rows: Rows<'_>,
        outputs: &[Output],
        status: &mut [u8],
        values: Vec<&mut [f64]>,
        path: Path,
    ) -> bool {
        self.evaluated
            .fetch_add(status.len() as u64, Ordering::Relaxed);
        let stages = self
            .stages
            .get_or_init(|| Stages::new(&self.space, &self.base, &self.kinds));
        let wanted = self.wanted(outputs, path);
        let work = |scratch: &mut Scratch, task: Task<'_>| {
            let work = TaskWork {
                study: self,
                stages,
                wanted,
                outputs,
                rows: part(rows, task.first, task.status.len()),
                scratch,
                task,
            };
            match path {
                Path::Blocks => with_widest(work),
                Path::OneByOne => work.run(),
            }
        };
        tasks(status, values)
            .into_par_iter()
            .map_init(|| stages.scratch(&self.base), work)
            .reduce(|| false, |a, b| a | b)
    }

    /// What of the stages the outputs and limits need.
    fn wanted(&self, outputs: &[Output], path: Path) -> Wanted {
        let limited = self.limits.iter().filter_map(|limit| match limit.column {
            Limited::Output(output) => Some(output),
            Limited::Input(_) => None,
        });
        let needed = || outputs.iter().copied().chain(limited.clone());
        Wanted {
            map: needed().any(|output| !output.is_free_of_map()),
            every_criterion: needed().any(Output::needs_every_criterion),
            pin_force: needed().any(Output::needs_pin_force),
            one_by_one: path == Path::OneByOne,
        }
    }

    /// Files variants outside a limit under that limit.
    fn limit_block(&self, scratch: &mut Scratch, rows: Rows<'_>, status: &mut [u8]) {
        for (number, limit) in self.limits.iter().enumerate() {
            let mut limited = [0.0; BLOCK];
            let limited = &mut limited[..status.len()];
            let unit = match limit.column {
                Limited::Output(output) => {
                    scratch.write(output, &self.loads, limited);
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
}

/// Axes of one task.
struct AxesWork<'a> {
    space: &'a Space,
    axes: &'a [usize],
    rows: Rows<'a>,
    task: Task<'a>,
}

impl Wide for AxesWork<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let rows = part(self.rows, self.task.first, self.task.status.len());
        for (axis, column) in self.axes.iter().zip(self.task.values) {
            self.space.fill(*axis, rows, column);
        }
    }
}

/// Everything that one task needs.
struct TaskWork<'a> {
    study: &'a Study,
    stages: &'a Stages,
    wanted: Wanted,
    outputs: &'a [Output],
    rows: Rows<'a>,
    scratch: &'a mut Scratch,
    task: Task<'a>,
}

impl Wide for TaskWork<'_> {
    /// Whether any variant is refused.
    type Output = bool;

    #[inline(always)]
    fn run(mut self) -> bool {
        let mut any_refused = false;
        let len = self.task.status.len();
        for from in (0..len).step_by(BLOCK) {
            let to = (from + BLOCK).min(len);
            let rows = part(self.rows, from, to - from);
            let status = &mut self.task.status[from..to];
            self.stages
                .evaluate(&self.study.space, rows, self.wanted, self.scratch, status);
            if !self.study.limits.is_empty() {
                self.study.limit_block(self.scratch, rows, status);
            }
            let refused = status.iter().fold(0, |any, status| any | status) != Status::Ok as u8;
            any_refused |= refused;
            for (output, column) in self.outputs.iter().zip(&mut self.task.values) {
                let column = &mut column[from..to];
                self.scratch.write(*output, &self.study.loads, column);
                if refused {
                    for (value, status) in column.iter_mut().zip(&*status) {
                        if *status != Status::Ok as u8 {
                            *value = f64::NAN;
                        }
                    }
                }
            }
        }
        any_refused
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
