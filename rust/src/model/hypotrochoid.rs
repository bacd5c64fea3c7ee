//! The path of a hole's centre and where it crosses the pins' pitch circle (paper section 4).

use nalgebra::{Rotation2, Vector2};

use crate::model::checks::Checks;
use crate::model::elementary::asin;
use crate::model::error::DesignError;

/// Unit vector at `angle` (rad), clockwise from ring pin 0.
#[inline]
#[must_use]
pub fn unit(angle: f64) -> Vector2<f64> {
    Rotation2::new(angle) * Vector2::x()
}

/// Centre (m) of the hole that stood at `hole_angle` (rad) when the mesh zone was at zero,
/// with the mesh zone now at `theta` (rad): `c = e u(theta) + R_OP u(phi - theta / i)`.
#[must_use]
pub fn hole_centre(
    eccentricity: f64,
    pin_circle_radius: f64,
    ratio: f64,
    hole_angle: f64,
    theta: f64,
) -> Vector2<f64> {
    eccentricity * unit(theta) + pin_circle_radius * unit(hole_angle - theta / ratio)
}

/// The angle delta = asin(e / (2 R_OP)) (rad) by which the active window of a hole falls short
/// of a half turn on each side.
///
/// The centre lies inside the pitch circle exactly when
/// `cos(theta (1 + 1/i) - phi) < -e / (2 R_OP)`.
///
/// Requires `e < 2 R_OP`.
#[inline(always)]
pub(crate) fn crossing_angle(
    eccentricity: f64,
    pin_circle_radius: f64,
    checks: &mut impl Checks,
) -> f64 {
    let ratio = eccentricity / (2.0 * pin_circle_radius);
    checks.require(ratio < 1.0, || DesignError::HoleNeverCrossesPitchCircle {
        ratio,
    });
    asin(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::checks::checked;

    #[test]
    fn a_centre_crosses_the_pitch_circle_where_the_window_opens() {
        let (e, radius, ratio, phi) = (0.00062, 0.045, 87.0, 0.7);
        let delta = checked(|checks| crossing_angle(e, radius, checks)).expect("crosses");
        let opening = (phi + std::f64::consts::FRAC_PI_2 + delta) * ratio / (ratio + 1.0);
        let at = |theta| hole_centre(e, radius, ratio, phi, theta).norm() - radius;
        approx::assert_abs_diff_eq!(at(opening), 0.0, epsilon = 1e-15);
        assert!(at(opening - 1e-6) > 0.0 && at(opening + 1e-6) < 0.0);
    }

    #[test]
    fn too_large_an_eccentricity_is_refused() {
        assert!(checked(|checks| crossing_angle(0.1, 0.05, checks)).is_err());
    }
}
