//! What of the shaft does not vary in a study, computed once.

use crate::inputs::{Input, Inputs, SEGMENT_FIELDS, segment_input};
use crate::judge::{Judge, judged};
use crate::lanes::{BLOCK, InputLanes, Lanes, Mask, Variant, for_each_lane};
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
            let segment = segment(*kind, base.segments()[k]);
            let open = segment_varies(k)
                || (k > 0 && segment_varies(k - 1))
                || scalar_varies(Input::KeywayCoefficient);
            let term = judged(|judge| Term::of(&segment, before, coefficient, judge)).ok();
            segments.push((*kind, term.filter(|_| !open)));
            before = segment.flange_diameter();
        }
        let open = scalar_varies(Input::YoungsModulus) || scalar_varies(Input::PoissonRatio);
        let scale = judged(|judge| {
            shaft_scale(
                base.get(Input::YoungsModulus),
                base.get(Input::PoissonRatio),
                judge,
            )
        });
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

    /// Compliance C_OS^t (rad/(N m)) of the whole shaft, Eq. (4); NaN without a shaft.
    ///
    /// Requires what its segments require, on the way from the free end to the flange.
    #[inline]
    pub fn compliance(&self, inputs: &Inputs, judge: &mut impl Judge) -> f64 {
        let (scale, coefficient) = self.scale_and_coefficient(inputs, judge);
        let mut sum = 0.0;
        for (k, (kind, known)) in self.segments.iter().enumerate() {
            let term = known.unwrap_or_else(|| {
                let fields = inputs.segments();
                let before = k.checked_sub(1).map_or(f64::NAN, |k| {
                    segment(self.segments[k].0, fields[k]).flange_diameter()
                });
                Term::of(&segment(*kind, fields[k]), before, coefficient, judge)
            });
            sum += term.factor + term.shoulder;
        }
        self.of_sum(scale, sum)
    }

    /// [`ShaftPlan::compliance`] of a block of variants.
    #[inline(always)]
    pub fn compliances(&self, inputs: &InputLanes, mask: &mut Mask, out: &mut Lanes) {
        let mut sum = [0.0; BLOCK];
        for (k, (kind, known)) in self.segments.iter().enumerate() {
            match known {
                Some(term) => {
                    let term = term.factor + term.shoulder;
                    for sum in &mut sum {
                        *sum += term;
                    }
                }
                // One loop a kind, so that none chooses within.
                None => match kind {
                    SegmentKind::Cylinder => {
                        self.add_term(SegmentKind::Cylinder, k, inputs, mask, &mut sum);
                    }
                    SegmentKind::Frustum => {
                        self.add_term(SegmentKind::Frustum, k, inputs, mask, &mut sum);
                    }
                    SegmentKind::Keyway => {
                        self.add_term(SegmentKind::Keyway, k, inputs, mask, &mut sum);
                    }
                },
            }
        }
        for_each_lane!(inputs, mask, |row, lane, judge| {
            let (scale, _) = self.scale_and_coefficient(lane, judge);
            out[row] = self.of_sum(scale, sum[row]);
        });
    }

    #[inline(always)]
    fn add_term(
        &self,
        kind: SegmentKind,
        k: usize,
        inputs: &InputLanes,
        mask: &mut Mask,
        sum: &mut Lanes,
    ) {
        const NOTHING: Lanes = [f64::NAN; BLOCK];
        let fields = inputs.segments();
        let before = match k.checked_sub(1) {
            None => &NOTHING,
            Some(k) => &fields[k][usize::from(self.segments[k].0.tapers())],
        };
        let fields = &fields[k];
        for_each_lane!(inputs, mask, |row, lane, judge| {
            let fields = [
                fields[0][row],
                fields[1][row],
                fields[2][row],
                fields[3][row],
            ];
            let coefficient = lane.get(Input::KeywayCoefficient);
            let term = Term::of(&segment(kind, fields), before[row], coefficient, judge);
            sum[row] += term.factor + term.shoulder;
        });
    }

    #[inline(always)]
    fn scale_and_coefficient(
        &self,
        inputs: &impl Variant,
        judge: &mut impl Judge,
    ) -> (f64, f64) {
        let scale = match self.scale {
            Some(scale) => scale,
            None => shaft_scale(
                inputs.get(Input::YoungsModulus),
                inputs.get(Input::PoissonRatio),
                judge,
            ),
        };
        let coefficient = inputs.get(Input::KeywayCoefficient);
        (
            scale,
            judge.non_negative("keyway_coefficient", coefficient),
        )
    }

    #[inline(always)]
    fn of_sum(&self, scale: f64, sum: f64) -> f64 {
        if self.is_empty() {
            f64::NAN
        } else {
            scale * sum
        }
    }
}

#[inline(always)]
fn segment(kind: SegmentKind, fields: [f64; SEGMENT_FIELDS.len()]) -> Segment {
    let [diameter, end_diameter, length, keyway_depth] = fields;
    Segment {
        kind,
        diameter,
        end_diameter,
        length,
        keyway_depth,
    }
}
