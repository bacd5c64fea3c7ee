//! A study's variants to columns of results, in parallel; the only rayon beside the tables.

use std::sync::atomic::Ordering;

use rayon::prelude::*;

use crate::kernel::blocks::{Scratch, Stages, Wanted};
use crate::kernel::lanes::{BLOCK, Wide, with_widest};
use crate::kernel::outputs::Output;
use crate::kernel::study::{Limited, Study, StudyError};
use crate::model::error::Status;
use crate::model::inputs::factor;
use crate::sampling::{Rows, Space};

/// Variants a thread takes at a time.
const TASK: usize = 32 * BLOCK;

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

/// A stretch of the result columns that one thread writes.
struct Task<'a> {
    first: usize,
    status: &'a mut [u8],
    values: Vec<&'a mut [f64]>,
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
        let count = self.space.axes().len();
        if let Some(axis) = axes.iter().find(|axis| **axis >= count) {
            let (axis, axes) = (*axis, count);
            return Err(StudyError::NoSuchAxis { axis, axes });
        }
        let (space, mut nothing) = (&self.space, Vec::new());
        nothing.resize(values.first().map_or(0, |column| column.len()), 0);
        self.check_rows(rows, nothing.len())?;
        check_shape(axes.len(), nothing.len(), &values)?;
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
        self.run(rows, outputs, status, values, Path::Blocks)
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
        let slices = values.iter_mut().map(Vec::as_mut_slice).collect();
        let any_refused = self.run(rows, outputs, &mut status, slices, path)?;
        Ok(Columns {
            status,
            any_refused,
            values,
        })
    }

    fn run(
        &self,
        rows: Rows<'_>,
        outputs: &[Output],
        status: &mut [u8],
        values: Vec<&mut [f64]>,
        path: Path,
    ) -> Result<bool, StudyError> {
        self.check_rows(rows, status.len())?;
        check_shape(outputs.len(), status.len(), &values)?;
        for output in outputs {
            self.check_load(*output)?;
        }
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
        Ok(tasks(status, values)
            .into_par_iter()
            .map_init(|| stages.scratch(&self.base), work)
            .reduce(|| false, |a, b| a | b))
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

/// Requires `columns` columns of `rows` rows to write to; without rows there is nothing to write.
fn check_shape(columns: usize, rows: usize, values: &[&mut [f64]]) -> Result<(), StudyError> {
    if rows > 0 && values.len() != columns {
        return Err(StudyError::Shape {
            expected: columns,
            found: values.len(),
        });
    }
    match values.iter().find(|column| column.len() != rows) {
        Some(column) => Err(StudyError::Shape {
            expected: rows,
            found: column.len(),
        }),
        None => Ok(()),
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
