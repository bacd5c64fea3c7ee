//! Columns of a table: what is in them, the memory they are written to, and its cut into tasks.

use std::ops::Range;

use crate::kernel::lanes::BLOCK;
use crate::kernel::outputs::Output;
use crate::kernel::study::StudyError;
use crate::sampling::{Rows, Space};

/// Variants a thread takes at a time.
pub(crate) const TASK: usize = 32 * BLOCK;

/// What a column of a table holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// An axis of the space, by its place, in the user's unit.
    Axis(usize),
    /// A result.
    Output(Output),
}

/// Memory that a column is written to.
#[derive(Debug)]
pub enum Target<'a> {
    /// Real numbers; NaN for the results of a variant that is refused.
    Real(&'a mut [f64]),
    /// Counts; zero for the results of a variant that is refused.
    Count(&'a mut [u32]),
}

impl<'a> Target<'a> {
    fn len(&self) -> usize {
        match self {
            Target::Real(values) => values.len(),
            Target::Count(values) => values.len(),
        }
    }

    /// Stretches of a length, in order; the last one may be shorter.
    fn chunks(self, len: usize) -> Vec<Target<'a>> {
        match self {
            Target::Real(values) => values.chunks_mut(len).map(Target::Real).collect(),
            Target::Count(values) => values.chunks_mut(len).map(Target::Count).collect(),
        }
    }

    /// Writes some rows, a block at most, by a function that writes real numbers.
    #[inline(always)]
    pub(crate) fn write(&mut self, rows: Range<usize>, write: impl FnOnce(&mut [f64])) {
        match self {
            Target::Real(values) => write(&mut values[rows]),
            Target::Count(values) => {
                let mut reals = [0.0; BLOCK];
                let reals = &mut reals[..rows.len()];
                write(reals);
                for (value, real) in values[rows].iter_mut().zip(reals) {
                    *value = *real as u32;
                }
            }
        }
    }

    /// Copies rows from.. to real numbers.
    #[inline(always)]
    pub(crate) fn read(&self, from: usize, out: &mut [f64]) {
        match self {
            Target::Real(values) => out.copy_from_slice(&values[from..from + out.len()]),
            Target::Count(values) => {
                for (value, count) in out.iter_mut().zip(&values[from..]) {
                    *value = f64::from(*count);
                }
            }
        }
    }
}

/// A stretch of a table's columns that one thread writes.
pub(crate) struct Task<'a> {
    pub first: usize,
    pub status: &'a mut [u8],
    pub targets: Vec<Target<'a>>,
}

impl Task<'_> {
    /// Writes those of its columns that are axes: the places `at` of the task, which are `rows` of
    /// the space.
    #[inline(always)]
    pub(crate) fn write_axes(
        &mut self,
        space: &Space,
        sources: &[Source],
        rows: Rows<'_>,
        at: Range<usize>,
    ) {
        for (source, target) in sources.iter().zip(&mut self.targets) {
            if let Source::Axis(axis) = *source {
                target.write(at.clone(), |column| space.fill(axis, rows, column));
            }
        }
    }
}

/// The columns cut into stretches, one a task.
pub(crate) fn tasks<'a>(status: &'a mut [u8], targets: Vec<Target<'a>>) -> Vec<Task<'a>> {
    let mut tasks: Vec<Task<'a>> = status
        .chunks_mut(TASK)
        .enumerate()
        .map(|(k, status)| Task {
            first: k * TASK,
            status,
            targets: Vec::with_capacity(targets.len()),
        })
        .collect();
    for target in targets {
        for (task, part) in tasks.iter_mut().zip(target.chunks(TASK)) {
            task.targets.push(part);
        }
    }
    tasks
}

/// Columns of real numbers as memory to write to.
pub(crate) fn reals(values: Vec<&mut [f64]>) -> Vec<Target<'_>> {
    values.into_iter().map(Target::Real).collect()
}

/// Requires `columns` columns of `rows` rows to write to; without rows there is nothing to write.
pub(crate) fn check_shape(
    columns: usize,
    rows: usize,
    targets: &[Target<'_>],
) -> Result<(), StudyError> {
    if rows > 0 && targets.len() != columns {
        return Err(StudyError::Shape {
            expected: columns,
            found: targets.len(),
        });
    }
    match targets.iter().find(|target| target.len() != rows) {
        Some(target) => Err(StudyError::Shape {
            expected: rows,
            found: target.len(),
        }),
        None => Ok(()),
    }
}

/// Rows `first .. first + len` of the rows asked for.
pub(crate) fn part(rows: Rows<'_>, first: usize, len: usize) -> Rows<'_> {
    match rows {
        Rows::From(start) => Rows::From(start + first as u64),
        Rows::At(indices) => Rows::At(&indices[first..first + len]),
    }
}
