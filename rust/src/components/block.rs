//! A symmetric 3 by 3 block of the equations of an equilibrium, factorised and eliminated.

/// A symmetric matrix by its entries 00, 01, 02, 11, 12, 22.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Sym3(pub [f64; 6]);

impl Sym3 {
    /// With `shift` added along the diagonal.
    #[inline(always)]
    pub(crate) fn shifted(self, shift: f64) -> Self {
        let [a, b, c, d, e, f] = self.0;
        Self([a + shift, b, c, d + shift, e, f + shift])
    }

    /// Solutions of the equations with two right sides.
    #[inline(always)]
    fn solve(self, first: [f64; 3], second: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        // L D L^T.
        let [a00, a01, a02, a11, a12, a22] = self.0;
        let (l10, l20) = (a01 / a00, a02 / a00);
        let d1 = a11 - l10 * a01;
        let part = a12 - l20 * a01;
        let l21 = part / d1;
        let d2 = a22 - l20 * a02 - l21 * part;
        let one = |r: [f64; 3]| {
            let y1 = r[1] - l10 * r[0];
            let y2 = r[2] - l20 * r[0] - l21 * y1;
            let x2 = y2 / d2;
            let x1 = y1 / d1 - l21 * x2;
            [r[0] / a00 - l10 * x1 - l20 * x2, x1, x2]
        };
        (one(first), one(second))
    }
}

/// A disc's equations solved for the flange at rest and for a flange that moves by one.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Block {
    /// The disc's step with the flange at rest.
    at_rest: [f64; 3],
    /// Its further step for a flange that moves by one.
    following: [f64; 3],
}

impl Block {
    /// Eliminates a disc with these second derivatives, gradient and mixed derivatives with the
    /// flange.
    #[inline(always)]
    pub(crate) fn eliminate(hessian: Sym3, gradient: [f64; 3], mixed: [f64; 3]) -> Self {
        let (at_rest, following) =
            hessian.solve(gradient.map(|value| -value), mixed.map(|value| -value));
        Self { at_rest, following }
    }

    /// What the disc's freedom takes off the flange's stiffness.
    #[inline(always)]
    pub(crate) fn reduction(&self, mixed: [f64; 3]) -> f64 {
        -dot(self.following, mixed)
    }

    /// What the disc's forces out of balance push the flange by.
    #[inline(always)]
    pub(crate) fn transfer(&self, gradient: [f64; 3]) -> f64 {
        -dot(self.following, gradient)
    }

    /// The disc's step when the flange moves by `flange`.
    #[inline(always)]
    pub(crate) fn back(&self, flange: f64) -> [f64; 3] {
        let mut step = self.at_rest;
        for (value, following) in step.iter_mut().zip(self.following) {
            *value += following * flange;
        }
        step
    }
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_solves_its_equations() {
        let [a, b, c, d, e, f] = [4.0, 1.0, -0.5, 3.0, 0.7, 2.0];
        let right = [1.0, -2.0, 3.0];
        let (x, _) = Sym3([a, b, c, d, e, f]).solve(right, right);
        let back = [
            a * x[0] + b * x[1] + c * x[2],
            b * x[0] + d * x[1] + e * x[2],
            c * x[0] + e * x[1] + f * x[2],
        ];
        for (found, expected) in back.iter().zip(right) {
            assert!((found - expected).abs() < 1e-14);
        }
    }
}
