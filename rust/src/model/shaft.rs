//! Torsional compliance of the output shaft, segment by segment (Eqs. 4-7).

use std::f64::consts::PI;

use crate::model::checks::{Checks, checked};
use crate::model::error::DesignError;

/// What a segment of the shaft is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SegmentKind {
    /// Cylinder with a keyway, Eq. (5).
    Keyway,
    /// Plain cylinder.
    Cylinder,
    /// Frustum of a cone, Eq. (7).
    Frustum,
}

impl SegmentKind {
    /// True where the diameter at the flange end is another than at the free end.
    #[inline(always)]
    #[must_use]
    pub const fn tapers(self) -> bool {
        matches!(self, SegmentKind::Frustum)
    }

    /// Place among a segment's fields of the diameter at the flange end.
    #[inline(always)]
    #[must_use]
    pub(crate) const fn flange_field(self) -> usize {
        if self.tapers() { 1 } else { 0 }
    }
}

/// One segment, counted from the shaft's free end to the flange. Lengths in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// What it is.
    pub kind: SegmentKind,
    /// Diameter at the free end (m).
    pub diameter: f64,
    /// Diameter at the flange end (m); read for a frustum only.
    pub end_diameter: f64,
    /// Length (m).
    pub length: f64,
    /// Depth of the keyway (m); read for a keyway only.
    pub keyway_depth: f64,
}

impl Segment {
    /// Diameter at the flange end (m).
    #[inline(always)]
    #[must_use]
    pub fn flange_diameter(&self) -> f64 {
        if self.kind.tapers() {
            self.end_diameter
        } else {
            self.diameter
        }
    }

    /// The geometric factor of the segment's compliance: `c = 32 / (pi G) * factor` (1/m^3).
    ///
    /// Requires dimensions above zero and a keyway that does not reach the axis.
    #[inline(always)]
    pub(crate) fn factor(&self, keyway_coefficient: f64, checks: &mut impl Checks) -> f64 {
        let diameter = checks.positive("shaft diameter", self.diameter);
        let length = checks.positive("shaft length", self.length);
        match self.kind {
            SegmentKind::Cylinder => length / fourth(diameter),
            SegmentKind::Frustum => {
                let end = checks.positive("shaft end diameter", self.end_diameter);
                frustum_factor(length, diameter, end)
            }
            SegmentKind::Keyway => {
                let depth = checks.non_negative("keyway depth", self.keyway_depth);
                checks.require(depth < 0.5 * diameter, || DesignError::KeywayTooDeep {
                    depth,
                    diameter,
                });
                keyway_factor(length, diameter, depth, keyway_coefficient)
            }
        }
    }
}

#[inline(always)]
fn cube(x: f64) -> f64 {
    x * x * x
}

#[inline(always)]
fn fourth(x: f64) -> f64 {
    (x * x) * (x * x)
}

/// Eq. (5) without 32/(pi G): `(l + k h l / D) / D^4`.
///
/// A reading of the print: the form is 85 % sure, k = 10 about 75 %. A Saint-Venant torsion
/// solution of standard keyways gives k of about 1.2 to 1.3 on the same depth.
#[inline(always)]
#[must_use]
pub fn keyway_factor(length: f64, diameter: f64, depth: f64, coefficient: f64) -> f64 {
    length * (diameter + coefficient * depth) / (fourth(diameter) * diameter)
}

/// Eq. (7) without 32/(pi G): `l / (3 d^3 D) (1 + d/D + (d/D)^2)`, the integral of dl / D(l)^4.
#[inline(always)]
#[must_use]
pub fn frustum_factor(length: f64, diameter: f64, end_diameter: f64) -> f64 {
    let squares = end_diameter * end_diameter + end_diameter * diameter + diameter * diameter;
    length * squares / (3.0 * cube(diameter * end_diameter))
}

