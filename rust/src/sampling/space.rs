//! A space of variants: which inputs vary and how variant k gets its values from k alone.

use std::ops::Range;

use thiserror::Error;

use crate::sampling::sequences::{
    MAX_SOBOL_AXES, Permutation, SobolAxis, key, random, unit_interval,
};
use crate::sampling::values::Values;

/// Most variants a space may hold.
pub const MAX_VARIANTS: u64 = 1 << 63;

/// One axis: which input varies, and over what.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Position of the input; see [`crate::model::inputs`].
    pub input: usize,
    /// Its values.
    pub values: Values,
}

/// How points are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Every combination, the last axis fastest.
    Grid,
    /// Scrambled Sobol sequence.
    Sobol,
    /// Latin hypercube of all `count` strata.
    LatinHypercube,
    /// Independent uniform points.
    Random,
    /// One variant a row of the axes' lists.
    Table,
    /// Points for Sobol indices (Saltelli 2002): for each pair of points of two scrambled Sobol
    /// sequences the first, then for each axis the first with that axis of the second, then the
    /// second.
    Saltelli,
}

/// Why a space cannot be.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SpaceError {
    /// More variants than can be counted.
    #[error("more than 2^63 variants")]
    TooMany,
    /// An axis is empty.
    #[error("axis {axis} has no values")]
    Empty {
        /// Position of the axis.
        axis: usize,
    },
    /// A grid needs countable axes.
    #[error("axis {axis} of a grid needs a list of values or a number of steps")]
    NotCountable {
        /// Position of the axis.
        axis: usize,
    },
    /// The lists of a table differ in length.
    #[error("column {axis} of the table has another length")]
    Ragged {
        /// Position of the axis.
        axis: usize,
    },
    /// The Sobol sequence has no more directions.
    #[error("a Sobol study takes at most 128 axes")]
    TooManySobolAxes,
    /// Two points of the sequence are needed for each.
    #[error("a sample for Sobol indices takes at most 64 axes")]
    TooManySaltelliAxes,
}

/// Which variants are asked for.
#[derive(Debug, Clone, Copy)]
pub enum Rows<'a> {
    /// Consecutive ones from this index.
    From(u64),
    /// These; the slice is as long as the block.
    At(&'a [u64]),
}

#[derive(Debug, Clone)]
enum Points {
    Grid {
        strides: Vec<u64>,
    },
    Sobol(Vec<SobolAxis>),
    LatinHypercube(Vec<Permutation>),
    Random(Vec<u64>),
    Table,
    Saltelli {
        first: Vec<SobolAxis>,
        second: Vec<SobolAxis>,
    },
}

/// A space of variants, random access in constant memory (but for a table's own rows).
#[derive(Debug, Clone)]
pub struct Space {
    axes: Vec<Axis>,
    points: Points,
    len: u64,
}

impl Space {
    /// A space over `axes`. `count` is read by the sampled layouts, `seed` by the random ones.
    ///
    /// # Errors
    /// [`SpaceError`] with the position of the axis that does not fit.
    pub fn new(axes: Vec<Axis>, layout: Layout, count: u64, seed: u64) -> Result<Self, SpaceError> {
        let empty = axes.iter().position(|a| a.values.count() == Some(0));
        if let (Some(axis), true) = (empty, layout != Layout::Table) {
            return Err(SpaceError::Empty { axis });
        }
        let keys = |axes: &[Axis]| (0..axes.len() as u64).map(|axis| key(seed, axis)).collect();
        let (points, len) = match layout {
            Layout::Grid => {
                let mut strides = vec![1; axes.len()];
                let mut len = 1_u64;
                for (axis, stride) in strides.iter_mut().enumerate().rev() {
                    let count = axes[axis]
                        .values
                        .count()
                        .ok_or(SpaceError::NotCountable { axis })?;
                    *stride = len;
                    len = len.checked_mul(count).ok_or(SpaceError::TooMany)?;
                }
                (Points::Grid { strides }, len)
            }
            Layout::Sobol => {
                if axes.len() > MAX_SOBOL_AXES {
                    return Err(SpaceError::TooManySobolAxes);
                }
                (Points::Sobol(sobol_axes(0, axes.len(), seed)), count)
            }
            Layout::Saltelli => {
                if 2 * axes.len() > MAX_SOBOL_AXES {
                    return Err(SpaceError::TooManySaltelliAxes);
                }
                let first = sobol_axes(0, axes.len(), seed);
                let second = sobol_axes(axes.len(), axes.len(), seed);
                (Points::Saltelli { first, second }, count)
            }
            Layout::LatinHypercube => {
                let keys: Vec<u64> = keys(&axes);
                let maps = keys
                    .into_iter()
                    .map(|key| Permutation::new(count, key))
                    .collect();
                (Points::LatinHypercube(maps), count)
            }
            Layout::Random => (Points::Random(keys(&axes)), count),
            Layout::Table => {
                let lengths: Vec<_> = axes.iter().map(|a| a.values.count()).collect();
                if let Some(axis) = lengths.iter().position(|l| *l != lengths[0] || l.is_none()) {
                    return Err(SpaceError::Ragged { axis });
                }
                (
                    Points::Table,
                    lengths.first().copied().flatten().unwrap_or(count),
                )
            }
        };
        if len > MAX_VARIANTS {
            return Err(SpaceError::TooMany);
        }
        Ok(Self { axes, points, len })
    }

