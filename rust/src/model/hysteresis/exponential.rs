//! Decaying exponentials of several numbers at once.

/// Numbers computed side by side.
pub(super) const LANES: usize = 8;

/// Largest argument: beyond it the result stays at about 3e-308.
const MOST: f64 = 708.0;
/// Adding this to a number of moderate size leaves its nearest integer in the last bits.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;
/// High and low part of the natural logarithm of two; multiples of the high part are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
/// Reciprocals of the factorials from 0 to 13, in pairs.
const TAYLOR: [[f64; 2]; 7] = [
    [1.0, 1.0],
    [0.5, 1.0 / 6.0],
    [1.0 / 24.0, 1.0 / 120.0],
    [1.0 / 720.0, 1.0 / 5_040.0],
    [1.0 / 40_320.0, 1.0 / 362_880.0],
    [1.0 / 3_628_800.0, 1.0 / 39_916_800.0],
    [1.0 / 479_001_600.0, 1.0 / 6_227_020_800.0],
];

/// `exp(-x)` of numbers not below zero, to the last two digits.
///
/// Unlike `f64::exp` it has neither a call nor a branch, so that the compiler makes vector
/// instructions of it.
#[inline(always)]
pub(super) fn decay(x: [f64; LANES]) -> [f64; LANES] {
    let mut out = [0.0; LANES];
    for (out, x) in out.iter_mut().zip(x) {
        let x = if x < MOST { x } else { MOST };
        let twos = (x * std::f64::consts::LOG2_E + TO_INTEGER) - TO_INTEGER;
        let rest = twos * LN_2[1] - (x - twos * LN_2[0]);
        // Estrin's scheme: the products wait for each other less than by Horner's.
        let square = rest * rest;
        let fourth = square * square;
        let [a, b, c, d, e, f, g] = TAYLOR.map(|[even, odd]| even + odd * rest);
        let sum = (a + b * square)
            + fourth * ((c + d * square) + fourth * ((e + f * square) + fourth * g));
        let exponent = ((1023.0 - twos) + TO_INTEGER).to_bits() << 52;
        *out = sum * f64::from_bits(exponent);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{LANES, decay};

    #[test]
    fn decay_is_the_exponential() {
        let mut worst = 0.0_f64;
        for step in 0..80_000 {
            let x = f64::from(step) * 0.00875 + 1e-7 * f64::from(step % 7);
            let expected = (-x).exp();
            for found in decay([x; LANES]) {
                worst = worst.max(((found - expected) / expected).abs());
            }
        }
        assert!(worst < 1e-15, "{worst}");
        assert_eq!(decay([0.0; LANES]), [1.0; LANES]);
        assert!(decay([f64::INFINITY; LANES])[0] < 1e-300);
    }
}
