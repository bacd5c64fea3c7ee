//! All inputs of one variant as an array of numbers, in the kernel's units.

use crate::model::design::Design;
use crate::model::inputs::{Input, SCALARS, SEGMENT_FIELDS, factor, segment_input};
use crate::model::shaft::SegmentKind;

/// All inputs of one variant, in the core's units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Inputs {
    scalars: [f64; SCALARS],
    segments: Vec<[f64; SEGMENT_FIELDS.len()]>,
    /// Place among all inputs of the shaft's diameter at the flange.
    flange: Option<usize>,
}

impl Inputs {
    /// The inputs of a design.
    pub(crate) fn of(design: &Design) -> Self {
        let value = |input| design.value(input) * factor(input);
        let kinds = design.segment_kinds();
        let fields = |segment| std::array::from_fn(|field| value(segment_input(segment, field)));
        Self {
            scalars: std::array::from_fn(value),
            segments: (0..kinds.len()).map(fields).collect(),
            flange: flange_input(&kinds),
        }
    }

    /// The shaft's diameter at the flange; NaN without a shaft.
    #[inline(always)]
    pub(crate) fn flange_diameter(&self) -> f64 {
        self.flange.map_or(f64::NAN, |input| self.at(input))
    }

    /// Place among all inputs of the shaft's diameter at the flange.
    pub(crate) const fn flange_input(&self) -> Option<usize> {
        self.flange
    }

    /// Value of a scalar input.
    #[inline(always)]
    pub(crate) const fn get(&self, input: Input) -> f64 {
        self.scalars[input as usize]
    }

    /// Value of the input at this position among all inputs.
    pub(crate) fn at(&self, input: usize) -> f64 {
        match input.checked_sub(SCALARS) {
            None => self.scalars[input],
            Some(k) => self.segments[k / SEGMENT_FIELDS.len()][k % SEGMENT_FIELDS.len()],
        }
    }

    /// Changes the input at this position among all inputs.
    #[inline(always)]
    pub(crate) fn set(&mut self, input: usize, value: f64) {
        match input.checked_sub(SCALARS) {
            None => self.scalars[input] = value,
            Some(k) => self.segments[k / SEGMENT_FIELDS.len()][k % SEGMENT_FIELDS.len()] = value,
        }
    }

    /// The shaft's segments: their inputs in the order of [`SEGMENT_FIELDS`].
    #[inline(always)]
    pub(crate) fn segments(&self) -> &[[f64; SEGMENT_FIELDS.len()]] {
        &self.segments
    }
}

/// Place among all inputs of the diameter at the flange of a shaft of these segments.
pub(crate) fn flange_input(kinds: &[SegmentKind]) -> Option<usize> {
    let last = kinds.last()?;
    Some(segment_input(kinds.len() - 1, last.flange_field()))
}