/// The shoulder's term of Eq. (6) without 32/(pi G): `(1 - (d/D)^3) / (8 d^3)` for d <= D.
///
/// A reading of the print, 95 % sure.
#[inline(always)]
#[must_use]
pub fn shoulder_factor(diameter: f64, larger_diameter: f64) -> f64 {
    (cube(larger_diameter) - cube(diameter)) / (8.0 * cube(diameter * larger_diameter))
}

/// Eq. (6) without 32/(pi G): `l1 / d^4 + l2 / D^4 + shoulder` for d < D.
///
/// # Errors
/// [`DesignError::ShaftStepNotAscending`] when d > D.
pub fn step_factor(l1: f64, diameter: f64, l2: f64, larger: f64) -> Result<f64, DesignError> {
    let step = |length, diameter| Segment {
        kind: SegmentKind::Cylinder,
        diameter,
        end_diameter: diameter,
        length,
        keyway_depth: 0.0,
    };
    shaft_factor([step(l1, diameter), step(l2, larger)], 0.0)
}

/// What one segment adds to Eq. (4), without 32/(pi G): its own factor, and the shoulder of
/// Eq. (6) where the diameter rises onto it (zero elsewhere).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Term {
    /// The segment's factor (1/m^3).
    pub factor: f64,
    /// The shoulder before it (1/m^3).
    pub shoulder: f64,
}

impl Term {
    /// The terms of a segment that follows a diameter of `before` (m); NaN for the first.
    ///
    /// Requires what the segment requires, and a diameter that does not fall on the way to the
    /// flange.
    #[inline(always)]
    pub(crate) fn of(
        segment: &Segment,
        before: f64,
        keyway_coefficient: f64,
        checks: &mut impl Checks,
    ) -> Self {
        Self {
            factor: segment.factor(keyway_coefficient, checks),
            shoulder: shoulder(before, segment.diameter, checks),
        }
    }
}

/// The shoulder's term where the diameter rises from `before` to `after`, zero where it stays.
///
/// Requires that it does not fall.
#[inline(always)]
pub(crate) fn shoulder(before: f64, after: f64, checks: &mut impl Checks) -> f64 {
    let falls = after < before;
    checks.require(!falls, || DesignError::ShaftStepNotAscending {
        from: before,
        to: after,
    });
    let shoulder = shoulder_factor(before, after);
    if after > before { shoulder } else { 0.0 }
}

/// Eq. (4) without 32/(pi G): the segments in series, with the shoulder of Eq. (6) wherever the
/// diameter rises from one to the next. Each length counts once.
///
/// # Errors
/// The first [`DesignError`]: a dimension that is not above zero, a keyway that reaches the axis, a
/// diameter that falls.
pub fn shaft_factor(
    segments: impl IntoIterator<Item = Segment>,
    keyway_coefficient: f64,
) -> Result<f64, DesignError> {
    checked(|checks| {
        let (mut sum, mut before) = (0.0, f64::NAN);
        for segment in segments {
            let term = Term::of(&segment, before, keyway_coefficient, checks);
            sum += term.factor + term.shoulder;
            before = segment.flange_diameter();
        }
        sum
    })
}

/// Shear modulus (Pa) of an isotropic solid, `E / (2 (1 + nu))`.
///
/// Requires a modulus above zero and a Poisson's ratio within (-1, 0.5].
#[inline(always)]
pub(crate) fn shear_modulus(youngs_modulus: f64, poisson: f64, checks: &mut impl Checks) -> f64 {
    let modulus = checks.positive("youngs_modulus", youngs_modulus);
    let poisson = checks.finite("poisson_ratio", poisson);
    checks.require((poisson > -1.0) & (poisson <= 0.5), || {
        DesignError::PoissonOutOfRange { poisson }
    });
    modulus / (2.0 * (1.0 + poisson))
}

