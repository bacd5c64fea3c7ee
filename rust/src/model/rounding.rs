//! Rounding and comparing in a few instructions: the baseline x86-64 has no rounding, and a call
//! into the mathematics library costs more than the rest of a formula.

/// 1.5 * 2^52: adding it leaves no bit below one.
const SHIFT: f64 = 6_755_399_441_055_744.0;

/// The nearest whole number, for magnitudes below 2^51.
#[inline(always)]
pub fn nearest(x: f64) -> f64 {
    (x + SHIFT) - SHIFT
}

/// The largest whole number not above `x`, for magnitudes below 2^51.
#[inline(always)]
pub fn floor(x: f64) -> f64 {
    let near = nearest(x);
    if near > x { near - 1.0 } else { near }
}

/// The smallest whole number not below `x`, for magnitudes below 2^51.
#[inline(always)]
pub fn ceil(x: f64) -> f64 {
    let near = nearest(x);
    if near < x { near + 1.0 } else { near }
}

/// The smaller of two numbers, neither NaN: one instruction where `f64::min` takes five.
#[inline(always)]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers, neither NaN.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// True for a whole number from `low` to `high`, themselves below 2^51.
#[inline(always)]
pub fn is_whole_within(value: f64, low: f64, high: f64) -> bool {
    (value >= low) & (value <= high) & (value == nearest(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_as_the_library() {
        for k in -4000..4000 {
            for x in [
                f64::from(k) / 8.0,
                f64::from(k).next_up(),
                f64::from(k).next_down(),
            ] {
                assert_eq!(floor(x), x.floor());
                assert_eq!(ceil(x), x.ceil());
                assert_eq!(
                    is_whole_within(x, -1e3, 1e3),
                    x.abs() <= 1e3 && x == x.trunc()
                );
            }
        }
        assert!(!is_whole_within(f64::NAN, 0.0, 1.0));
    }
}
