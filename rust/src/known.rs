//! Which outcomes of a stage are known before any variant: constants, and tables over the few axes
//! of a grid that the stage reads.

use rayon::prelude::*;

use crate::columns::BLOCK;
use crate::error::{DesignError, Status};
use crate::inputs::{Inputs, factor};
use crate::space::{Rows, Space};
use crate::stages::Stage;

/// Most entries of a stage's table, and how many variants an entry must serve to be worth it.
const TABLE_LIMIT: u64 = 1 << 20;
const TABLE_WORTH: u64 = 4;

/// Which of a stage's outcomes are already known.
pub(crate) enum Known<T> {
    /// Nothing it reads varies.
    Constant(T),
    /// One entry a combination of the grid's axes that it reads.
    Table {
        entries: Vec<T>,
        axes: Vec<TableAxis>,
    },
    /// To be computed for every variant.
    Nothing,
}

/// One digit of a table's index: `(k / stride % count) * weight`.
#[derive(Clone, Copy)]
pub(crate) struct TableAxis {
    stride: u64,
    count: u64,
    weight: u64,
}

impl<T: Stage> Known<T> {
    /// What is known of a stage that reads these inputs and is computed by `of`.
    pub(crate) fn of(
        space: &Space,
        base: &Inputs,
        reads: &[usize],
        of: &(impl Fn(&Inputs) -> Result<T, DesignError> + Sync),
    ) -> Self {
        let axes = space.axes();
        let varying: Vec<usize> = (0..axes.len())
            .filter(|a| reads.contains(&axes[*a].input))
            .collect();
        if varying.is_empty() {
            return Known::Constant(filed(of(base)));
        }
        let Some(strides) = space.grid_strides() else {
            return Known::Nothing;
        };
        let mut table = Vec::with_capacity(varying.len());
        let mut size = 1_u64;
        for axis in varying.iter().rev() {
            let count = axes[*axis].values.count().unwrap_or(1);
            table.push(TableAxis {
                stride: strides[*axis],
                count,
                weight: size,
            });
            size = size.saturating_mul(count);
        }
        if size > TABLE_LIMIT.min(space.len() / TABLE_WORTH) {
            return Known::Nothing;
        }
        table.reverse();
        let entries = (0..size)
            .into_par_iter()
            .map_init(
                || base.clone(),
                |inputs, entry| {
                    for (axis, digit) in varying.iter().zip(&table) {
                        let input = axes[*axis].input;
                        let value = axes[*axis].values.nth(entry / digit.weight % digit.count);
                        inputs.set(input, value * factor(input));
                    }
                    filed(of(inputs))
                },
            )
            .collect();
        Known::Table {
            entries,
            axes: table,
        }
    }

    /// True when it has to be computed for every variant.
    #[inline(always)]
    pub(crate) const fn is_open(&self) -> bool {
        matches!(self, Known::Nothing)
    }

    /// A block to start from: the constant where it is one.
    pub(crate) fn block(&self) -> [T; BLOCK] {
        match self {
            Known::Constant(value) => [*value; BLOCK],
            Known::Table { .. } | Known::Nothing => [T::refused(Status::Ok); BLOCK],
        }
    }

    /// Looks up every row of a block in the table, if there is one.
    pub(crate) fn look_up(&self, rows: Rows<'_>, out: &mut [T]) {
        let Known::Table { entries, axes } = self else {
            return;
        };
        let start = match rows {
            Rows::From(start) => start,
            Rows::At(indices) => {
                for (out, k) in out.iter_mut().zip(indices) {
                    *out = entries[entry(axes, *k)];
                }
                return;
            }
        };
        // Along the fastest axis entries are neighbours; behind it they repeat.
        let last = axes[axes.len() - 1];
        let mut k = start;
        let mut rest = out;
        while !rest.is_empty() {
            let at = entry(axes, k);
            let run = if last.stride == 1 {
                last.count - k % last.count
            } else {
                last.stride - k % last.stride
            };
            let run = run.min(rest.len() as u64) as usize;
            let (now, later) = rest.split_at_mut(run);
            if last.stride == 1 {
                now.copy_from_slice(&entries[at..at + run]);
            } else {
                now.fill(entries[at]);
            }
            rest = later;
            k += run as u64;
        }
    }
}

/// Where a table keeps variant `k`.
#[inline]
fn entry(axes: &[TableAxis], k: u64) -> usize {
    axes.iter()
        .map(|a| k / a.stride % a.count * a.weight)
        .sum::<u64>() as usize
}

/// A stage's outcome, refusals by their status.
#[inline(always)]
pub(crate) fn filed<T: Stage>(outcome: Result<T, DesignError>) -> T {
    outcome.unwrap_or_else(|error| T::refused(error.status()))
}
