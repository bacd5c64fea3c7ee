//! One output pin as a short cantilever: deflection, compliance about the drive's axis, stress
//! (Eqs. 8-10).

use std::f64::consts::PI;

use crate::elementary::atan;
use crate::error::DesignError;
use crate::judge::Judge;

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
    /// Requires a pin that can be made.
    #[inline(always)]
    pub fn require(&self, judge: &mut impl Judge) {
        let (bore, diameter) = (self.bore, self.diameter);
        judge.positive("output_pin_diameter", diameter);
        judge.non_negative("output_pin_bore", bore);
        judge.positive("output_pin_length", self.length);
        judge.require(bore < diameter, || DesignError::PinBoreTooLarge {
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

/// Compliance C_OP (rad/(N m)) about the drive's axis of one pin that carries `torque` (N m):
/// Eqs. (8)-(10), `F = T / R`, `phi = atan(delta / R)`, `C = phi / (F R)`.
///
/// For small deflections it is `flexibility / R^2`, whatever the torque.
#[inline(always)]
#[must_use]
pub fn pin_compliance(flexibility: f64, pin_circle_radius: f64, torque: f64) -> f64 {
    atan(flexibility * torque / (pin_circle_radius * pin_circle_radius)) / torque
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
    fn compliance_tends_to_flexibility_over_radius_squared() {
        assert_relative_eq!(
            pin_compliance(3.5e-8, 0.045, 1e-3),
            3.5e-8 / 0.045_f64.powi(2),
            max_relative = 1e-9
        );
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
