//! What of the shaft does not vary in a study, computed once.

use crate::kernel::lanes::{BLOCK, InputLanes, Lanes, Mask, Variant, for_each_lane};
use crate::kernel::packed::Inputs;
use crate::model::checks::{Checks, checked};
use crate::model::inputs::{Input, SEGMENT_FIELDS, segment_input};
use crate::model::shaft::{Segment, SegmentKind, shaft_scale, shoulder};

/// A shaft's segments, with what of Eq. (4) is the same for every variant.
///
/// Sums run over the same terms in the same order whatever is known: the bits do not depend on
/// what varies.
#[derive(Debug, Clone)]
pub(crate) struct ShaftPlan {
    segments: Vec<SegmentPlan>,
    /// The coefficient of the keyways, unless it varies or is refused.
    coefficient: Option<f64>,
    scale: Option<f64>,
}

/// What of one segment is the same for every variant that is not refused.
#[derive(Debug, Clone, Copy)]
struct SegmentPlan {
    kind: SegmentKind,
    factor: Option<f64>,
    shoulder: Option<f64>,
}

/// Place in [`SEGMENT_FIELDS`].
const DIAMETER: usize = 0;

impl ShaftPlan {
    /// The plan of a study whose unvaried inputs are `base`.
    pub(crate) fn new(
        kinds: &[SegmentKind],
        base: &Inputs,
        varies: impl Fn(usize) -> bool,
    ) -> Self {
        let scalar_varies = |input: Input| varies(input as usize);
        let known = |open: bool, value: Option<f64>| value.filter(|_| !open);
        let coefficient = base.get(Input::KeywayCoefficient);
        let coefficient_varies = scalar_varies(Input::KeywayCoefficient);
        let mut before = (f64::NAN, false);
        let mut segments = Vec::with_capacity(kinds.len());
        for (k, kind) in kinds.iter().enumerate() {
            let segment = segment(*kind, base.segments()[k]);
            let field_varies = |field| varies(segment_input(k, field));
            let any_varies = (0..SEGMENT_FIELDS.len()).any(field_varies) || coefficient_varies;
            let factor = checked(|checks| segment.factor(coefficient, checks)).ok();
            let shoulder = checked(|checks| shoulder(before.0, segment.diameter, checks)).ok();
            segments.push(SegmentPlan {
                kind: *kind,
                factor: known(any_varies, factor),
                shoulder: known(before.1 || field_varies(DIAMETER), shoulder),
            });
            before = (segment.flange_diameter(), field_varies(kind.flange_field()));
        }
        // Without a diameter before it there is no shoulder.
        if let Some(first) = segments.first_mut() {
            first.shoulder = Some(0.0);
        }
        let (modulus, poisson) = (Input::YoungsModulus, Input::PoissonRatio);
        let scale =
            checked(|checks| shaft_scale(base.get(modulus), base.get(poisson), checks)).ok();
        let checked = checked(|checks| checks.non_negative("keyway_coefficient", coefficient)).ok();
        Self {
            segments,
            coefficient: known(coefficient_varies, checked),
            scale: known(scalar_varies(modulus) || scalar_varies(poisson), scale),
        }
    }

    /// A plan in which nothing is known.
    pub(crate) fn open(kinds: &[SegmentKind]) -> Self {
        let open = |kind: &SegmentKind| SegmentPlan {
            kind: *kind,
            factor: None,
            shoulder: None,
        };
        Self {
            segments: kinds.iter().map(open).collect(),
            coefficient: None,
            scale: None,
        }
    }

