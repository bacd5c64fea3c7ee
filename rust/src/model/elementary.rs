//! Arc sine, sine and cosine without branches or calls, so that loops over many values vectorise
//! and every machine gives the same bits: only additions, products, divisions and square roots.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

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

/// Largest magnitude (rad) of which [`sin_cos`] knows how many right angles it holds.
pub const LARGEST_ANGLE: f64 = 1e6;

/// Half of pi in three parts: the first two have 33 bits, so that their products
/// with a whole number below 2^20 are exact.
const RIGHT_ANGLE: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_7e-21,
];

/// Sine and cosine of an angle of at most [`LARGEST_ANGLE`], to two units in the last place of one.
///
/// The polynomials of fdlibm (`k_sin.c`, `k_cos.c`, Sun Microsystems 1993) on what is left after
/// whole right angles are taken off (Cody and Waite).
#[inline(always)]
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    // 1.5 * 2^52 shifts the units to the last bits.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    let shifted = angle * FRAC_2_PI + SHIFT;
    let (quarters, turns) = (shifted.to_bits(), shifted - SHIFT);
    let [first, second, third] = RIGHT_ANGLE;
    let x = ((angle - turns * first) - turns * second) - turns * third;
    let square = x * x;
    let sine = x + x
        * square
        * polynomial(
            square,
            [
                1.589_690_995_211_55e-10,
                -2.505_076_025_340_686_3e-8,
                2.755_731_370_707_006_8e-6,
                -1.984_126_982_985_795e-4,
                8.333_333_333_322_49e-3,
                -1.666_666_666_666_663_2e-1,
            ],
        );
    let half = 0.5 * square;
    let near = 1.0 - half;
    let rest = square
        * square
        * polynomial(
            square,
            [
                -1.135_964_755_778_819_5e-11,
                2.087_572_321_298_175e-9,
                -2.755_731_435_139_066_3e-7,
                2.480_158_728_947_673e-5,
                -1.388_888_888_887_411e-3,
                4.166_666_666_666_66e-2,
            ],
        );
    let cosine = near + ((1.0 - near - half) + rest);
    // Bits instead of branches: odd quarters exchange the two, and pairs of quarters the sign.
    let odd = 0_u64.wrapping_sub(quarters & 1);
    let (sine, cosine) = (sine.to_bits(), cosine.to_bits());
    let exchanged = (sine ^ cosine) & odd;
    let sign = |quarters: u64| (quarters & 2) << 62;
    (
        f64::from_bits(sine ^ exchanged ^ sign(quarters)),
        f64::from_bits(cosine ^ exchanged ^ sign(quarters.wrapping_add(1))),
    )
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
    fn sine_and_cosine_are_those_of_the_library_to_the_last_places() {
        for k in 0..400_000 {
            let scale = 10_f64.powf(12.0 * random(3, k) - 6.0);
            let angle = scale * (2.0 * random(4, k) - 1.0);
            let (found, expected) = (sin_cos(angle), angle.sin_cos());
            assert!((found.0 - expected.0).abs() < 2.5e-16, "{angle}");
            assert!((found.1 - expected.1).abs() < 2.5e-16, "{angle}");
            assert!((found.0 - expected.0).abs() <= 2e-15 * expected.0.abs().max(1e-3));
        }
    }

    #[test]
    fn sine_and_cosine_at_whole_right_angles() {
        for k in -40..=40 {
            let angle = FRAC_PI_2 * f64::from(k);
            let (found, expected) = (sin_cos(angle), angle.sin_cos());
            assert!((found.0 - expected.0).abs() < 1e-20 + 2.0 * f64::EPSILON * expected.0.abs());
            assert!((found.1 - expected.1).abs() < 1e-20 + 2.0 * f64::EPSILON * expected.1.abs());
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
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
