//! What of the shaft does not vary in a study, computed once.

use crate::error::{DesignError, non_negative};
use crate::inputs::{Input, Inputs, SEGMENT_FIELDS, segment_input};
use crate::shaft::{Segment, SegmentKind, Term, shaft_scale};

/// A shaft's segments, with the terms of Eq. (4) that are the same for every variant.
///
/// Sums run over the same terms in the same order whatever is known: the bits do not depend on
/// what varies.
#[derive(Debug, Clone)]
pub struct ShaftPlan {
    segments: Vec<(SegmentKind, Option<Term>)>,
    scale: Option<f64>,
}

impl ShaftPlan {
    /// The plan of a study whose unvaried inputs are `base`.
    #[must_use]
    pub fn new(kinds: &[SegmentKind], base: &Inputs, varies: impl Fn(usize) -> bool) -> Self {
        let scalar_varies = |input: Input| varies(input as usize);
        let segment_varies = |k| (0..SEGMENT_FIELDS.len()).any(|f| varies(segment_input(k, f)));
        let coefficient = base.get(Input::KeywayCoefficient);
        let mut before = f64::NAN;
        let mut segments = Vec::with_capacity(kinds.len());
        for (k, kind) in kinds.iter().enumerate() {
            let segment = segment(*kind, base, k);
            let open = segment_varies(k)
                || (k > 0 && segment_varies(k - 1))
                || scalar_varies(Input::KeywayCoefficient);
            let term = Term::of(&segment, before, coefficient).ok();
            segments.push((*kind, term.filter(|_| !open)));
            before = segment.flange_diameter();
        }
        let open = scalar_varies(Input::YoungsModulus) || scalar_varies(Input::PoissonRatio);
        let scale = shaft_scale(
            base.get(Input::YoungsModulus),
            base.get(Input::PoissonRatio),
        );
        Self {
            segments,
            scale: scale.ok().filter(|_| !open),
        }
    }

    /// A plan in which nothing is known.
    #[must_use]
    pub fn open(kinds: &[SegmentKind]) -> Self {
        Self {
            segments: kinds.iter().map(|kind| (*kind, None)).collect(),
            scale: None,
        }
    }

    /// True for a drive that gives its stiffness instead of a shaft.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// Compliance C_OS^t (rad/(N m)) of the whole shaft, Eq. (4).
    ///
    /// # Errors
    /// The first [`DesignError`] met on the way from the free end to the flange.
    #[inline(always)]
    pub fn compliance(&self, inputs: &Inputs) -> Result<f64, DesignError> {
        let scale = match self.scale {
            Some(scale) => scale,
            None => shaft_scale(
                inputs.get(Input::YoungsModulus),
                inputs.get(Input::PoissonRatio),
            )?,
        };
        let coefficient = non_negative("keyway_coefficient", inputs.get(Input::KeywayCoefficient))?;
        let mut sum = 0.0;
        for (k, (kind, known)) in self.segments.iter().enumerate() {
            let term = match known {
                Some(term) => *term,
                None => {
                    let before = match k.checked_sub(1) {
                        Some(k) => segment(self.segments[k].0, inputs, k).flange_diameter(),
                        None => f64::NAN,
                    };
                    Term::of(&segment(*kind, inputs, k), before, coefficient)?
                }
            };
            sum += term.factor + term.shoulder;
        }
        Ok(scale * sum)
    }
}

#[inline(always)]
fn segment(kind: SegmentKind, inputs: &Inputs, k: usize) -> Segment {
    let [diameter, end_diameter, length, keyway_depth] = inputs.segments()[k];
    Segment {
        kind,
        diameter,
        end_diameter,
        length,
        keyway_depth,
    }
}
