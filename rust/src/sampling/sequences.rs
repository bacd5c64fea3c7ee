//! Points of a study as functions of their index alone: grid, Sobol, Latin hypercube, random.

use crate::sampling::joe_kuo::DIRECTIONS;

/// Most axes a Sobol study may have.
pub(crate) const MAX_SOBOL_AXES: usize = DIRECTIONS.len() + 1;

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): a bijection that mixes well.
#[inline]
pub(crate) const fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// The key of one axis of a study.
#[inline]
pub(crate) const fn key(seed: u64, axis: u64) -> u64 {
    mix(mix(seed.wrapping_add(GOLDEN)).wrapping_add(axis.wrapping_add(1).wrapping_mul(GOLDEN)))
}

/// A number in [0, 1) of the leading 53 bits.
#[inline]
pub(crate) const fn unit_interval(bits: u64) -> f64 {
    // Halves of 32 and 21 bits as the last places of 2^52 and 2^84, for which there are vector
    // instructions; every step is exact.
    const ONE: f64 = (1_u64 << 52) as f64;
    const TWO_TO_THE_32: f64 = (1_u64 << 32) as f64;
    let low = f64::from_bits((bits >> 11 & 0xFFFF_FFFF) | ONE.to_bits());
    let high = f64::from_bits((bits >> 43) | (ONE * TWO_TO_THE_32).to_bits());
    ((high - (ONE * TWO_TO_THE_32 + ONE)) + low) * (0.5 / ONE)
}

/// Independent uniform number number `index` of an axis.
#[inline]
pub(crate) const fn random(key: u64, index: u64) -> f64 {
    unit_interval(mix(key ^ mix(index.wrapping_mul(GOLDEN))))
}

/// One axis of a Sobol sequence of 64 bits, scrambled by a random lower-triangular matrix and a
/// shift (Matousek 1998), or not at all.
#[derive(Debug, Clone)]
pub(crate) struct SobolAxis {
    directions: [u64; 64],
    shift: u64,
    /// What the last digits of an index change in the bits of its point.
    steps: [u64; RUN],
}

/// Consecutive points found from one.
const RUN: usize = 128;

impl SobolAxis {
    /// The axis number `axis` (from 0); `scramble` is its key, or none for the plain sequence.
    pub(crate) fn new(axis: usize, scramble: Option<u64>) -> Self {
        let mut directions = [0_u64; 64];
        if axis == 0 {
            for (bit, v) in directions.iter_mut().enumerate() {
                *v = 1 << (63 - bit);
            }
        } else {
            let (polynomial, initial) = DIRECTIONS[axis - 1];
            let degree = initial.len();
            for bit in 0..64 {
                directions[bit] = if bit < degree {
                    u64::from(initial[bit]) << (63 - bit)
                } else {
                    let oldest = directions[bit - degree];
                    (1..degree)
                        .filter(|k| polynomial >> (degree - k) & 1 == 1)
                        .fold(oldest ^ (oldest >> degree), |v, k| v ^ directions[bit - k])
                };
            }
        }
        let Some(key) = scramble else {
            return Self::of(directions, 0);
        };
        let rows: [u64; 64] = std::array::from_fn(|row| {
            let diagonal = 1_u64 << (63 - row);
            let above = !(diagonal | (diagonal - 1));
            (mix(key.wrapping_add(row as u64 + 1)) & above) | diagonal
        });
        for v in &mut directions {
            let plain = *v;
            *v = rows.iter().enumerate().fold(0, |sum, (row, mask)| {
                sum | (u64::from((mask & plain).count_ones() & 1) << (63 - row))
            });
        }
        Self::of(directions, mix(key))
    }

    fn of(directions: [u64; 64], shift: u64) -> Self {
        let mut axis = Self {
            directions,
            shift,
            steps: [0; RUN],
        };
        axis.steps = std::array::from_fn(|index| axis.bits(index as u64) ^ shift);
        axis
    }

    /// The bits of point `index`.
    #[inline]
    pub(crate) fn bits(&self, index: u64) -> u64 {
        let mut gray = index ^ (index >> 1);
        let mut bits = self.shift;
        while gray != 0 {
            bits ^= self.directions[gray.trailing_zeros() as usize];
            gray &= gray - 1;
        }
        bits
    }

    /// Numbers in [0, 1) of consecutive points from `start` on.
    #[inline(always)]
    pub(crate) fn fill_units(&self, start: u64, out: &mut [f64]) {
        let mut index = start;
        let mut rest = out;
        while !rest.is_empty() {
            // A Gray code's leading digits do not depend on the index's last ones.
            let within = (index % RUN as u64) as usize;
            let bits = self.bits(index - within as u64);
            let (now, later) = rest.split_at_mut(rest.len().min(RUN - within));
            for (value, step) in now.iter_mut().zip(&self.steps[within..]) {
                *value = unit_interval(bits ^ step);
            }
            index += now.len() as u64;
            rest = later;
        }
    }
}

