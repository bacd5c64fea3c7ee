//! A study of the component model: the variants of a published study, solved for the columns asked
//! for, in parallel.

use rayon::prelude::*;

use crate::components::inputs::{PART_INPUTS, PARTS_AT, PartInput};
use crate::components::outputs::{PART_OUTPUTS, PartOutput, Wanted};
use crate::components::parts::{Fixed, PartError, Parts};
use crate::components::turn::{Engine, Row, Scratch, Turn};
use crate::kernel::{Output, Study, StudyError};
use crate::model::error::Status;
use crate::model::inputs::{Input, SCALARS};
use crate::sampling::Rows;

/// Variants a thread takes at a time.
const TASK: usize = 16;
/// Variants whose rows are in memory at a time.
const STRETCH: usize = 4096;

/// A range that a result must keep, in the column's own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartLimit {
    /// The column.
    pub output: PartOutput,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Number of the limit among all of the study's.
    pub number: usize,
}

/// The component model's part of a study.
#[derive(Debug)]
pub struct PartStudy {
    /// The component model's inputs where they do not vary, in SI; NaN where left out.
    values: [f64; PART_INPUTS],
    fixed: Fixed,
    engine: Engine,
    limits: Vec<PartLimit>,
    /// Number in the whole study of each limit that the published study has.
    published_limits: Vec<usize>,
}

/// What the status column says of a variant, by its code: the published model's words, then
/// [`PartError::LABELS`], then the limits in their order.
const PART_STATUS: usize = Status::ALL.len();
const LIMIT_STATUS: usize = PART_STATUS + PartError::LABELS.len();

/// Inputs of a stretch of variants.
struct Inputs {
    /// Axes that vary: place among all inputs, and values in SI.
    varying: Vec<(usize, Vec<f64>)>,
    base: [f64; SCALARS],
    shaft: Vec<f64>,
}

impl PartStudy {
    /// A study with these values of the inputs that do not vary, in their own units.
    ///
    /// `published_limits` are the numbers among all limits of those that the published study has.
    #[must_use]
    pub fn new(
        values: [f64; PART_INPUTS],
        fixed: Fixed,
        engine: Engine,
        limits: Vec<PartLimit>,
        published_limits: Vec<usize>,
    ) -> Self {
        let in_si = |(value, input): (f64, PartInput)| value * input.row().1;
        let mut converted = [f64::NAN; PART_INPUTS];
        for (to, pair) in converted
            .iter_mut()
            .zip(values.into_iter().zip(PartInput::ALL))
        {
            *to = in_si(pair);
        }
        Self {
            values: converted,
            fixed,
            engine,
            limits,
            published_limits,
        }
    }

    /// Statuses and columns of some variants, one column an output. Refused variants have NaN in
    /// all of them. True when any variant is refused.
    ///
    /// # Errors
    /// [`StudyError`] for variants that the study does not have.
    pub fn evaluate_into(
        &self,
        study: &Study,
        rows: Rows<'_>,
        outputs: &[PartOutput],
        status: &mut [u8],
        columns: &mut [&mut [f64]],
    ) -> Result<bool, StudyError> {
        let wanted = {
            let limited = self.limits.iter().map(|limit| limit.output);
            Wanted::by(outputs.iter().copied().chain(limited))
        };
        let mut found: Vec<Row> = Vec::new();
        for from in (0..status.len()).step_by(STRETCH) {
            let to = status.len().min(from + STRETCH);
            let rows = match rows {
                Rows::From(start) => Rows::From(start + from as u64),
                Rows::At(indices) => Rows::At(&indices[from..to]),
            };
            let status = &mut status[from..to];
            found.clear();
            found.resize(to - from, [f64::NAN; PART_OUTPUTS]);
            self.stretch(study, rows, wanted, status, &mut found)?;
            for (output, column) in outputs.iter().zip(columns.iter_mut()) {
                let rows = found.iter().zip(&*status);
                for (value, (row, status)) in column[from..to].iter_mut().zip(rows) {
                    let ok = *status == Status::Ok as u8;
                    *value = if ok { row[*output as usize] } else { f64::NAN };
                }
            }
        }
        Ok(status.iter().any(|status| *status != Status::Ok as u8))
    }

