//! Checks of what a study varies of the torsional train, whose columns follow from results.

use crate::components::inputs::{PARTS_AT, PartInput};
use crate::kernel::lanes::BLOCK;
use crate::kernel::study::Study;
use crate::model::error::{DesignError, Status, negative, not_positive};
use crate::sampling::Rows;

/// Why a value (SI) cannot be one of the train's; NaN stands for a part that is left out.
fn refusal(input: PartInput, value: f64) -> Option<DesignError> {
    if value.is_nan() {
        return None;
    }
    match input {
        PartInput::LoadInertia | PartInput::FlangeInertia | PartInput::CouplingStiffness => {
            let holds = value > 0.0 && value.is_finite();
            (!holds).then(|| not_positive(input.name(), value))
        }
        PartInput::EccentricInertia => {
            let holds = value >= 0.0 && value.is_finite();
            (!holds).then(|| negative(input.name(), value))
        }
        _ => None,
    }
}

impl Study {
    /// Axes of the train: number of the axis, and its input. All are in SI units.
    fn train_axes(&self) -> impl Iterator<Item = (usize, PartInput)> + '_ {
        let axes = self.space.axes().iter().enumerate();
        axes.filter_map(|(number, axis)| {
            let part = *PartInput::ALL.get(axis.input.checked_sub(PARTS_AT)?)?;
            part.is_of_train().then_some((number, part))
        })
    }

    /// Refuses the variants of a block that give the train a part that cannot be.
    pub(crate) fn train_block(&self, rows: Rows<'_>, status: &mut [u8]) {
        for (axis, input) in self.train_axes() {
            let mut values = [0.0; BLOCK];
            let values = &mut values[..status.len()];
            self.space.fill(axis, rows, values);
            for (status, value) in status.iter_mut().zip(values) {
                if *status == Status::Ok as u8
                    && let Some(error) = refusal(input, *value)
                {
                    *status = error.status() as u8;
                }
            }
        }
    }

    /// Why a variant gives the train a part that cannot be.
    pub(crate) fn explain_train(&self, variant: u64) -> Option<DesignError> {
        self.train_axes().find_map(|(axis, input)| {
            let mut value = [0.0];
            self.space.fill(axis, Rows::At(&[variant]), &mut value);
            refusal(input, value[0])
        })
    }
}