    /// Number of variants.
    #[must_use]
    pub const fn len(&self) -> u64 {
        self.len
    }

    /// True when there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The axes, in their order.
    #[must_use]
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// For a grid, how many variants lie between neighbours on each axis.
    pub(crate) fn grid_strides(&self) -> Option<&[u64]> {
        match &self.points {
            Points::Grid { strides } => Some(strides),
            _ => None,
        }
    }

    /// Writes the values of one axis for the asked variants.
    #[inline(always)]
    pub(crate) fn fill(&self, axis: usize, rows: Rows<'_>, out: &mut [f64]) {
        let values = &self.axes[axis].values;
        match (&self.points, rows) {
            (Points::Grid { strides }, Rows::From(start)) => {
                let count = values.count().unwrap_or(1);
                fill_grid(values, strides[axis], count, start, out);
            }
            (Points::Grid { strides }, Rows::At(indices)) => {
                let count = values.count().unwrap_or(1);
                for (value, index) in out.iter_mut().zip(indices) {
                    *value = values.nth(index / strides[axis] % count);
                }
            }
            (Points::Table, Rows::From(start)) => {
                if let Values::List(list) = values {
                    let range = Range {
                        start: start as usize,
                        end: start as usize + out.len(),
                    };
                    out.copy_from_slice(&list[range]);
                }
            }
            (Points::Table, Rows::At(indices)) => {
                for (value, index) in out.iter_mut().zip(indices) {
                    *value = values.nth(*index);
                }
            }
            (Points::Sobol(sequences), Rows::From(start)) => {
                sequences[axis].fill_units(start, out);
                values.place(out);
            }
            (Points::Sobol(sequences), Rows::At(indices)) => {
                for (value, index) in out.iter_mut().zip(indices) {
                    *value = values.at(unit_interval(sequences[axis].bits(*index)));
                }
            }
            (Points::Saltelli { first, second }, rows) => {
                let group = self.axes.len() as u64 + 2;
                for_each(rows, out, |index| {
                    let (point, place) = (index / group, index % group);
                    let of_second = place == axis as u64 + 1 || place + 1 == group;
                    let sequences = if of_second { second } else { first };
                    values.at(unit_interval(sequences[axis].bits(point)))
                });
            }
            (Points::LatinHypercube(maps), rows) => {
                for_each(rows, out, |index| values.at(maps[axis].stratified(index)));
            }
            (Points::Random(keys), rows) => {
                for_each(rows, out, |index| values.at(random(keys[axis], index)));
            }
        }
    }
}

/// Scrambled Sobol sequences of `count` axes from number `start` on.
fn sobol_axes(start: usize, count: usize, seed: u64) -> Vec<SobolAxis> {
    (start..start + count)
        .map(|axis| SobolAxis::new(axis, Some(key(seed, axis as u64))))
        .collect()
}

#[inline]
fn for_each(rows: Rows<'_>, out: &mut [f64], value: impl Fn(u64) -> f64) {
    match rows {
        Rows::From(start) => out.iter_mut().zip(start..).for_each(|(v, k)| *v = value(k)),
        Rows::At(indices) => out
            .iter_mut()
            .zip(indices)
            .for_each(|(v, k)| *v = value(*k)),
    }
}