/// A keyed bijection of 0..count (a Feistel network with cycle walking).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Permutation {
    count: u64,
    key: u64,
    half_bits: u32,
}

impl Permutation {
    /// The bijection of 0..count under a key.
    pub(crate) const fn new(count: u64, key: u64) -> Self {
        let bits = 64 - count.saturating_sub(1).leading_zeros();
        let half = bits.div_ceil(2);
        Self {
            count,
            key,
            half_bits: if half == 0 { 1 } else { half },
        }
    }

    /// Where `index` goes.
    #[inline]
    pub(crate) fn at(&self, index: u64) -> u64 {
        let mask = (1_u64 << self.half_bits) - 1;
        let mut x = index;
        loop {
            let (mut left, mut right) = (x >> self.half_bits, x & mask);
            for round in 1..=4_u64 {
                let f = mix(self.key ^ right.wrapping_add(round.wrapping_mul(GOLDEN))) & mask;
                (left, right) = (right, left ^ f);
            }
            x = left << self.half_bits | right;
            if x < self.count {
                return x;
            }
        }
    }

    /// The point of a Latin hypercube of `count` strata, jittered within its stratum.
    #[inline]
    pub(crate) fn stratified(&self, index: u64) -> f64 {
        let inside = random(self.key.rotate_left(32), index);
        let u = (self.at(index) as f64 + inside) / self.count as f64;
        u.min(1.0 - f64::EPSILON / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashSet;

    #[test]
    fn the_plain_sequence_starts_as_everyone_prints_it() {
        let first: Vec<f64> = (0..6)
            .map(|k| unit_interval(SobolAxis::new(1, None).bits(k)))
            .collect();
        assert_eq!(first, [0.0, 0.5, 0.25, 0.75, 0.375, 0.875]);
    }

    #[test]
    fn runs_of_points_are_the_points() {
        let axis = SobolAxis::new(5, Some(key(2, 5)));
        for (start, len) in [(0, 300), (127, 2), ((1 << 62) + 77, 400), (5, 0)] {
            let mut units = vec![0.0; len];
            axis.fill_units(start, &mut units);
            for (unit, index) in units.iter().zip(start..) {
                assert_eq!(*unit, unit_interval(axis.bits(index)));
            }
        }
    }

    #[test]
    fn a_unit_interval_is_the_leading_bits() {
        for k in 0..10_000 {
            let bits = mix(k);
            let plain = (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64);
            assert_eq!(unit_interval(bits), plain);
        }
        assert_eq!(unit_interval(u64::MAX), 1.0 - f64::EPSILON / 2.0);
        assert_eq!(unit_interval(0), 0.0);
    }

    #[test]
    fn scrambling_keeps_every_dyadic_stratum_hit_once() {
        for dimension in [0, 1, 7, 127] {
            let axis = SobolAxis::new(dimension, Some(key(99, dimension as u64)));
            let strata: HashSet<u64> = (0..1024).map(|k| axis.bits(k) >> 54).collect();
            assert_eq!(strata.len(), 1024);
        }
    }

    #[test]
    fn a_permutation_hits_every_index_once() {
        for count in [1, 2, 3, 7, 1000, 1025] {
            let permutation = Permutation::new(count, key(3, 1));
            let image: HashSet<u64> = (0..count).map(|k| permutation.at(k)).collect();
            assert_eq!(image.len() as u64, count);
            assert!(image.iter().all(|k| *k < count));
        }
        let huge = Permutation::new(1 << 63, 7);
        assert!(huge.at((1 << 63) - 1) < 1 << 63);
    }

    proptest! {
        #[test]
        fn a_run_of_sobol_points_is_the_points(
            axis in 0..128_usize, scramble in any::<Option<u64>>(),
            start in 0..(1_u64 << 63) - 400, len in 0..400_usize,
        ) {
            let axis = SobolAxis::new(axis, scramble);
            let mut run = vec![0.0; len];
            axis.fill_units(start, &mut run);
            for (unit, index) in run.iter().zip(start..) {
                prop_assert_eq!(*unit, unit_interval(axis.bits(index)));
            }
        }

        #[test]
        fn a_permutation_is_a_bijection(count in 1..3000_u64, key in any::<u64>()) {
            let permutation = Permutation::new(count, key);
            let mut hit = vec![false; count as usize];
            for index in 0..count {
                let image = permutation.at(index) as usize;
                prop_assert!(!hit[image]);
                hit[image] = true;
            }
        }

        #[test]
        fn points_lie_in_the_unit_interval(
            count in 1..=1_u64 << 63, key_of in any::<u64>(), at in any::<u64>(),
        ) {
            let index = at % count;
            for u in [
                Permutation::new(count, key_of).stratified(index),
                random(key(key_of, 3), index),
                unit_interval(at),
            ] {
                prop_assert!((0.0..1.0).contains(&u));
            }
        }
    }
}
