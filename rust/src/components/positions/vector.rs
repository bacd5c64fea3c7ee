//! Vectors of numbers side by side, as wide as the machine's instructions, with the operators of a
//! single number.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use pulp::{Simd, bytemuck};

/// As many numbers as one instruction takes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vector<S: Simd> {
    simd: S,
    lanes: S::f64s,
}

/// A condition for every lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    lanes: S::m64s,
}

impl<S: Simd> Vector<S> {
    /// Numbers in a vector.
    pub(crate) const LANES: usize = S::F64_LANES;

    /// One number in every lane.
    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f64) -> Self {
        Self {
            simd,
            lanes: simd.splat_f64s(value),
        }
    }

    #[inline(always)]
    pub(crate) fn zero(simd: S) -> Self {
        Self::splat(simd, 0.0)
    }

    /// A number for each lane, in the order of the lanes.
    #[inline(always)]
    pub(crate) fn of(simd: S, value: impl FnMut(usize) -> f64) -> Self {
        let mut vector = Self::zero(simd);
        let lanes = vector.as_mut_slice();
        for (lane, value) in lanes.iter_mut().zip((0..).map(value)) {
            *lane = value;
        }
        vector
    }

    /// Sine and cosine of every lane.
    #[inline(always)]
    pub(crate) fn sin_cos(self) -> (Self, Self) {
        let (mut sin, mut cos) = (self, self);
        for (sin, cos) in sin.as_mut_slice().iter_mut().zip(cos.as_mut_slice()) {
            (*sin, *cos) = sin.sin_cos();
        }
        (sin, cos)
    }

    /// The vectors that lie one after the other in memory.
    #[inline(always)]
    pub(crate) fn of_slice(memory: &[f64]) -> &[S::f64s] {
        S::as_simd_f64s(memory).0
    }

    /// The vectors that lie one after the other in memory, to write.
    #[inline(always)]
    pub(crate) fn of_slice_mut(memory: &mut [f64]) -> &mut [S::f64s] {
        S::as_mut_simd_f64s(memory).0
    }

    #[inline(always)]
    pub(crate) fn new(simd: S, lanes: S::f64s) -> Self {
        Self { simd, lanes }
    }

    #[inline(always)]
    pub(crate) fn raw(self) -> S::f64s {
        self.lanes
    }

    /// The numbers, in the order of the lanes.
    #[inline(always)]
    pub(crate) fn as_slice(&self) -> &[f64] {
        bytemuck::cast_slice(std::slice::from_ref(&self.lanes))
    }

    /// The numbers to write, in the order of the lanes.
    #[inline(always)]
    pub(crate) fn as_mut_slice(&mut self) -> &mut [f64] {
        bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.lanes))
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self::new(self.simd, self.simd.sqrt_f64s(self.lanes))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self::new(self.simd, self.simd.abs_f64s(self.lanes))
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.max_f64s(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.min_f64s(self.lanes, other.lanes))
    }

    /// Where it is greater than the other.
    #[inline(always)]
    pub(crate) fn above(self, other: Self) -> Mask<S> {
        let lanes = self.simd.greater_than_f64s(self.lanes, other.lanes);
        Mask {
            simd: self.simd,
            lanes,
        }
    }

    /// Where it is not greater than the other.
    #[inline(always)]
    pub(crate) fn at_most(self, other: Self) -> Mask<S> {
        let lanes = self.simd.less_than_or_equal_f64s(self.lanes, other.lanes);
        Mask {
            simd: self.simd,
            lanes,
        }
    }
}

impl<S: Simd> Mask<S> {
    /// True in no lane.
    #[inline(always)]
    pub(crate) fn none(simd: S) -> Self {
        let zero = Vector::zero(simd);
        zero.above(zero)
    }

    /// The one number where true, the other elsewhere.
    #[inline(always)]
    pub(crate) fn select(self, yes: Vector<S>, no: Vector<S>) -> Vector<S> {
        let lanes = self.simd.select_f64s(self.lanes, yes.lanes, no.lanes);
        Vector::new(self.simd, lanes)
    }

    /// The number where true, zero elsewhere.
    #[inline(always)]
    pub(crate) fn keep(self, yes: Vector<S>) -> Vector<S> {
        self.select(yes, Vector::zero(self.simd))
    }

    #[inline(always)]
    pub(crate) fn or(self, other: Self) -> Self {
        let lanes = self.simd.or_m64s(self.lanes, other.lanes);
        Self { lanes, ..self }
    }

    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        let lanes = self.simd.and_m64s(self.lanes, other.lanes);
        Self { lanes, ..self }
    }

    #[inline(always)]
    pub(crate) fn not(self) -> Self {
        let lanes = self.simd.not_m64s(self.lanes);
        Self { lanes, ..self }
    }

    /// Whether it is true in any lane.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        let bytes: &[u8] = bytemuck::cast_slice(std::slice::from_ref(&self.lanes));
        bytes.iter().fold(0, |all, byte| all | byte) != 0
    }
}

