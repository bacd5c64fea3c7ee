//! A study's variants to columns of results, in parallel; the only rayon beside the tables.

use std::sync::atomic::Ordering;

use rayon::prelude::*;

use crate::kernel::blocks::{Scratch, Stages, Wanted};
use crate::kernel::columns::{Source, Target, Task, check_shape, part, reals, tasks};
use crate::kernel::lanes::BLOCK;
use crate::kernel::outputs::Output;
use crate::kernel::study::{Limited, Study, StudyError};
use crate::model::error::Status;
use crate::model::inputs::factor;
use crate::sampling::{Rows, Space};
use crate::wide::{Wide, with_widest};

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

/// How variants are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Path {
    Blocks,
    OneByOne,
}

impl Study {
    /// Values of one axis for `len` variants, in the user's unit.
    ///
    /// # Errors
    /// [`StudyError`] for an axis or variants that the study does not have.
    pub fn axis_values(
        &self,
        axis: usize,
        rows: Rows<'_>,
        len: usize,
    ) -> Result<Vec<f64>, StudyError> {
        self.check_rows(rows, len)?;
        let mut values = vec![0.0; len];
        self.axes_into(&[axis], rows, vec![&mut values])?;
        Ok(values)
    }

    /// Values of some axes, in the user's unit, into memory of the caller's: one column an axis,
    /// all of a length.
    ///
    /// # Errors
    /// [`StudyError`] for an axis or variants that the study does not have, or columns that differ
    /// in length.
    pub fn axes_into(
        &self,
        axes: &[usize],
        rows: Rows<'_>,
        values: Vec<&mut [f64]>,
    ) -> Result<(), StudyError> {
        for axis in axes {
            self.check_axis(*axis)?;
        }
        let (space, mut nothing) = (&self.space, Vec::new());
        nothing.resize(values.first().map_or(0, |column| column.len()), 0);
        self.check_rows(rows, nothing.len())?;
        let targets = reals(values);
        check_shape(axes.len(), nothing.len(), &targets)?;
        let sources: Vec<Source> = axes.iter().copied().map(Source::Axis).collect();
        let sources = sources.as_slice();
        tasks(&mut nothing, targets)
            .into_par_iter()
            .for_each(|task| {
                with_widest(AxesWork {
                    space,
                    sources,
                    rows,
                    task,
                })
            });
        Ok(())
    }

    /// Evaluates `len` variants. Bits do not depend on the number of threads, nor on how a
    /// study is cut.
    ///
    /// # Errors
    /// [`StudyError`] for variants or loads that the study does not have.
    pub fn evaluate(
        &self,
        rows: Rows<'_>,
        len: usize,
        outputs: &[Output],
    ) -> Result<Columns, StudyError> {
        self.columns(rows, len, outputs, Path::Blocks)
    }

    /// [`Study::evaluate`] into memory of the caller's, one column an output, each as long as
    /// `status`. True when any variant is refused.
    ///
    /// # Errors
    /// [`StudyError`] for variants or loads that the study does not have, or memory of another
    /// shape.
    pub fn evaluate_into(
        &self,
        rows: Rows<'_>,
        outputs: &[Output],
        status: &mut [u8],
        values: Vec<&mut [f64]>,
    ) -> Result<bool, StudyError> {
        let sources: Vec<Source> = outputs.iter().copied().map(Source::Output).collect();
        self.run(rows, &sources, status, reals(values), Path::Blocks)
    }

    /// [`Study::evaluate_into`] for a table: axes beside results, counts as such. True when any
    /// variant is refused.
    ///
    /// # Errors
    /// As [`Study::evaluate_into`], and for an axis that the study does not have.
    pub fn table_into(
        &self,
        rows: Rows<'_>,
        sources: &[Source],
        status: &mut [u8],
        targets: Vec<Target<'_>>,
    ) -> Result<bool, StudyError> {
        self.run(rows, sources, status, targets, Path::Blocks)
    }

    /// [`Study::evaluate`] the slow way, for tests: every variant alone, without the machine's own
    /// vector instructions. The bits are the same.
    ///
    /// # Errors
    /// As [`Study::evaluate`].
    pub fn evaluate_one_by_one(
        &self,
        rows: Rows<'_>,
        len: usize,
        outputs: &[Output],
    ) -> Result<Columns, StudyError> {
        self.columns(rows, len, outputs, Path::OneByOne)
    }

    fn columns(
        &self,
        rows: Rows<'_>,
        len: usize,
        outputs: &[Output],
        path: Path,
    ) -> Result<Columns, StudyError> {
        self.check_rows(rows, len)?;
        let mut status = vec![0; len];
        let mut values: Vec<Vec<f64>> = outputs.iter().map(|_| vec![0.0; len]).collect();
        let targets = values.iter_mut().map(|column| Target::Real(column));
        let sources: Vec<Source> = outputs.iter().copied().map(Source::Output).collect();
        let any_refused = self.run(rows, &sources, &mut status, targets.collect(), path)?;
        Ok(Columns {
            status,
            any_refused,
            values,
        })
    }

