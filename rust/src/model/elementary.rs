//! Arc sine without branches or calls, so that loops over many values vectorise
//! and every machine gives the same bits: only additions, products, divisions and square roots.

use std::f64::consts::FRAC_PI_2;

/// A polynomial by Horner's scheme, the highest power first.
#[inline(always)]
fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    let mut sum = 0.0;
    for c in coefficients {
        sum = sum * x + c;
    }
    sum
}

/// Arc sine of `x` from 0 to 1, to three units in the last place.
///
/// The rational function of fdlibm (`e_asin.c`, Sun Microsystems 1993); above one half
/// `pi/2 - 2 asin(sqrt((1 - x)/2))`.
#[inline(always)]
#[must_use]
pub fn asin(x: f64) -> f64 {
    let is_small = x < 0.5;
    let square = if is_small { x * x } else { 0.5 * (1.0 - x) };
    let root = square.sqrt();
    let x = if is_small { x } else { root };
    let above = polynomial(
        square,
        [
            3.479_331_075_960_212e-5,
            7.915_349_942_898_145e-4,
            -4.005_553_450_067_941e-2,
            2.012_125_321_348_629_3e-1,
            -3.255_658_186_224_009e-1,
            1.666_666_666_666_666_6e-1,
        ],
    );
    let below = polynomial(
        square,
        [
            7.703_815_055_590_194e-2,
            -6.882_839_716_054_533e-1,
            2.020_945_760_233_505_7,
            -2.403_394_911_734_414,
            1.0,
        ],
    );
    let angle = x + x * (square * above / below);
    if is_small {
        angle
    } else {
        FRAC_PI_2 - 2.0 * angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random;

    fn ulps(found: f64, expected: f64) -> f64 {
        (found - expected).abs() / (expected.abs() * f64::EPSILON)
    }

    #[test]
    fn the_same_as_the_library_to_the_last_places() {
        for k in 0..400_000 {
            let (u, scale) = (random(1, k), random(2, k));
            let x = u.powf(1.0 + 20.0 * scale);
            assert!(ulps(asin(x), x.asin()) < 3.0, "{x}");
        }
    }

    #[test]
    fn ends_and_edges() {
        assert_eq!(asin(0.0), 0.0);
        for x in [0.5_f64, 0.5_f64.next_down(), 1.0_f64.next_down()] {
            assert!(ulps(asin(x), x.asin()) < 3.0, "{x}");
        }
        assert!(asin(f64::NAN).is_nan());
    }
}
