//! One output pin as a short cantilever: deflection, compliance about the drive's axis, stress
//! (Eqs. 8-10).

use std::f64::consts::PI;

use crate::model::checks::{Checks, checked};
use crate::model::error::DesignError;

/// A round, possibly hollow, cantilevered pin. SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// Outer diameter (m).
    pub diameter: f64,
    /// Diameter of the bore (m), zero for a solid pin.
    pub bore: f64,
    /// Free length from the flange to the force (m).
    pub length: f64,
}

impl Pin {
    /// Whether the pin can be made.
    ///
    /// # Errors
    /// The first [`DesignError`]: a dimension below its limit or a bore without a wall around it.
    pub fn check(&self) -> Result<(), DesignError> {
        checked(|checks| self.require(checks))
    }

    /// Requires a pin that can be made.
    #[inline(always)]
    pub(crate) fn require(&self, checks: &mut impl Checks) {
        let (bore, diameter) = (self.bore, self.diameter);
        checks.positive("output_pin_diameter", diameter);
        checks.non_negative("output_pin_bore", bore);
        checks.positive("output_pin_length", self.length);
        checks.require(bore < diameter, || DesignError::PinBoreTooLarge {
            bore,
            diameter,
        });
    }

    /// Second moment of area (m^4).
    #[inline]
    #[must_use]
    pub fn second_moment(&self) -> f64 {
        PI * (self.diameter.powi(4) - self.bore.powi(4)) / 64.0
    }

    /// Deflection under a unit force at the free end (m/N), after Timoshenko:
    /// `L^3 / (3 E I) + L / (kappa G A)`.
    ///
    /// The flexibility of the flange at the pin's root is not in it.
    #[inline(always)]
    #[must_use]
    pub fn flexibility(&self, youngs_modulus: f64, poisson: f64) -> f64 {
        // Both terms over their common denominator: one division instead of seven.
        let (outer, inner) = (self.diameter * self.diameter, self.bore * self.bore);
        let sum = outer + inner;
        let bending = 16.0 * self.length * self.length * sum;
        let shear = (7.0 + 6.0 * poisson) * (sum * sum) + (20.0 + 12.0 * poisson) * (outer * inner);
        let below = 3.0 * PI * youngs_modulus * (sum * sum) * (outer - inner);
        4.0 * self.length * (bending + shear) / below
    }

    /// Stress at the root (Pa) under `force` (N): `F L / W`, W = pi (d^4 - b^4) / (32 d).
    #[inline(always)]
    #[must_use]
    pub fn root_stress(&self, force: f64) -> f64 {
        let (outer, inner) = (self.diameter * self.diameter, self.bore * self.bore);
        let below = PI * (outer * outer - inner * inner);
        32.0 * force * self.length * self.diameter / below
    }
}

/// Cowper's shear coefficient of a round section whose bore is `m` times its diameter
/// (G. R. Cowper, J. Appl. Mech. 33 (1966) 335-340); `6 (1 + nu) / (7 + 6 nu)` when solid.
#[inline]
#[must_use]
pub fn cowper(m: f64, poisson: f64) -> f64 {
    let square = (1.0 + m * m) * (1.0 + m * m);
    6.0 * (1.0 + poisson) * square
        / ((7.0 + 6.0 * poisson) * square + (20.0 + 12.0 * poisson) * m * m)
}

/// Compliance C_OP (rad/(N m)) of one pin about the drive's axis, Eqs. (8)-(10):
/// `delta / (F R^2)` with `flexibility = delta / F`.
///
/// The paper's pin is linear over its loads (Fig. 13), so the arc tangent of Eq. (8) is replaced by
/// its argument: the compliance depends on no rating.
#[inline(always)]
#[must_use]
pub fn pin_compliance(flexibility: f64, pin_circle_radius: f64) -> f64 {
    flexibility / (pin_circle_radius * pin_circle_radius)
}

/// Torque T_O* (N m) of one pin under the output torque, Eqs. (1) and (2): the torque over the mean
/// number of active hole-pin contacts, which for two discs is `T_O / (eta_OP N_OP)`.
#[inline(always)]
#[must_use]
pub fn torque_per_pin(output_torque: f64, active_mean: f64) -> f64 {
    output_torque / active_mean
}

/// Force F_n (N) of a pin that carries `torque_per_pin` (N m) on its circle, Eq. (9).
#[inline(always)]
#[must_use]
pub fn force_per_pin(torque_per_pin: f64, pin_circle_radius: f64) -> f64 {
    torque_per_pin / pin_circle_radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn cowper_of_a_solid_circle_and_of_a_thin_tube() {
        assert_relative_eq!(cowper(0.0, 0.3), 0.886_363_636, max_relative = 1e-8);
        assert_relative_eq!(
            cowper(1.0, 0.3),
            2.0 * 1.3 / (4.0 + 3.0 * 0.3),
            max_relative = 1e-12
        );
    }

    #[test]
    fn the_common_denominator_changes_nothing() {
        for bore in [0.0, 0.004, 0.012] {
            let (d, length, e, nu) = (0.016_f64, 0.04_f64, 206e9, 0.3);
            let pin = Pin {
                diameter: d,
                bore,
                length,
            };
            let bending = length.powi(3) / (3.0 * e * pin.second_moment());
            let (shear, area) = (e / (2.0 * (1.0 + nu)), PI * (d * d - bore * bore) / 4.0);
            let terms = bending + length / (cowper(bore / d, nu) * shear * area);
            assert_relative_eq!(pin.flexibility(e, nu), terms, max_relative = 1e-14);
        }
    }

    #[test]
    fn a_slender_pin_bends_as_euler_says() {
        let pin = Pin {
            diameter: 0.001,
            bore: 0.0,
            length: 1.0,
        };
        let euler = 1.0 / (3.0 * 206e9 * pin.second_moment());
        assert_relative_eq!(pin.flexibility(206e9, 0.3), euler, max_relative = 1e-5);
    }

    #[test]
    fn the_arc_tangent_under_the_whole_torque_makes_a_slender_pin_much_too_stiff() {
        let (circle, torque) = (0.045, 585.0);
        let pin = Pin {
            diameter: 0.005,
            bore: 0.0,
            length: 0.05,
        };
        let flexibility = pin.flexibility(206e9, 0.3);
        let linear = pin_compliance(flexibility, circle);
        let with_arc_tangent = (flexibility * torque / (circle * circle)).atan() / torque;
        assert_relative_eq!(with_arc_tangent / linear, 1.0 - 0.431, max_relative = 0.001);
    }

    #[test]
    fn stress_of_a_solid_pin_is_the_textbook_formula() {
        let pin = Pin {
            diameter: 0.016,
            bore: 0.0,
            length: 0.04,
        };
        assert_relative_eq!(
            pin.root_stress(1000.0),
            32.0 * 1000.0 * 0.04 / (PI * 0.016_f64.powi(3)),
            max_relative = 1e-12
        );
    }
}
