//! Largest force on one output pin over a turn of the mesh zone, by statics.
//!
//! A rigid disc presses its pins with forces in proportion to sin(psi), so that a contact at psi
//! carries `T sin(psi) / (R sum sin^2)`. All holes of all discs stand on a lattice of
//! M = lcm(N, n) angles. If M is even the sum is the same at every position, and the largest force
//! is `4 T / (n N R)`. If M is odd the sum changes with the position: it is smallest where a
//! contact stands at psi = 90 deg for M = 1 modulo 4 and largest there for M = 3 modulo 4.

use std::f64::consts::PI;
use std::sync::LazyLock;

const PLACES: usize = 256;

/// What [`worst_position_factor`] gives for every lattice of a design (at most 3 x 63 points).
static FACTORS: LazyLock<[f64; PLACES]> =
    LazyLock::new(|| std::array::from_fn(|points| worst_position_factor(points.max(1) as u32)));

/// Largest force at the worst position over `4 T / (n N R)`, for a lattice of `points` angles.
#[must_use]
pub fn worst_position_factor(points: u32) -> f64 {
    let m = f64::from(points);
    let secant = 1.0 / (PI / m).cos();
    match points % 4 {
        1 => m / (m + 1.0 - secant),
        // Three contacts are worst between two positions, 43.3379 deg from 90 deg: the maximum of
        // cos(d) / (1 - cos(2 d - 120 deg) / 2), times 3/4.
        3 if points == 3 => 0.936_924_908_411_944_9,
        3 => m / (m - 1.0 + secant),
        _ => 1.0,
    }
}

/// [`worst_position_factor`] from a table; any factor where `points` is no number of a lattice.
#[inline(always)]
pub(crate) fn tabulated_factor(factors: &[f64; PLACES], points: f64) -> f64 {
    // 2^52 shifts the units to the last bit.
    factors[(points + 4_503_599_627_370_496.0).to_bits() as usize % PLACES]
}

/// The table for [`tabulated_factor`].
#[inline(always)]
pub(crate) fn factors() -> &'static [f64; PLACES] {
    &FACTORS
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::TAU;

    /// Largest force on any contact, looked for on a grid of positions; T = R = 1.
    fn scanned(pins: u32, discs: u32, positions: u32) -> f64 {
        let mut largest = 0.0_f64;
        for k in 0..positions {
            let theta = f64::from(k) / f64::from(positions) * TAU / f64::from(pins);
            let (mut sum, mut top) = (0.0, 0.0_f64);
            for disc in 0..discs {
                for pin in 0..pins {
                    let phase = f64::from(disc) / f64::from(discs);
                    let psi = theta + TAU * (phase - f64::from(pin) / f64::from(pins));
                    let sine = psi.sin().max(0.0);
                    sum += sine * sine;
                    top = top.max(sine);
                }
            }
            largest = largest.max(top / sum);
        }
        largest
    }

    fn gcd(a: u32, b: u32) -> u32 {
        if b == 0 { a } else { gcd(b, a % b) }
    }

    #[test]
    fn the_closed_form_is_the_worst_of_all_positions() {
        for discs in 1..=4 {
            for pins in (3..=16).chain([21, 33, 63, 64]) {
                let points = pins * discs / gcd(pins, discs);
                let closed = worst_position_factor(points) * 4.0 / f64::from(pins * discs);
                let found = scanned(pins, discs, 20_000);
                assert!(
                    found <= closed * (1.0 + 1e-12),
                    "{pins} pins, {discs} discs"
                );
                assert_relative_eq!(found, closed, max_relative = 2e-7);
            }
        }
    }

    #[test]
    fn five_pins_of_one_disc() {
        let force = worst_position_factor(5) * 4.0 * 585.0 / (5.0 * 0.045);
        assert_relative_eq!(force, 10_915.0, max_relative = 1e-4);
    }
}