/// Values of one axis of a grid for consecutive variants: runs of equal values.
fn fill_grid(values: &Values, stride: u64, count: u64, start: u64, out: &mut [f64]) {
    let mut digit = start / stride % count;
    let mut left_of_run = (stride - start % stride) as usize;
    let mut rest = out;
    while !rest.is_empty() {
        let run = left_of_run.min(rest.len());
        let (now, later) = rest.split_at_mut(run);
        now.fill(values.nth(digit));
        rest = later;
        left_of_run = usize::try_from(stride).unwrap_or(usize::MAX);
        digit = if digit + 1 == count { 0 } else { digit + 1 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes() -> Vec<Axis> {
        vec![
            Axis {
                input: 2,
                values: Values::Linspace {
                    from: 0.3,
                    to: 0.8,
                    steps: 7,
                },
            },
            Axis {
                input: 5,
                values: Values::List(vec![6.0, 8.0, 9.0]),
            },
            Axis {
                input: 7,
                values: Values::Linspace {
                    from: 10.0,
                    to: 22.0,
                    steps: 5,
                },
            },
        ]
    }

    #[test]
    fn consecutive_and_picked_variants_are_the_same() {
        for layout in [
            Layout::Grid,
            Layout::Sobol,
            Layout::LatinHypercube,
            Layout::Random,
            Layout::Saltelli,
        ] {
            let space = Space::new(axes(), layout, 105, 3).expect("valid");
            assert_eq!(space.len(), 105);
            for axis in 0..3 {
                let mut all = [0.0; 100];
                space.fill(axis, Rows::From(5), &mut all);
                for (k, value) in all.iter().enumerate() {
                    let mut one = [0.0];
                    space.fill(axis, Rows::At(&[k as u64 + 5]), &mut one);
                    assert_eq!(one[0], *value, "{layout:?} axis {axis} variant {k}");
                }
            }
        }
    }

    #[test]
    fn a_grid_runs_its_last_axis_fastest_and_ends_on_its_last_values() {
        let space = Space::new(axes(), Layout::Grid, 0, 0).expect("valid");
        let mut last = [0.0; 2];
        space.fill(2, Rows::From(103), &mut last);
        assert_eq!(last, [19.0, 22.0]);
        space.fill(0, Rows::From(103), &mut last);
        assert_eq!(last, [0.8, 0.8]);
    }

    #[test]
    fn variants_for_sobol_indices_take_one_axis_at_a_time_from_the_second_point() {
        let space = Space::new(axes(), Layout::Saltelli, 50, 3).expect("valid");
        for group in 0..10 {
            let rows: [u64; 5] = std::array::from_fn(|k| group * 5 + k as u64);
            for axis in 0..3 {
                let mut values = [0.0; 5];
                space.fill(axis, Rows::At(&rows), &mut values);
                let [first, .., second] = values;
                for (place, value) in values.iter().enumerate().take(4) {
                    let expected = if place == axis + 1 { second } else { first };
                    assert_eq!(*value, expected);
                }
            }
        }
        let sobol = Space::new(axes(), Layout::Sobol, 10, 3).expect("valid");
        let (mut points, mut firsts) = ([0.0; 10], [0.0; 10]);
        sobol.fill(2, Rows::From(0), &mut points);
        let rows: [u64; 10] = std::array::from_fn(|k| 5 * k as u64);
        space.fill(2, Rows::At(&rows), &mut firsts);
        assert_eq!(points, firsts);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let interval = Axis {
            input: 2,
            values: Values::Interval {
                low: 0.0,
                high: 1.0,
            },
        };
        let grid = Space::new(vec![interval], Layout::Grid, 0, 0);
        assert_eq!(grid.err(), Some(SpaceError::NotCountable { axis: 0 }));
        let many = Axis {
            input: 2,
            values: Values::Linspace {
                from: 0.0,
                to: 1.0,
                steps: 1 << 32,
            },
        };
        let grid = Space::new(vec![many.clone(), many], Layout::Grid, 0, 0);
        assert_eq!(grid.err(), Some(SpaceError::TooMany));
    }
}
