//! Laws of one contact: approach of a line contact after Palmgren and after Johnson, Hertz's
//! pressure, and the power law that both become.

use std::f64::consts::PI;

/// Young's modulus and Poisson's ratio of one body. SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus (Pa).
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

/// The steel for which Palmgren's coefficient is printed.
pub const STEEL: Material = Material {
    youngs_modulus: 206e9,
    poisson: 0.3,
};

/// Exponent of force in the approach of a line contact: delta ~ Q^0.9.
pub const APPROACH_EXPONENT: f64 = 0.9;

/// Palmgren's coefficient for two bodies of [`STEEL`]: delta = 3.84e-5 Q^0.9 / l^0.8 in mm and N.
const PALMGREN_STEEL_MM: f64 = 3.84e-5;

impl Material {
    /// (1 - nu^2) / E (1/Pa), the body's share of a contact's softness.
    #[inline(always)]
    #[must_use]
    pub fn softness(self) -> f64 {
        (1.0 - self.poisson * self.poisson) / self.youngs_modulus
    }
}

/// Approach (m) under one newton to the power 0.9 of a line contact of length `l` (m), after
/// Palmgren: `c (softness_1 + softness_2)^0.9 / l^0.8`.
///
/// The dimensionless `c` is what 3.84e-5 for two steels means, 1.357; textbooks round it to 1.36.
#[inline]
#[must_use]
pub fn palmgren(first: Material, second: Material, length: f64) -> f64 {
    // In mm and MPa; the coefficient itself has no unit.
    let softness = (first.softness() + second.softness()) / (2.0 * STEEL.softness());
    let in_mm = PALMGREN_STEEL_MM * softness.powf(APPROACH_EXPONENT) / (length * 1e3).powf(0.8);
    in_mm * 1e-3
}

/// Stiffness (N/m^(10/9)) of the law `F = k p^(10/9)` from its approach under one newton.
#[inline]
#[must_use]
pub fn power_stiffness(approach: f64) -> f64 {
    approach.powf(-1.0 / APPROACH_EXPONENT)
}

/// Half width (m) and pressure (Pa) of a line contact after Hertz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz {
    /// Half width of the contact (m).
    pub half_width: f64,
    /// Largest pressure (Pa).
    pub pressure: f64,
}

/// Greatest shear stress over the pressure, and its depth over the half width, at Poisson's ratio
/// 0.3 (K. L. Johnson, *Contact Mechanics*, section 4.2).
pub const SHEAR_OF_PRESSURE: (f64, f64) = (0.300_28, 0.786_16);

/// Hertz's line contact under `line_load` (N/m), with relative curvature `1/R_1 + 1/R_2` (1/m, a
/// hollow one negative) and both bodies' [`Material::softness`].
#[inline]
#[must_use]
pub fn hertz(line_load: f64, curvature: f64, first: Material, second: Material) -> Hertz {
    let modulus = 1.0 / (first.softness() + second.softness());
    let half_width = (4.0 * line_load / (PI * modulus * curvature)).sqrt();
    Hertz {
        half_width,
        pressure: (line_load * modulus * curvature / PI).sqrt(),
    }
}

/// Approach (m) of two cylinders after Johnson under `line_load` (N/m): each body's distance from
/// the contact to its own centre, `(2 q / pi) sum (1 - nu^2)/E (ln(4 R / b) - 1/2)`.
///
/// Radii are without sign: that of a hole counts as far as the pin's centre is from its surface.
#[must_use]
pub fn johnson(line_load: f64, curvature: f64, bodies: [(Material, f64); 2]) -> f64 {
    let [(first, _), (second, _)] = bodies;
    let half_width = hertz(line_load, curvature, first, second).half_width;
    let part = |(material, radius): (Material, f64)| {
        material.softness() * ((4.0 * radius / half_width).ln() - 0.5)
    };
    2.0 * line_load / PI * (part(bodies[0]) + part(bodies[1]))
}

