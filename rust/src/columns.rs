//! A study's variants to columns of results, in parallel; the only rayon in the crate.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::error::{DesignError, Status};
use crate::inputs::{Input, SCALARS, SEGMENT_FIELDS, factor};
use crate::outputs::{Assembly, Block, Output};
use crate::shaft::SegmentKind;
use crate::space::{Rows, Space};
use crate::stages::{Geometry, Map, PinBending, Rating, Read, Shaft, Stage};

/// Variants computed together: their stages stay in the cache.
const BLOCK: usize = 256;
/// Variants a thread takes at a time.
const TASK: usize = 16 * BLOCK;
/// Most entries of a stage's table, and how many variants an entry must serve to be worth it.
const TABLE_LIMIT: u64 = 1 << 20;
const TABLE_WORTH: u64 = 4;

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

/// Which of a stage's outcomes are already known.
enum Known<T> {
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
struct TableAxis {
    stride: u64,
    count: u64,
    weight: u64,
}

struct Stages {
    geometry: Known<Geometry>,
    map: Known<Map>,
    shaft: Known<Shaft>,
    pin: Known<PinBending>,
    rating: Known<Rating>,
    /// For each axis, whether a stage that is computed for every variant reads it.
    axis_is_read: Vec<bool>,
}

/// The definition of a study, ready to evaluate.
pub struct Study {
    space: Space,
    base: Vec<f64>,
    kinds: Vec<SegmentKind>,
    loads: Vec<f64>,
    limits: Vec<Limit>,
    stages: OnceLock<Stages>,
    evaluated: AtomicU64,
}

/// A stretch of the result columns that one thread writes.
struct Task<'a> {
    first: usize,
    status: &'a mut [u8],
    values: Vec<&'a mut [f64]>,
}

/// One row of a block's inputs.
struct Row<'a> {
    inputs: &'a [Vec<f64>],
    row: usize,
}

impl Read for Row<'_> {
    #[inline]
    fn read(&self, input: usize) -> f64 {
        self.inputs[input][self.row]
    }
}

