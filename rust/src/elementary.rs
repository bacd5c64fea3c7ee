//! Arc sine and arc tangent without branches or calls, so that loops over many values vectorise
//! and every machine gives the same bits: only additions, products, divisions and square roots.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

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

/// Arc tangent of `x` not below zero, to two units in the last place.
///
/// The rational function and the three ranges of Cephes (`atan.c`, S. L. Moshier 1995).
#[inline(always)]
#[must_use]
pub fn atan(x: f64) -> f64 {
    const TAN_3_PI_8: f64 = 2.414_213_562_373_095;
    const LOW_BITS_OF_PI_2: f64 = 6.123_233_995_736_766e-17;
    let (is_large, is_small) = (x > TAN_3_PI_8, x <= 0.66);
    let above = if is_small { x } else { x - 1.0 };
    let below = if is_small { 1.0 } else { x + 1.0 };
    let above = if is_large { -1.0 } else { above };
    let below = if is_large { x } else { below };
    let turned = if is_small { 0.0 } else { FRAC_PI_4 };
    let turned = if is_large { FRAC_PI_2 } else { turned };
    let low = if is_small {
        0.0
    } else {
        0.5 * LOW_BITS_OF_PI_2
    };
    let low = if is_large { LOW_BITS_OF_PI_2 } else { low };
    let reduced = above / below;
    let square = reduced * reduced;
    let above = polynomial(
        square,
        [
            -8.750_608_600_031_904e-1,
            -1.615_753_718_733_365e1,
            -7.500_855_792_314_705e1,
            -1.228_866_684_490_136_1e2,
            -6.485_021_904_942_025e1,
        ],
    );
    let below = polynomial(
        square,
        [
            1.0,
            2.485_846_490_142_306_3e1,
            1.650_270_098_316_988_6e2,
            4.328_810_604_912_903e2,
            4.853_903_996_359_137e2,
            1.945_506_571_482_614e2,
        ],
    );
    turned + (reduced + (reduced * (square * above / below) + low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::random;

    fn ulps(found: f64, expected: f64) -> f64 {
        (found - expected).abs() / (expected.abs() * f64::EPSILON)
    }

    #[test]
    fn the_same_as_the_library_to_the_last_places() {
        for k in 0..400_000 {
            let (u, scale) = (random(1, k), random(2, k));
            let x = u.powf(1.0 + 20.0 * scale);
            assert!(ulps(asin(x), x.asin()) < 3.0, "{x}");
            let x = u / (1.0 - u) * 10.0_f64.powf(30.0 * (scale - 0.7));
            assert!(ulps(atan(x), x.atan()) < 2.0, "{x}");
        }
    }

    #[test]
    fn ends_and_edges() {
        assert_eq!(asin(0.0), 0.0);
        assert_eq!(atan(0.0), 0.0);
        assert_eq!(atan(f64::MAX), FRAC_PI_2);
        for x in [0.5_f64, 0.5_f64.next_down(), 1.0_f64.next_down()] {
            assert!(ulps(asin(x), x.asin()) < 3.0, "{x}");
        }
        for x in [0.66_f64, 0.66_f64.next_up(), 2.414_213_562_373_095, 2.5] {
            assert!(ulps(atan(x), x.atan()) < 2.0, "{x}");
        }
        assert!(asin(f64::NAN).is_nan() && atan(f64::NAN).is_nan());
    }
}