    /// True for a drive that gives its stiffness instead of a shaft.
    pub(crate) const fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// Compliance C_OS^t (rad/(N m)) of the whole shaft, Eq. (4); NaN without a shaft.
    ///
    /// Requires what its segments require, on the way from the free end to the flange.
    #[inline]
    pub(crate) fn compliance(&self, inputs: &Inputs, checks: &mut impl Checks) -> f64 {
        let scale = self.scale.unwrap_or_else(|| scale(inputs, checks));
        let coefficient = self
            .coefficient
            .unwrap_or_else(|| coefficient(inputs, checks));
        let (mut sum, mut before) = (0.0, f64::NAN);
        for (plan, fields) in self.segments.iter().zip(inputs.segments()) {
            let segment = segment(plan.kind, *fields);
            let factor = plan
                .factor
                .unwrap_or_else(|| segment.factor(coefficient, checks));
            let shoulder = plan
                .shoulder
                .unwrap_or_else(|| shoulder(before, segment.diameter, checks));
            sum += factor + shoulder;
            before = segment.flange_diameter();
        }
        self.of_sum(scale, sum)
    }

    /// [`ShaftPlan::compliance`] of a block of variants.
    #[inline(always)]
    pub(crate) fn compliances(&self, inputs: &InputLanes, mask: &mut Mask, out: &mut Lanes) {
        let mut sum = [0.0; BLOCK];
        if self.coefficient.is_none() {
            for_each_lane!(inputs, mask, |_row, lane, checks| coefficient(lane, checks));
        }
        for (k, plan) in self.segments.iter().enumerate() {
            // One loop a case, so that none chooses within.
            if let (Some(factor), Some(shoulder)) = (plan.factor, plan.shoulder) {
                let term = factor + shoulder;
                for sum in &mut sum {
                    *sum += term;
                }
                continue;
            }
            let fields = &inputs.segments()[k];
            let mut factors = [plan.factor.unwrap_or_default(); BLOCK];
            if plan.factor.is_none() {
                match plan.kind {
                    SegmentKind::Cylinder => {
                        find_factors(SegmentKind::Cylinder, fields, inputs, mask, &mut factors);
                    }
                    SegmentKind::Frustum => {
                        find_factors(SegmentKind::Frustum, fields, inputs, mask, &mut factors);
                    }
                    SegmentKind::Keyway => {
                        find_factors(SegmentKind::Keyway, fields, inputs, mask, &mut factors);
                    }
                }
            }
            match (plan.shoulder, k.checked_sub(1)) {
                (None, Some(last)) => {
                    let before = &inputs.segments()[last][self.segments[last].kind.flange_field()];
                    for_each_lane!(inputs, mask, |row, _lane, checks| {
                        sum[row] +=
                            factors[row] + shoulder(before[row], fields[DIAMETER][row], checks);
                    });
                }
                (known, _) => {
                    let shoulder = known.unwrap_or_default();
                    for (sum, factor) in sum.iter_mut().zip(&factors) {
                        *sum += factor + shoulder;
                    }
                }
            }
        }
        if let Some(scale) = self.scale {
            for (out, sum) in out.iter_mut().zip(&sum) {
                *out = self.of_sum(scale, *sum);
            }
        } else {
            for_each_lane!(inputs, mask, |row, lane, checks| {
                out[row] = self.of_sum(scale(lane, checks), sum[row]);
            });
        }
    }

    #[inline(always)]
    const fn of_sum(&self, scale: f64, sum: f64) -> f64 {
        if self.is_empty() {
            f64::NAN
        } else {
            scale * sum
        }
    }
}

#[inline(always)]
fn find_factors(
    kind: SegmentKind,
    fields: &[Lanes; SEGMENT_FIELDS.len()],
    inputs: &InputLanes,
    mask: &mut Mask,
    factors: &mut Lanes,
) {
    for_each_lane!(inputs, mask, |row, lane, checks| {
        let [a, b, c, d] = fields;
        let segment = segment(kind, [a[row], b[row], c[row], d[row]]);
        factors[row] = segment.factor(lane.get(Input::KeywayCoefficient), checks);
    });
}

#[inline(always)]
fn scale(inputs: &impl Variant, checks: &mut impl Checks) -> f64 {
    let (modulus, poisson) = (Input::YoungsModulus, Input::PoissonRatio);
    shaft_scale(inputs.get(modulus), inputs.get(poisson), checks)
}

#[inline(always)]
fn coefficient(inputs: &impl Variant, checks: &mut impl Checks) -> f64 {
    checks.non_negative("keyway_coefficient", inputs.get(Input::KeywayCoefficient))
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
