//! The definition of a study: a base design, the space over which it varies, loads and limits.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use thiserror::Error;

use crate::components::inputs::{PART_INPUTS, PARTS_AT};
use crate::kernel::blocks::{Stages, explained};
use crate::kernel::outputs::Output;
use crate::kernel::packed::Inputs;
use crate::model::active_pins::Criterion;
use crate::model::design::Design;
use crate::model::error::DesignError;
use crate::model::inputs::{Input, factor};
use crate::model::shaft::SegmentKind;
use crate::sampling::{Rows, Space};

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

/// Why a study cannot be.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StudyError {
    /// A load is no number.
    #[error("loads_tn: found {load}, expected finite numbers")]
    LoadNotFinite {
        /// The load found.
        load: f64,
    },
    /// Variants beyond the study's last one are asked for.
    #[error("variants up to number {last} of {variants}")]
    NoSuchVariant {
        /// Number of the last one asked for.
        last: u64,
        /// Variants of the study.
        variants: u64,
    },
    /// An axis that the study does not have is asked for.
    #[error("no axis number {axis} in a study of {axes} axes")]
    NoSuchAxis {
        /// Place of the axis.
        axis: usize,
        /// Axes of the study.
        axes: usize,
    },
    /// The memory to write to has another shape than the rows and columns asked for.
    #[error("{found} rows or columns to write to, expected {expected}")]
    Shape {
        /// How many are needed.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// An axis or a limit is on an input that the design does not have.
    #[error("no input number {input} in a design of {inputs} inputs")]
    NoSuchInput {
        /// Place of the input.
        input: usize,
        /// Inputs of the design.
        inputs: usize,
    },
    /// A limit is on the twist at a load that the study does not have.
    #[error("no load number {load} in a study of {loads} loads")]
    NoSuchLoad {
        /// Place of the load.
        load: usize,
        /// Loads of the study.
        loads: usize,
    },
}

/// The definition of a study, ready to evaluate.
pub struct Study {
    pub(crate) space: Space,
    pub(crate) base: Inputs,
    pub(crate) kinds: Vec<SegmentKind>,
    pub(crate) loads: Vec<f64>,
    pub(crate) limits: Vec<Limit>,
    pub(crate) stages: OnceLock<Stages>,
    pub(crate) evaluated: AtomicU64,
}

impl std::fmt::Debug for Study {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Study")
            .field("space", &self.space)
            .field("base", &self.base)
            .field("kinds", &self.kinds)
            .field("loads", &self.loads)
            .field("limits", &self.limits)
            .finish_non_exhaustive()
    }
}

impl Study {
    /// A study of a base design varied over `space`.
    ///
    /// # Errors
    /// [`StudyError`] when an axis or a limit is on an input or a load that the design or the study
    /// does not have, or a load is no number.
    pub fn new(
        space: Space,
        base: &Design,
        loads: Vec<f64>,
        limits: Vec<Limit>,
    ) -> Result<Self, StudyError> {
        let inputs = base.input_count();
        let limited = limits.iter().filter_map(|limit| match limit.column {
            Limited::Input(input) => Some(input),
            Limited::Output(_) => None,
        });
        let mut named = space.axes().iter().map(|axis| axis.input).chain(limited);
        // The component model's inputs are a band of their own.
        let parts = PARTS_AT..PARTS_AT + PART_INPUTS;
        let varies = |input| space.axes().iter().any(|axis| axis.input == input);
        let unknown =
            |input: &usize| *input >= inputs && !(parts.contains(input) && varies(*input));
        if let Some(input) = named.find(unknown) {
            return Err(StudyError::NoSuchInput { input, inputs });
        }
        if let Some(load) = loads.iter().find(|load| !load.is_finite()) {
            return Err(StudyError::LoadNotFinite { load: *load });
        }
        let (base, kinds) = (Inputs::of(base), base.segment_kinds());
        let (stages, evaluated) = (OnceLock::new(), AtomicU64::new(0));
        let study = Self {
            space,
            base,
            kinds,
            loads,
            limits,
            stages,
            evaluated,
        };
        for limit in &study.limits {
            if let Limited::Output(output) = limit.column {
                study.check_load(output)?;
            }
        }
        Ok(study)
    }

    /// Requires that the load of a twist is one of the study's.
    pub(crate) fn check_load(&self, output: Output) -> Result<(), StudyError> {
        match output {
            Output::Twist(load) if load >= self.loads.len() => {
                let loads = self.loads.len();
                Err(StudyError::NoSuchLoad { load, loads })
            }
            _ => Ok(()),
        }
    }

    /// Whether a column may be NaN for a variant that can be built: without an inertia or a shaft,
    /// and what rests on statics for more than two discs.
    #[must_use]
    pub fn may_not_apply(&self, output: Output) -> bool {
        let axes = self.space.axes();
        let may_be = |input: Input, is: fn(f64) -> bool| {
            let varies = axes.iter().any(|axis| axis.input == input as usize);
            varies || is(self.base.get(input))
        };
        let beyond_statics = may_be(Input::DiscCount, |discs| discs > 2.0);
        let by_statics = may_be(Input::Criterion, |code| {
            code >= f64::from(Criterion::Statics as u8)
        });
        match output {
            Output::ShaftCompliance => self.kinds.is_empty(),
            Output::PinParticipationStatics | Output::OutputComplianceStatics => beyond_statics,
            Output::NaturalFrequency | Output::NaturalFrequencyWithEfficiency => {
                may_be(Input::InputInertia, f64::is_nan) || (beyond_statics && by_statics)
            }
            Output::OutputCompliance
            | Output::ReflectedCompliance
            | Output::ReflectedStiffness
            | Output::OutputStiffness
            | Output::Twist(_) => beyond_statics && by_statics,
            _ => false,
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

    /// Value of an input where it does not vary, in the core's unit.
    pub(crate) const fn base_value(&self, input: Input) -> f64 {
        self.base.get(input)
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

    /// Why one variant cannot be built, with its numbers; limits are not looked at.
    #[must_use]
    pub fn explain(&self, variant: u64) -> Option<DesignError> {
        let mut inputs = self.base.clone();
        for (number, axis) in self.space.axes().iter().enumerate() {
            let mut value = [0.0];
            if axis.input >= PARTS_AT {
                continue;
            }
            self.space.fill(number, Rows::At(&[variant]), &mut value);
            inputs.set(axis.input, value[0] * factor(axis.input));
        }
        explained(&inputs, &self.kinds).or_else(|| self.explain_train(variant))
    }
}

/// Whether a design can be built.
///
/// # Errors
/// The first reason why it cannot.
pub fn check(design: &Design) -> Result<(), DesignError> {
    explained(&Inputs::of(design), &design.segment_kinds()).map_or(Ok(()), Err)
}
