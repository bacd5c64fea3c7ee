//! Which outcomes of a stage are known before any variant: constants, and tables over the few axes
//! of a grid that the stage reads.

use rayon::prelude::*;

use crate::error::{DesignError, Status};
use crate::inputs::{Inputs, factor};
use crate::lanes::BLOCK;
use crate::space::{Rows, Space};
use crate::stages::Stage;

/// Most entries of a stage's table, and how many variants an entry must serve to be worth it.
const TABLE_LIMIT: u64 = 1 << 20;
const TABLE_WORTH: u64 = 4;

/// A stage's outcome: why it refuses the variant, and what it gives where it does not.
#[derive(Clone, Copy)]
pub(crate) struct Filed<T> {
    pub status: Status,
    pub outcome: T,
}

impl<T: Stage> From<Result<T, DesignError>> for Filed<T> {
    #[inline]
    fn from(outcome: Result<T, DesignError>) -> Self {
        match outcome {
            Ok(outcome) => Self {
                status: Status::Ok,
                outcome,
            },
            Err(error) => Self {
                status: error.status(),
                outcome: T::NONE,
            },
        }
    }
}

/// A stage's outcomes for a block of variants.
pub(crate) struct FiledBlock<T: Stage> {
    pub statuses: [Status; BLOCK],
    pub outcomes: Box<T::Block>,
}

impl<T: Stage> FiledBlock<T> {
    /// Where to write outcomes of variants none of which is refused so far.
    #[inline(always)]
    pub(crate) fn open(&mut self) -> &mut T::Block {
        self.statuses = [Status::Ok; BLOCK];
        &mut self.outcomes
    }

    #[inline(always)]
    pub(crate) fn put(&mut self, filed: Filed<T>, row: usize) {
        self.statuses[row] = filed.status;
        filed.outcome.put(&mut self.outcomes, row);
    }
}

/// Which of a stage's outcomes are already known.
pub(crate) enum Known<T> {
    /// Nothing it reads varies.
    Constant(Filed<T>),
    /// One entry a combination of the grid's axes that it reads.
    Table {
        entries: Vec<Filed<T>>,
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
            return Known::Constant(of(base).into());
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
                    Filed::from(of(inputs))
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
    pub(crate) fn block(&self) -> FiledBlock<T> {
        let Filed { status, outcome } = match self {
            Known::Constant(filed) => *filed,
            Known::Table { .. } | Known::Nothing => Filed::from(Ok(T::NONE)),
        };
        FiledBlock {
            statuses: [status; BLOCK],
            outcomes: outcome.block(),
        }
    }

    /// Looks up `len` rows of a block in the table, if there is one.
    #[inline]
    pub(crate) fn look_up(&self, rows: Rows<'_>, len: usize, out: &mut FiledBlock<T>) {
        let Known::Table { entries, axes } = self else {
            return;
        };
        let start = match rows {
            Rows::From(start) => start,
            Rows::At(indices) => {
                for (row, k) in indices[..len].iter().enumerate() {
                    out.put(entries[entry(axes, *k)], row);
                }
                return;
            }
        };
        // Along the fastest axis entries are neighbours; behind it they repeat.
        let last = axes[axes.len() - 1];
        let mut from = 0;
        while from < len {
            let k = start + from as u64;
            let at = entry(axes, k);
            let run = if last.stride == 1 {
                last.count - k % last.count
            } else {
                last.stride - k % last.stride
            };
            let to = len.min(from + run.min(BLOCK as u64) as usize);
            if last.stride == 1 {
                for (row, filed) in (from..to).zip(&entries[at..]) {
                    out.put(*filed, row);
                }
            } else {
                let Filed { status, outcome } = entries[at];
                out.statuses[from..to].fill(status);
                outcome.put_all(&mut out.outcomes, from..to);
            }
            from = to;
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