/// A thread's working memory for one block.
struct Scratch {
    inputs: Vec<Vec<f64>>,
    geometry: Vec<Geometry>,
    map: Vec<Map>,
    shaft: Vec<Shaft>,
    pin: Vec<PinBending>,
    rating: Vec<Rating>,
    assembly: Vec<Assembly>,
    limited: Vec<f64>,
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
        let mut inputs: Vec<Vec<f64>> = self.base.iter().map(|value| vec![*value]).collect();
        for (number, axis) in self.space.axes().iter().enumerate() {
            self.fill_input(number, axis.input, Rows::At(&[variant]), &mut inputs, 1);
        }
        let row = Row {
            inputs: &inputs,
            row: 0,
        };
        Geometry::of(&row)
            .and_then(|_| Map::check(&row))
            .and_then(|_| Shaft::of(&row, &self.kinds))
            .and_then(|_| PinBending::of(&row))
            .and_then(|_| Rating::of(&row, self.kinds.is_empty()))
            .err()
    }

    /// Evaluates `len` variants. Bits do not depend on the number of threads, nor on how a
    /// study is cut.
    #[must_use]
    pub fn evaluate(&self, rows: Rows<'_>, len: usize, outputs: &[Output]) -> Columns {
        self.evaluated.fetch_add(len as u64, Ordering::Relaxed);
        let mut columns = Columns {
            status: vec![0; len],
            any_refused: false,
            values: outputs.iter().map(|_| vec![0.0; len]).collect(),
        };
        let mut tasks: Vec<Task<'_>> = columns
            .status
            .chunks_mut(TASK)
            .enumerate()
            .map(|(k, status)| Task {
                first: k * TASK,
                status,
                values: Vec::new(),
            })
            .collect();
        for column in &mut columns.values {
            for (task, part) in tasks.iter_mut().zip(column.chunks_mut(TASK)) {
                task.values.push(part);
            }
        }
        let stages = self.stages();
        columns.any_refused = tasks
            .into_par_iter()
            .map_init(
                || self.scratch(),
                |scratch,
                 Task {
                     first,
                     status,
                     mut values,
                 }| {
                    let mut any = false;
                    for from in (0..status.len()).step_by(BLOCK) {
                        let to = (from + BLOCK).min(status.len());
                        let rows = part(rows, first + from, to - from);
                        let mut values: Vec<&mut [f64]> = values
                            .iter_mut()
                            .map(|column| &mut column[from..to])
                            .collect();
                        let status = &mut status[from..to];
                        any |= self.block(stages, scratch, rows, outputs, status, &mut values);
                    }
                    any
                },
            )
            .reduce(|| false, |a, b| a | b);
        columns
    }

    /// One block: inputs, stages, status, results. True when any variant is refused.
    fn block(
        &self,
        stages: &Stages,
        scratch: &mut Scratch,
        rows: Rows<'_>,
        outputs: &[Output],
        status: &mut [u8],
        values: &mut [&mut [f64]],
    ) -> bool {
        let len = status.len();
        for (number, axis) in self.space.axes().iter().enumerate() {
            if stages.axis_is_read[number] {
                self.fill_input(number, axis.input, rows, &mut scratch.inputs, len);
            }
        }
        let limited = self.limits.iter().filter_map(|limit| match limit.column {
            Limited::Output(output) => Some(output),
            Limited::Input(_) => None,
        });
        let needed = || outputs.iter().copied().chain(limited.clone());
        let every_criterion = needed().any(Output::needs_every_criterion);
        let with_map = needed().any(|output| !output.is_free_of_map());

        let Scratch {
            inputs,
            geometry,
            map,
            shaft,
            pin,
            rating,
            assembly,
            limited,
        } = scratch;
        stages
            .geometry
            .fill(rows, &mut geometry[..len], inputs, &|row: &Row<'_>| {
                Geometry::of(row)
            });
        stages.map.fill(rows, &mut map[..len], inputs, &|row| {
            if with_map {
                Map::of(row, every_criterion)
            } else {
                Map::check(row)
            }
        });
        stages.shaft.fill(rows, &mut shaft[..len], inputs, &|row| {
            Shaft::of(row, &self.kinds)
        });
        stages
            .pin
            .fill(rows, &mut pin[..len], inputs, &|row: &Row<'_>| {
                PinBending::of(row)
            });
        let needs_stiffness = self.kinds.is_empty();
        stages
            .rating
            .fill(rows, &mut rating[..len], inputs, &|row| {
                Rating::of(row, needs_stiffness)
            });
        for k in 0..len {
            assembly[k] = Assembly::of(&map[k], &shaft[k], &pin[k], &rating[k]);
            status[k] = [
                geometry[k].status(),
                map[k].status(),
                shaft[k].status(),
                pin[k].status(),
                rating[k].status(),
            ]
            .into_iter()
            .find(|status| *status != Status::Ok)
            .unwrap_or(Status::Ok) as u8;
        }
        let block = Block {
            geometry: &geometry[..len],
            map: &map[..len],
            shaft: &shaft[..len],
            pin: &pin[..len],
            rating: &rating[..len],
            assembly: &assembly[..len],
        };
        for (number, limit) in self.limits.iter().enumerate() {
            let limited = &mut limited[..len];
            let unit = match limit.column {
                Limited::Output(output) => {
                    block.write(output, &self.loads, limited);
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
        for (output, column) in outputs.iter().zip(values.iter_mut()) {
            block.write(*output, &self.loads, column);
        }
        let any = status.iter().any(|status| *status != Status::Ok as u8);
        if any {
            for column in values {
                for (value, status) in column.iter_mut().zip(status.iter()) {
                    if *status != Status::Ok as u8 {
                        *value = f64::NAN;
                    }
                }
            }
        }
        any
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
                out.fill(self.base[input]);
                factor(input)
            }
        }
    }

    fn fill_input(
        &self,
        axis: usize,
        input: usize,
        rows: Rows<'_>,
        inputs: &mut [Vec<f64>],
        len: usize,
    ) {
        let column = &mut inputs[input][..len];
        self.space.fill(axis, rows, column);
        let factor = factor(input);
        if factor != 1.0 {
            for value in column {
                *value *= factor;
            }
        }
    }

    fn scratch(&self) -> Scratch {
        Scratch {
            inputs: self.base.iter().map(|value| vec![*value; BLOCK]).collect(),
            geometry: vec![Geometry::refused(Status::Ok); BLOCK],
            map: vec![Map::refused(Status::Ok); BLOCK],
            shaft: vec![Shaft::refused(Status::Ok); BLOCK],
            pin: vec![PinBending::refused(Status::Ok); BLOCK],
            rating: vec![Rating::refused(Status::Ok); BLOCK],
            assembly: vec![
                Assembly {
                    compliance: 0.0,
                    reflected: 0.0,
                    slope_deg: 0.0,
                    pin_force: 0.0
                };
                BLOCK
            ],
            limited: vec![0.0; BLOCK],
        }
    }

    /// What of each stage is known before any variant: computed once, on first use.
    fn stages(&self) -> &Stages {
        self.stages.get_or_init(|| {
            let of_inputs = |inputs: &[Input]| inputs.iter().map(|i| *i as usize).collect();
            let mut shaft_inputs: Vec<usize> = of_inputs(&Shaft::INPUTS);
            shaft_inputs.extend(SCALARS..self.base.len());
            let geometry_inputs: Vec<usize> = of_inputs(&Geometry::INPUTS);
            let map_inputs: Vec<usize> = of_inputs(&Map::INPUTS);
            let pin_inputs: Vec<usize> = of_inputs(&PinBending::INPUTS);
            let rating_inputs: Vec<usize> = of_inputs(&Rating::INPUTS);
            let needs_stiffness = self.kinds.is_empty();
            let mut stages = Stages {
                geometry: self.known(&geometry_inputs, &|row: &Row<'_>| Geometry::of(row)),
                map: self.known(&map_inputs, &|row| Map::of(row, true)),
                shaft: self.known(&shaft_inputs, &|row| Shaft::of(row, &self.kinds)),
                pin: self.known(&pin_inputs, &|row: &Row<'_>| PinBending::of(row)),
                rating: self.known(&rating_inputs, &|row| Rating::of(row, needs_stiffness)),
                axis_is_read: vec![false; self.space.axes().len()],
            };
            for (axis, read) in self.space.axes().iter().zip(&mut stages.axis_is_read) {
                let reads = |open: bool, inputs: &[usize]| open && inputs.contains(&axis.input);
                *read = reads(stages.geometry.is_open(), &geometry_inputs)
                    || reads(stages.map.is_open(), &map_inputs)
                    || reads(stages.shaft.is_open(), &shaft_inputs)
                    || reads(stages.pin.is_open(), &pin_inputs)
                    || reads(stages.rating.is_open(), &rating_inputs);
            }
            stages
        })
    }

    fn known<T: Stage>(
        &self,
        reads: &[usize],
        of: &(impl Fn(&Row<'_>) -> Result<T, DesignError> + Sync),
    ) -> Known<T> {
        let axes = self.space.axes();
        let varying: Vec<usize> = (0..axes.len())
            .filter(|a| reads.contains(&axes[*a].input))
            .collect();
        if varying.is_empty() {
            let inputs: Vec<Vec<f64>> = self.base.iter().map(|value| vec![*value]).collect();
            return Known::Constant(filed(of(&Row {
                inputs: &inputs,
                row: 0,
            })));
        }
        let Some(strides) = self.space.grid_strides() else {
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
        if size > TABLE_LIMIT.min(self.space.len() / TABLE_WORTH) {
            return Known::Nothing;
        }
        table.reverse();
        let entries = (0..size)
            .into_par_iter()
            .map_init(
                || {
                    self.base
                        .iter()
                        .map(|value| vec![*value])
                        .collect::<Vec<_>>()
                },
                |inputs, entry| {
                    for (axis, digit) in varying.iter().zip(&table) {
                        let input = axes[*axis].input;
                        let value = axes[*axis].values.nth(entry / digit.weight % digit.count);
                        inputs[input][0] = value * factor(input);
                    }
                    filed(of(&Row { inputs, row: 0 }))
                },
            )
            .collect();
        Known::Table {
            entries,
            axes: table,
        }
    }
}

impl<T: Stage> Known<T> {
    fn is_open(&self) -> bool {
        matches!(self, Known::Nothing)
    }

    /// The stage's outcome for every row of a block.
    fn fill(
        &self,
        rows: Rows<'_>,
        out: &mut [T],
        inputs: &[Vec<f64>],
        of: &impl Fn(&Row<'_>) -> Result<T, DesignError>,
    ) {
        match (self, rows) {
            (Known::Constant(value), _) => out.fill(*value),
            (Known::Table { entries, axes }, Rows::At(indices)) => {
                for (out, k) in out.iter_mut().zip(indices) {
                    *out = entries[entry(axes, *k)];
                }
            }
            (Known::Table { entries, axes }, Rows::From(start)) => {
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
            (Known::Nothing, _) => {
                for (row, out) in out.iter_mut().enumerate() {
                    *out = filed(of(&Row { inputs, row }));
                }
            }
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

#[inline]
fn filed<T: Stage>(outcome: Result<T, DesignError>) -> T {
    outcome.unwrap_or_else(|error| T::refused(error.status()))
}

/// Rows `first .. first + len` of the rows asked for.
fn part(rows: Rows<'_>, first: usize, len: usize) -> Rows<'_> {
    match rows {
        Rows::From(start) => Rows::From(start + first as u64),
        Rows::At(indices) => Rows::At(&indices[first..first + len]),
    }
}
