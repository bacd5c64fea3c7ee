//! Outcomes of a stage that are computed before any variant: constants, and tables over the few
//! axes of a grid that the stage reads.

use rayon::prelude::*;

use crate::kernel::lanes::BLOCK;
use crate::kernel::packed::Inputs;
use crate::kernel::stages::Stage;
use crate::model::error::{DesignError, Status};
use crate::model::inputs::factor;
use crate::sampling::{Rows, Space};

/// Most entries of a stage's table, and how many variants an entry must serve to be worth it.
const TABLE_LIMIT: u64 = 1 << 20;
const TABLE_WORTH: u64 = 4;

/// A stage's outcome: why it refuses the variant, and what it gives where it does not.
#[derive(Clone, Copy)]
pub(crate) struct Outcome<T> {
    pub status: Status,
    pub value: T,
}

impl<T: Stage> From<Result<T, DesignError>> for Outcome<T> {
    #[inline]
    fn from(outcome: Result<T, DesignError>) -> Self {
        match outcome {
            Ok(value) => Self {
                status: Status::Ok,
                value,
            },
            Err(error) => Self {
                status: error.status(),
                value: T::NONE,
            },
        }
    }
}

/// A stage's outcomes for a block of variants.
pub(crate) struct OutcomeBlock<T: Stage> {
    pub statuses: [Status; BLOCK],
    pub values: Box<T::Block>,
}

impl<T: Stage> OutcomeBlock<T> {
    /// Where to write outcomes of variants none of which is refused so far.
    #[inline(always)]
    pub(crate) fn open(&mut self) -> &mut T::Block {
        self.statuses = [Status::Ok; BLOCK];
        &mut self.values
    }

    #[inline(always)]
    pub(crate) fn put(&mut self, outcome: Outcome<T>, row: usize) {
        self.statuses[row] = outcome.status;
        outcome.value.put(&mut self.values, row);
    }
}

/// What of a stage is computed before any variant.
pub(crate) enum Precomputed<T> {
    /// Nothing it reads varies.
    Constant(Outcome<T>),
    /// One entry a combination of the grid's axes that it reads.
    Table {
        entries: Vec<Outcome<T>>,
        axes: Vec<TableAxis>,
    },
    /// To be computed for every variant.
    PerVariant,
}

/// One digit of a table's index: `(k / stride % count) * weight`.
#[derive(Clone, Copy)]
pub(crate) struct TableAxis {
    stride: u64,
    count: u64,
    weight: u64,
}

impl<T: Stage> Precomputed<T> {
    /// Computes what can be computed beforehand of a stage that reads these inputs.
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
            return Precomputed::Constant(of(base).into());
        }
        let Some(strides) = space.grid_strides() else {
            return Precomputed::PerVariant;
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
            return Precomputed::PerVariant;
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
                    Outcome::from(of(inputs))
                },
            )
            .collect();
        Precomputed::Table {
            entries,
            axes: table,
        }
    }

    /// True when it has to be computed for every variant.
    #[inline(always)]
    pub(crate) const fn is_open(&self) -> bool {
        matches!(self, Precomputed::PerVariant)
    }

    /// A block to start from: the constant where it is one.
    pub(crate) fn block(&self) -> OutcomeBlock<T> {
        let Outcome { status, value } = match self {
            Precomputed::Constant(outcome) => *outcome,
            Precomputed::Table { .. } | Precomputed::PerVariant => Outcome::from(Ok(T::NONE)),
        };
        OutcomeBlock {
            statuses: [status; BLOCK],
            values: value.block(),
        }
    }

    /// Looks up `len` rows of a block in the table, if there is one.
    #[inline]
    pub(crate) fn look_up(&self, rows: Rows<'_>, len: usize, out: &mut OutcomeBlock<T>) {
        let Precomputed::Table { entries, axes } = self else {
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
                for (row, outcome) in (from..to).zip(&entries[at..]) {
                    out.put(*outcome, row);
                }
            } else {
                let Outcome { status, value } = entries[at];
                out.statuses[from..to].fill(status);
                value.put_all(&mut out.values, from..to);
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
