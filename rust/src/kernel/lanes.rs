//! Blocks of variants, one array a quantity.
//!
//! Formulas over lanes are plain loops without branches. The compiler turns them into vector
//! instructions twice, see [`crate::wide`].

use crate::kernel::packed::Inputs;
use crate::model::inputs::{Input, SCALARS, SEGMENT_FIELDS};

/// Variants computed together: their stages stay in the cache.
pub(crate) const BLOCK: usize = 128;

/// One quantity of every variant of a block.
pub(crate) type Lanes = [f64; BLOCK];

/// For each variant of a block, whether its formulas hold (one) or it has to be looked at alone.
pub(crate) type Mask = [u64; BLOCK];

/// The inputs of one variant, whether it stands alone or in a block.
pub(crate) trait Variant {
    /// Value of a scalar input, in the core's unit.
    fn get(&self, input: Input) -> f64;
    /// sin(pi / N_OP), where the number of pins is one that a design may have.
    fn half_pitch_sine(&self) -> f64;
    /// The shaft's diameter at the flange, in the core's unit; NaN without a shaft.
    fn flange_diameter(&self) -> f64;
}

/// The inputs of a block of variants.
pub(crate) struct InputLanes {
    scalars: Box<[Lanes; SCALARS]>,
    segments: Vec<[Lanes; SEGMENT_FIELDS.len()]>,
    half_pitch_sines: Box<[Lanes; 1]>,
    /// Place among all inputs of the shaft's diameter at the flange.
    flange: Option<usize>,
    no_flange: Box<[Lanes; 1]>,
}

/// For each value a lane of it.
fn alike<const N: usize>(values: [f64; N]) -> Box<[Lanes; N]> {
    let lanes: Vec<Lanes> = values.iter().map(|value| [*value; BLOCK]).collect();
    lanes
        .try_into()
        .unwrap_or_else(|_| Box::new(values.map(|value| [value; BLOCK])))
}

/// One variant of a block.
#[derive(Clone, Copy)]
pub(crate) struct Lane<'a> {
    scalars: &'a [Lanes; SCALARS],
    half_pitch_sines: &'a Lanes,
    flange: &'a Lanes,
    row: usize,
}

impl InputLanes {
    /// A block of variants that are all alike.
    pub(crate) fn new(inputs: &Inputs) -> Self {
        let mut lanes = Self {
            scalars: alike(Input::ALL.map(|input| inputs.get(input))),
            segments: inputs
                .segments()
                .iter()
                .map(|fields| fields.map(|value| [value; BLOCK]))
                .collect(),
            half_pitch_sines: alike([0.0]),
            flange: inputs.flange_input(),
            no_flange: alike([f64::NAN]),
        };
        lanes.find_half_pitch_sines();
        lanes
    }

    /// The lanes of the input at this position among all inputs.
    #[inline(always)]
    pub(crate) fn at_mut(&mut self, input: usize) -> &mut Lanes {
        match input.checked_sub(SCALARS) {
            None => &mut self.scalars[input],
            Some(k) => &mut self.segments[k / SEGMENT_FIELDS.len()][k % SEGMENT_FIELDS.len()],
        }
    }

    /// The lanes of the input at this position among all inputs.
    #[inline(always)]
    fn lanes(&self, input: usize) -> &Lanes {
        match input.checked_sub(SCALARS) {
            None => &self.scalars[input],
            Some(k) => &self.segments[k / SEGMENT_FIELDS.len()][k % SEGMENT_FIELDS.len()],
        }
    }

    /// The value of one variant's input at this position among all inputs.
    pub(crate) fn at(&self, input: usize, row: usize) -> f64 {
        self.lanes(input)[row]
    }

    /// To be called after the numbers of pins have changed.
    #[inline(always)]
    pub(crate) fn find_half_pitch_sines(&mut self) {
        let sines = &half_pitch::SINES.0;
        let pins = &self.scalars[Input::OutputPinCount as usize];
        for (sine, pins) in self.half_pitch_sines[0].iter_mut().zip(pins) {
            *sine = sines[half_pitch::place(*pins)];
        }
    }

    /// The fields of every segment of the shaft.
    #[inline(always)]
    pub(crate) fn segments(&self) -> &[[Lanes; SEGMENT_FIELDS.len()]] {
        &self.segments
    }

    /// The first variant of the block.
    #[inline(always)]
    pub(crate) fn first(&self) -> Lane<'_> {
        Lane {
            scalars: &self.scalars,
            half_pitch_sines: &self.half_pitch_sines[0],
            flange: self
                .flange
                .map_or(&self.no_flange[0], |input| self.lanes(input)),
            row: 0,
        }
    }
}

/// A formula for every variant of a block; clears the mask where not all it requires holds.
///
/// A macro, not a function of a closure: a closure cannot be forced into the loop, and a call
/// there keeps the loop from becoming vector instructions.
macro_rules! for_each_lane {
    ($inputs:expr, $mask:expr, |$row:ident, $lane:ident, $checks:ident| $formula:expr) => {
        // Where the inputs lie is found once, not in every turn.
        let first = $inputs.first();
        for (row, holds) in $mask.iter_mut().enumerate() {
            let ($row, $lane) = (row, &first.at(row));
            let mut checks = $crate::model::checks::AllPass(true);
            let $checks = &mut checks;
            $formula;
            *holds &= u64::from(checks.0);
        }
    };
}
pub(crate) use for_each_lane;

impl<'a> Lane<'a> {
    /// The variant at another place of the block.
    #[inline(always)]
    pub(crate) const fn at(&self, row: usize) -> Lane<'a> {
        Lane { row, ..*self }
    }
}

impl Variant for Lane<'_> {
    #[inline(always)]
    fn get(&self, input: Input) -> f64 {
        self.scalars[input as usize][self.row]
    }

    #[inline(always)]
    fn half_pitch_sine(&self) -> f64 {
        self.half_pitch_sines[self.row]
    }

    #[inline(always)]
    fn flange_diameter(&self) -> f64 {
        self.flange[self.row]
    }
}

impl Variant for Inputs {
    #[inline(always)]
    fn get(&self, input: Input) -> f64 {
        Self::get(self, input)
    }

    fn half_pitch_sine(&self) -> f64 {
        half_pitch::SINES.0[half_pitch::place(Self::get(self, Input::OutputPinCount))]
    }

    fn flange_diameter(&self) -> f64 {
        Self::flange_diameter(self)
    }
}

/// sin(pi / N) for every allowed number of pins.
mod half_pitch {
    use std::sync::LazyLock;

    const PLACES: usize = 128;

    pub(super) struct Sines(pub [f64; PLACES]);
    pub(super) static SINES: LazyLock<Sines> = LazyLock::new(|| {
        Sines(std::array::from_fn(|n| {
            (std::f64::consts::PI / n.max(1) as f64).sin()
        }))
    });

    /// A whole number from 0 to 127 as a place in the table; any other number as some place.
    #[inline(always)]
    pub(super) fn place(pins: f64) -> usize {
        // 2^52 shifts the units to the last bit.
        (pins + 4_503_599_627_370_496.0).to_bits() as usize % PLACES
    }
}