/// `32 / (pi G)` (m^2/N), which turns the factors into compliances; see [`shear_modulus`].
#[inline(always)]
pub(crate) fn shaft_scale(youngs_modulus: f64, poisson: f64, checks: &mut impl Checks) -> f64 {
    32.0 / (PI * shear_modulus(youngs_modulus, poisson, checks))
}

/// Compliance C_OS^t (rad/(N m)) of the whole shaft.
///
/// # Errors
/// The first [`DesignError`]: of the modulus, of Poisson's ratio, or of [`shaft_factor`].
pub fn shaft_compliance(
    segments: impl IntoIterator<Item = Segment>,
    youngs_modulus: f64,
    poisson: f64,
    keyway_coefficient: f64,
) -> Result<f64, DesignError> {
    let (scale, coefficient) = checked(|checks| {
        (
            shaft_scale(youngs_modulus, poisson, checks),
            checks.non_negative("keyway_coefficient", keyway_coefficient),
        )
    })?;
    Ok(scale * shaft_factor(segments, coefficient)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn cylinder(diameter: f64, length: f64) -> Segment {
        Segment {
            kind: SegmentKind::Cylinder,
            diameter,
            end_diameter: f64::NAN,
            length,
            keyway_depth: f64::NAN,
        }
    }

    #[test]
    fn frustum_is_the_integral_of_its_slices() {
        let (length, d, big, slices) = (0.03, 0.05, 0.08, 20_000);
        let sum: f64 = (0..slices)
            .map(|k| d + (big - d) * (f64::from(k) + 0.5) / f64::from(slices))
            .map(|local| length / f64::from(slices) / local.powi(4))
            .sum();
        assert_relative_eq!(frustum_factor(length, d, big), sum, max_relative = 1e-8);
    }

    #[test]
    fn a_frustum_of_one_diameter_is_a_cylinder() {
        assert_relative_eq!(
            frustum_factor(0.02, 0.05, 0.05),
            0.02 / 0.05_f64.powi(4),
            max_relative = 1e-14
        );
    }

    #[test]
    fn a_step_is_two_cylinders_and_a_shoulder_that_vanishes_as_d_approaches_the_larger() {
        let both = step_factor(0.02, 0.05, 0.03, 0.06).expect("ascending");
        let plain = 0.02 / 0.05_f64.powi(4) + 0.03 / 0.06_f64.powi(4);
        assert_relative_eq!(
            both - plain,
            shoulder_factor(0.05, 0.06),
            max_relative = 1e-10
        );
        let limit = step_factor(0.02, 0.06 * (1.0 - 1e-12), 0.03, 0.06).expect("ascending");
        assert_relative_eq!(limit, 0.05 / 0.06_f64.powi(4), max_relative = 1e-9);
    }

    #[test]
    fn a_keyway_without_depth_is_a_cylinder() {
        assert_relative_eq!(
            keyway_factor(0.06, 0.05, 0.0, 10.0),
            0.06 / 0.05_f64.powi(4),
            max_relative = 1e-15
        );
    }

    #[test]
    fn splitting_a_segment_changes_nothing() {
        let whole = shaft_factor([cylinder(0.05, 0.07)], 10.0).expect("valid");
        let split =
            shaft_factor([cylinder(0.05, 0.03), cylinder(0.05, 0.04)], 10.0).expect("valid");
        assert_relative_eq!(whole, split, max_relative = 1e-14);
    }

    #[test]
    fn a_falling_step_and_a_deep_keyway_are_refused() {
        let falling = shaft_factor([cylinder(0.06, 0.03), cylinder(0.05, 0.03)], 10.0);
        assert!(matches!(
            falling,
            Err(DesignError::ShaftStepNotAscending { .. })
        ));
        let deep = Segment {
            kind: SegmentKind::Keyway,
            keyway_depth: 0.03,
            ..cylinder(0.05, 0.03)
        };
        assert!(matches!(
            checked(|checks| deep.factor(10.0, checks)),
            Err(DesignError::KeywayTooDeep { .. })
        ));
    }
}