    fn run(
        &self,
        rows: Rows<'_>,
        sources: &[Source],
        status: &mut [u8],
        targets: Vec<Target<'_>>,
        path: Path,
    ) -> Result<bool, StudyError> {
        self.check_rows(rows, status.len())?;
        check_shape(sources.len(), status.len(), &targets)?;
        for source in sources {
            match source {
                Source::Axis(axis) => self.check_axis(*axis)?,
                Source::Output(output) => self.check_load(*output)?,
            }
        }
        self.evaluated
            .fetch_add(status.len() as u64, Ordering::Relaxed);
        let stages = self
            .stages
            .get_or_init(|| Stages::new(&self.space, &self.base, &self.kinds));
        let wanted = self.wanted(sources, path);
        let work = |scratch: &mut Scratch, task: Task<'_>| {
            let work = TaskWork {
                study: self,
                stages,
                wanted,
                sources,
                rows: part(rows, task.first, task.status.len()),
                scratch,
                task,
            };
            match path {
                Path::Blocks => with_widest(work),
                Path::OneByOne => work.run(),
            }
        };
        Ok(tasks(status, targets)
            .into_par_iter()
            .map_init(|| stages.scratch(&self.base), work)
            .reduce(|| false, |a, b| a | b))
    }

    /// Requires an axis of this study.
    fn check_axis(&self, axis: usize) -> Result<(), StudyError> {
        let axes = self.space.axes().len();
        if axis < axes {
            Ok(())
        } else {
            Err(StudyError::NoSuchAxis { axis, axes })
        }
    }

    /// Requires rows of this study, `len` of them.
    fn check_rows(&self, rows: Rows<'_>, len: usize) -> Result<(), StudyError> {
        let variants = self.space.len();
        let last = match rows {
            Rows::From(start) => start.saturating_add(len as u64),
            Rows::At(indices) if indices.len() != len => {
                return Err(StudyError::Shape {
                    expected: indices.len(),
                    found: len,
                });
            }
            Rows::At(indices) => indices
                .iter()
                .max()
                .map_or(0, |last| last.saturating_add(1)),
        };
        if last > variants {
            return Err(StudyError::NoSuchVariant { last, variants });
        }
        Ok(())
    }

    /// What of the stages the outputs and limits need.
    fn wanted(&self, sources: &[Source], path: Path) -> Wanted {
        let outputs = sources.iter().filter_map(|source| match source {
            Source::Output(output) => Some(*output),
            Source::Axis(_) => None,
        });
        let limited = self.limits.iter().filter_map(|limit| match limit.column {
            Limited::Output(output) => Some(output),
            Limited::Input(_) => None,
        });
        let needed = || outputs.clone().chain(limited.clone());
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
    sources: &'a [Source],
    rows: Rows<'a>,
    task: Task<'a>,
}

impl Wide for AxesWork<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let len = self.task.status.len();
        let rows = part(self.rows, self.task.first, len);
        for from in (0..len).step_by(BLOCK) {
            let to = (from + BLOCK).min(len);
            let rows = part(rows, from, to - from);
            self.task
                .write_axes(self.space, self.sources, rows, from..to);
        }
    }
}

/// Everything that one task needs.
struct TaskWork<'a> {
    study: &'a Study,
    stages: &'a Stages,
    wanted: Wanted,
    sources: &'a [Source],
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
            let (space, sources) = (&self.study.space, self.sources);
            self.task.write_axes(space, sources, rows, from..to);
            let targets = &self.task.targets;
            let fill = |axis: usize, lanes: &mut [f64]| {
                let written = sources.iter().position(|s| *s == Source::Axis(axis));
                match written {
                    Some(place) => targets[place].read(from, lanes),
                    None => space.fill(axis, rows, lanes),
                }
            };
            let status = &mut self.task.status[from..to];
            self.stages
                .evaluate(rows, fill, self.wanted, self.scratch, status);
            self.study.train_block(rows, status);
            if !self.study.limits.is_empty() {
                self.study.limit_block(self.scratch, rows, status);
            }
            let refused = status.iter().fold(0, |any, status| any | status) != Status::Ok as u8;
            any_refused |= refused;
            for (source, target) in self.sources.iter().zip(&mut self.task.targets) {
                let Source::Output(output) = *source else {
                    continue;
                };
                target.write(from..to, |column| {
                    self.scratch.write(output, &self.study.loads, column);
                    if refused {
                        for (value, status) in column.iter_mut().zip(&*status) {
                            if *status != Status::Ok as u8 {
                                *value = f64::NAN;
                            }
                        }
                    }
                });
            }
        }
        any_refused
    }
}