macro_rules! operator {
    ($name:ident, $method:ident, $simd_method:ident) => {
        impl<S: Simd> $name for Vector<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::new(self.simd, self.simd.$simd_method(self.lanes, other.lanes))
            }
        }
        impl<S: Simd> $name<f64> for Vector<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(Self::splat(self.simd, other))
            }
        }
    };
}
operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

macro_rules! assigning {
    ($name:ident, $method:ident, $operator:tt) => {
        impl<S: Simd> $name for Vector<S> {
            #[inline(always)]
            fn $method(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    };
}
assigning!(AddAssign, add_assign, +);
assigning!(SubAssign, sub_assign, -);
assigning!(MulAssign, mul_assign, *);

impl<S: Simd> Neg for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::zero(self.simd) - self
    }
}

/// Memory whose vectors begin at the beginning of a line of the cache.
#[derive(Debug, Clone, Default)]
pub(crate) struct Column {
    memory: Vec<f64>,
    first: usize,
    len: usize,
}

/// Numbers in a line of the cache.
const LINE: usize = 8;

impl Column {
    /// Makes room for this many numbers, whatever is in them.
    #[inline(always)]
    pub(crate) fn make_room(&mut self, len: usize) {
        if self.memory.len() < len + LINE {
            self.memory.resize(len + LINE, 0.0);
            let offset = self.memory.as_ptr().align_offset(64);
            self.first = if offset < LINE { offset } else { 0 };
        }
        self.len = len;
    }

    #[inline(always)]
    pub(crate) fn get(&self) -> &[f64] {
        &self.memory[self.first..self.first + self.len]
    }

    #[inline(always)]
    pub(crate) fn get_mut(&mut self) -> &mut [f64] {
        &mut self.memory[self.first..self.first + self.len]
    }
}

/// First guess, right within some per cent, of `x^(1/N)` for positive `x`, from the bits of the
/// numbers.
#[inline(always)]
fn root_guess<S: Simd>(x: Vector<S>, degree: f64) -> Vector<S> {
    // 2^52 in front of the high word makes it a number of its own, and back.
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    // High words of 1.0 and of a factor that balances the guess.
    const ONE: f64 = 1_072_693_248.0;
    let (inverse, end) = (1.0 / degree, ONE - 40_000.0);
    let mut guess = x;
    for lane in guess.as_mut_slice() {
        let high = f64::from_bits((lane.to_bits() >> 32) | SHIFT.to_bits()) - SHIFT;
        let moved = (high - ONE) * inverse + end;
        *lane = f64::from_bits((moved + SHIFT).to_bits() << 32);
    }
    guess
}

/// `x^(1/9)` for positive `x`; each step after Halley cubes the error, 4e-10 is left after two and
/// rounding after three.
#[inline(always)]
pub(crate) fn ninth_root<S: Simd, const STEPS: usize>(x: Vector<S>) -> Vector<S> {
    let mut y = root_guess(x, 9.0);
    for _ in 0..STEPS {
        let y3 = y * y * y;
        let y9 = y3 * y3 * y3;
        y *= (y9 * 8.0 + x * 10.0) / (y9 * 10.0 + x * 8.0);
    }
    y
}

/// The `s` of `s + ratio s^(10/9) = depth` for positive `depth`, and its ninth root, by as many of
/// Halley's steps on the root.
#[inline(always)]
pub(crate) fn closed<S: Simd, const STEPS: usize>(
    depth: Vector<S>,
    ratio: Vector<S>,
) -> (Vector<S>, Vector<S>) {
    // The guess of s is within a factor (1 + ratio root)^(1/9), its ninth root much nearer.
    let first = depth / (ratio * root_guess(depth, 9.0) + 1.0);
    let mut y = root_guess(first, 9.0);
    for _ in 0..STEPS {
        let y3 = y * y * y;
        let y9 = y3 * y3 * y3;
        let y10 = ratio * y * y9;
        let miss = y9 + y10 - depth;
        // First and second derivative times y and its square.
        let slope = y9 * 9.0 + y10 * 10.0;
        let bend = y9 * 72.0 + y10 * 90.0;
        y *= (slope * slope - miss * (slope + bend * 0.5)) / (slope * slope - miss * bend * 0.5);
    }
    let y3 = y * y * y;
    (y3 * y3 * y3, y)
}