/// The power law's approach under one newton that gives Johnson's approach at a working load (N):
/// its secant there.
#[must_use]
pub fn johnson_secant(load: f64, length: f64, curvature: f64, bodies: [(Material, f64); 2]) -> f64 {
    johnson(load / length, curvature, bodies) / load.powf(APPROACH_EXPONENT)
}

/// `x^(1/9)` for finite `x` not below 1e-280, in operations that become vector instructions.
///
/// A first guess from the bits of the number is right within 4 %; each of three steps after
/// Halley cubes the error.
#[inline(always)]
#[must_use]
pub fn ninth_root(x: f64) -> f64 {
    // 2^52 in front of the high word makes it a number of its own, and back.
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    // High words of 1.0 and of a factor that balances the guess.
    const ONE: f64 = 1_072_693_248.0;
    let high = f64::from_bits((x.to_bits() >> 32) | SHIFT.to_bits()) - SHIFT;
    let guess = (high - ONE) * (1.0 / 9.0) + (ONE - 40_000.0);
    let mut y = f64::from_bits((guess + SHIFT).to_bits() << 32);
    for _ in 0..3 {
        let y3 = y * y * y;
        let y9 = y3 * y3 * y3;
        y = y * (8.0 * y9 + 10.0 * x) / (10.0 * y9 + 8.0 * x);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn ninth_root_is_that_of_the_library() {
        for k in -400..60 {
            for part in [1.0, 1.13, 1.41, 1.7, 1.999_999] {
                let x = part * 2.0_f64.powi(k);
                assert_relative_eq!(ninth_root(x), x.powf(1.0 / 9.0), max_relative = 4e-15);
            }
        }
    }

    #[test]
    fn pressures_of_five_contacts() {
        let cases = [
            (100e3, 1.0 / 0.010, 0.106_061, 600.237),
            (100e3, 1.0 / 0.005, 0.074_997, 848.864),
            (100e3, 1.0 / 0.010 + 1.0 / 0.020, 0.086_599, 735.138),
            (100e3, 1.0 / 0.0035 - 1.0 / 0.012, 0.074_554, 853.902),
            (
                4900.0 / 0.012,
                1.0 / 0.008 - 1.0 / 0.0089,
                0.602_812,
                431.231,
            ),
        ];
        for (load, curvature, half_width_mm, pressure_mpa) in cases {
            let found = hertz(load, curvature, STEEL, STEEL);
            assert_relative_eq!(found.half_width * 1e3, half_width_mm, max_relative = 2e-5);
            assert_relative_eq!(found.pressure * 1e-6, pressure_mpa, max_relative = 2e-5);
        }
    }

    #[test]
    fn approaches_of_palmgren_and_johnson() {
        let palmgren_10 = palmgren(STEEL, STEEL, 0.010);
        let in_mm = power_stiffness(palmgren_10) * 1e-3_f64.powf(10.0 / 9.0);
        assert_relative_eq!(in_mm, 624_004.2, max_relative = 1e-7);
        for (force, of_palmgren, on_50, in_hole) in [
            (100.0_f64, 0.000_384, 0.000_418, 0.000_303),
            (1000.0, 0.003_050, 0.003_535, 0.002_378),
            (5000.0, 0.012_984, 0.015_412, 0.009_629),
        ] {
            let mm = palmgren_10 * force.powf(0.9) * 1e3;
            assert!((mm - of_palmgren).abs() < 6e-7, "{mm}");
            let bodies = [(STEEL, 0.005), (STEEL, 0.050)];
            let mm = johnson(force / 0.010, 1.0 / 0.005 + 1.0 / 0.050, bodies) * 1e3;
            assert!((mm - on_50).abs() < 6e-7, "{mm} {on_50}");
            let bodies = [(STEEL, 0.008), (STEEL, 0.0089)];
            let mm = johnson(force / 0.010, 1.0 / 0.008 - 1.0 / 0.0089, bodies) * 1e3;
            assert!((mm - in_hole).abs() < 6e-7, "{mm} {in_hole}");
        }
    }
}