    /// Solves a stretch of variants, on all cores.
    fn stretch(
        &self,
        study: &Study,
        rows: Rows<'_>,
        wanted: Wanted,
        status: &mut [u8],
        found: &mut [Row],
    ) -> Result<(), StudyError> {
        let inputs = Inputs::of(study, rows, status)?;
        for status in status.iter_mut() {
            if let Some(limit) = usize::from(*status).checked_sub(PART_STATUS) {
                *status = (LIMIT_STATUS + self.published_limits[limit]) as u8;
            }
        }
        found
            .par_chunks_mut(TASK)
            .zip(status.par_chunks_mut(TASK))
            .enumerate()
            .for_each_init(Scratch::default, |scratch, (task, (found, status))| {
                for (k, (found, status)) in found.iter_mut().zip(status).enumerate() {
                    if *status == Status::Ok as u8 {
                        let row = task * TASK + k;
                        *status = self.variant(&inputs, row, wanted, scratch, found);
                    }
                }
            });
        Ok(())
    }

    /// Solves one variant; its status.
    fn variant(
        &self,
        inputs: &Inputs,
        row: usize,
        wanted: Wanted,
        scratch: &mut Scratch,
        found: &mut Row,
    ) -> u8 {
        let parts = match self.parts(inputs, row) {
            Ok(parts) => parts,
            Err(error) => {
                let of_parts = |code| (PART_STATUS + code) as u8;
                return error.code().map_or(Status::NonFiniteInput as u8, of_parts);
            }
        };
        *found = Turn {
            parts: &parts,
            fixed: &self.fixed,
            engine: self.engine,
            wanted,
            scratch,
        }
        .solve();
        let broken = self.limits.iter().find(|limit| {
            let value = found[limit.output as usize];
            !(limit.min..=limit.max).contains(&value)
        });
        broken.map_or(Status::Ok as u8, |limit| {
            (LIMIT_STATUS + limit.number) as u8
        })
    }

    fn parts(&self, inputs: &Inputs, row: usize) -> Result<Parts, PartError> {
        let (mut scalars, mut values) = (inputs.base, self.values);
        for (input, column) in &inputs.varying {
            if let Some(part) = input.checked_sub(PARTS_AT) {
                let (name, _, default) = PartInput::ALL[part].row();
                if column[row].is_nan() && default.is_assumed() {
                    return Err(PartError::NoNumber { name });
                }
                values[part] = column[row];
            } else if *input < SCALARS {
                scalars[*input] = column[row];
            }
        }
        // A stiffness that is given stands for the whole drive; without segments there is no shaft.
        let is_given = !scalars[Input::OutputStiffness as usize].is_nan();
        let shaft = inputs.shaft[row];
        let shaft = if is_given || shaft.is_nan() {
            0.0
        } else {
            shaft
        };
        Parts::of(&scalars, &values, &self.fixed, shaft)
    }

    /// The parts of one variant that the published model accepts.
    ///
    /// # Errors
    /// A [`StudyError`] for a variant that the study does not have; within, the reason for which
    /// the variant has no component model.
    pub fn parts_of(
        &self,
        study: &Study,
        variant: u64,
    ) -> Result<Result<Parts, PartError>, StudyError> {
        let inputs = Inputs::of(study, Rows::At(&[variant]), &mut [0])?;
        Ok(self.parts(&inputs, 0))
    }

    /// What of the parts no study varies.
    #[must_use]
    pub const fn fixed(&self) -> &Fixed {
        &self.fixed
    }

    /// Why one variant, which the published model accepts, has no component model.
    ///
    /// # Errors
    /// A [`StudyError`] for a variant that the study does not have.
    pub fn explain(&self, study: &Study, variant: u64) -> Result<Option<PartError>, StudyError> {
        Ok(self.parts_of(study, variant)?.err())
    }
}

impl Inputs {
    /// The inputs of some variants; writes the statuses that the published model gives them.
    fn of(study: &Study, rows: Rows<'_>, status: &mut [u8]) -> Result<Self, StudyError> {
        let mut shaft = vec![0.0; status.len()];
        study.evaluate_into(
            rows,
            &[Output::ShaftCompliance],
            status,
            vec![shaft.as_mut_slice()],
        )?;
        let mut varying = Vec::new();
        for (number, axis) in study.space().axes().iter().enumerate() {
            let mut values = study.axis_values(number, rows, status.len())?;
            let factor = crate::model::inputs::factor(axis.input);
            for value in &mut values {
                *value *= factor;
            }
            varying.push((axis.input, values));
        }
        Ok(Self {
            varying,
            base: Input::ALL.map(|input| study.base_value(input)),
            shaft,
        })
    }
}
