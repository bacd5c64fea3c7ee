//! Equilibria of flange and discs at several positions of the crank side by side, by the steps of
//! [`crate::components::equilibrium`], each lane as if it were alone.

use pulp::Simd;

use crate::components::equilibrium::{LONGEST_STEP, MOST_TRIALS, ROUNDING, SLOPE_LEFT};
use crate::components::mechanism::{MAX_DISCS, Mechanism};
use crate::components::positions::contacts::{Nobody, Pins, Ring, Visit};
use crate::components::positions::laws::Laws;
use crate::components::positions::vector::{Mask, Vector};

/// Newton steps after which a lane is left to be solved alone, where there are more of them.
const MOST_STEPS: u32 = 60;

/// Motions of flange and discs (m), rotations times R_OP.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motions<S: Simd> {
    pub flange: Vector<S>,
    pub discs: [[Vector<S>; 3]; MAX_DISCS],
}

impl<S: Simd> Motions<S> {
    #[inline(always)]
    pub(crate) fn zero(simd: S) -> Self {
        let zero = Vector::zero(simd);
        Self {
            flange: zero,
            discs: [[zero; 3]; MAX_DISCS],
        }
    }

    /// Seen in a mirror along the eccentricity.
    #[inline(always)]
    pub(crate) fn mirrored(&self) -> Self {
        let mut discs = self.discs;
        for [turn, _, y] in &mut discs {
            (*turn, *y) = (-*turn, -*y);
        }
        Self {
            flange: -self.flange,
            discs,
        }
    }

    /// A disc's rotation against the flange, and its shift.
    #[inline(always)]
    pub(crate) fn against_flange(&self, disc: usize) -> [Vector<S>; 3] {
        let [turn, x, y] = self.discs[disc];
        [turn - self.flange, x, y]
    }
}

/// What one disc adds to gradient and second derivatives.
#[derive(Debug, Clone, Copy)]
struct DiscTerms<S: Simd> {
    gradient: [Vector<S>; 3],
    /// 00, 01, 02, 11, 12, 22.
    hessian: [Vector<S>; 6],
    flange_gradient: Vector<S>,
    /// Second derivatives with the flange: with itself, and mixed.
    flange_hessian: Vector<S>,
    mixed: [Vector<S>; 3],
}

/// Gradient and second derivatives of the energy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Terms<S: Simd> {
    discs: [DiscTerms<S>; MAX_DISCS],
    flange_gradient: Vector<S>,
    residual: Vector<S>,
}

/// A factorised matrix of a disc's second derivatives: inverses of the diagonal, and 10, 20, 21.
#[derive(Clone, Copy)]
struct Factors<S: Simd> {
    inverse: [Vector<S>; 3],
    below: [Vector<S>; 3],
}

impl<S: Simd> Factors<S> {
    /// The solution for a right side of the other sign.
    #[inline(always)]
    fn solve_negative(&self, [r0, r1, r2]: [Vector<S>; 3]) -> [Vector<S>; 3] {
        let [l10, l20, l21] = self.below;
        let y1 = l10 * r0 - r1;
        let y2 = l20 * r0 - r2 - l21 * y1;
        let x2 = y2 * self.inverse[2];
        let x1 = y1 * self.inverse[1] - l21 * x2;
        [-(r0 * self.inverse[0] + l10 * x1 + l20 * x2), x1, x2]
    }
}

#[inline(always)]
fn dot<S: Simd>(a: [Vector<S>; 3], b: [Vector<S>; 3]) -> Vector<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A drive at some positions of the crank.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loaded<'a, S: Simd> {
    pub simd: S,
    pub mechanism: &'a Mechanism,
    pub rings: &'a [Ring; MAX_DISCS],
    pub pins: &'a [Pins; MAX_DISCS],
}

/// Force (N) and springs of the eccentric's bearing for a disc's shift (m).
#[inline(always)]
pub(crate) fn bearing<S: Simd>(
    simd: S,
    mechanism: &Mechanism,
    [x, y]: [Vector<S>; 2],
) -> ([Vector<S>; 2], [Vector<S>; 3]) {
    let stiffness = mechanism.bearing_stiffness;
    let springs = Vector::splat(simd, stiffness);
    if mechanism.bearing_clearance == 0.0 {
        let zero = Vector::zero(simd);
        return ([x * stiffness, y * stiffness], [springs, zero, springs]);
    }
    let clearance = Vector::splat(simd, mechanism.bearing_clearance);
    let distance = (x * x + y * y).sqrt();
    let touches = distance.above(clearance);
    let distance = touches.select(distance, Vector::splat(simd, 1.0));
    let (ux, uy) = (x / distance, y / distance);
    let force = touches.keep((distance - clearance) * stiffness);
    let across = force / distance;
    let springs = touches.keep(springs);
    (
        [force * ux, force * uy],
        [
            springs * ux * ux + across * uy * uy,
            (springs - across) * ux * uy,
            springs * uy * uy + across * ux * ux,
        ],
    )
}

impl<S: Simd> Loaded<'_, S> {
    /// Ring lever over R_OP: shift of the pitch point across u by a disc's rotation.
    #[inline(always)]
    pub(crate) fn lever(&self) -> f64 {
        self.mechanism.ring_lever() / self.mechanism.pin_circle_radius
    }

    /// Shift of a disc's pitch point (m).
    #[inline(always)]
    pub(crate) fn pitch_shift(&self, [turn, x, y]: [Vector<S>; 3]) -> [Vector<S>; 2] {
        [x, y + turn * self.lever()]
    }

    #[inline(always)]
    fn disc<L: Laws<S>>(
        &self,
        laws: &mut L,
        disc: usize,
        motion: &Motions<S>,
        visit: &mut impl Visit<S>,
    ) -> DiscTerms<S> {
        let [_, x, y] = motion.discs[disc];
        let shift = self.pitch_shift(motion.discs[disc]);
        let ring = self.rings[disc].sums(self.simd, laws, disc, shift, visit);
        let against = motion.against_flange(disc);
        let e = self.mechanism.eccentricity;
        let pins = self.pins[disc].sums(self.simd, laws, disc, e, against, visit);
        let (bearing, springs) = bearing(self.simd, self.mechanism, [x, y]);
        let [bb, bx, by, xx, xy, yy] = pins.hessian;
        let [ring_xx, ring_xy, ring_yy] = ring.hessian;
        let lever = self.lever();
        DiscTerms {
            gradient: [
                pins.gradient[0] + ring.gradient[1] * lever,
                pins.gradient[1] + ring.gradient[0] + bearing[0],
                pins.gradient[2] + ring.gradient[1] + bearing[1],
            ],
            hessian: [
                bb + ring_yy * (lever * lever),
                bx + ring_xy * lever,
                by + ring_yy * lever,
                xx + ring_xx + springs[0],
                xy + ring_xy + springs[1],
                yy + ring_yy + springs[2],
            ],
            flange_gradient: -pins.gradient[0],
            flange_hessian: bb,
            mixed: [-bb, -bx, -by],
        }
    }

    /// Memory for [`Self::set_terms`].
    #[inline(always)]
    pub(crate) fn no_terms(&self) -> Terms<S> {
        let zero = Vector::zero(self.simd);
        let disc = DiscTerms {
            gradient: [zero; 3],
            hessian: [zero; 6],
            flange_gradient: zero,
            flange_hessian: zero,
            mixed: [zero; 3],
        };
        Terms {
            discs: [disc; MAX_DISCS],
            flange_gradient: zero,
            residual: zero,
        }
    }

    /// Gradient and second derivatives in a motion under a force (N) at R_OP.
    #[inline(always)]
    pub(crate) fn set_terms<L: Laws<S>>(
        &self,
        terms: &mut Terms<S>,
        laws: &mut L,
        motion: &Motions<S>,
        force: f64,
        visit: &mut impl Visit<S>,
    ) {
        let mut flange = Vector::splat(self.simd, -force);
        let mut residual = Vector::zero(self.simd);
        for disc in 0..self.mechanism.discs {
            let of_disc = self.disc(laws, disc, motion, visit);
            flange += of_disc.flange_gradient;
            for gradient in of_disc.gradient {
                residual = residual.max(gradient.abs());
            }
            terms.discs[disc] = of_disc;
        }
        terms.flange_gradient = flange;
        terms.residual = residual.max(flange.abs());
    }

    /// Newton's step, by elimination of each disc and then of the flange, and the flange's
    /// stiffness (N/m at R_OP) with the discs free to follow. The farther out of balance, the
    /// shorter the step.
    #[inline(always)]
    fn newton_step(
        &self,
        terms: &Terms<S>,
        residual: Vector<S>,
        step: &mut Motions<S>,
    ) -> Vector<S> {
        let mechanism = self.mechanism;
        let least = 1e-10
            * mechanism
                .bearing_stiffness
                .min(1e3 * mechanism.pin_stiffness[0]);
        let shift = residual * (0.01 / mechanism.eccentricity) + least;
        let one = Vector::splat(self.simd, 1.0);
        let zero = Vector::zero(self.simd);
        let mut following = [[zero; 3]; MAX_DISCS];
        let (mut below, mut above) = (zero, -terms.flange_gradient);
        for (disc, following) in following[..mechanism.discs].iter_mut().enumerate() {
            let terms = &terms.discs[disc];
            // L D L^T of the second derivatives; steps at rest, and for a flange that moves by one.
            let [a00, a01, a02, a11, a12, a22] = terms.hessian;
            let (a00, a11, a22) = (a00 + shift, a11 + shift, a22 + shift);
            let i0 = one / a00;
            let (l10, l20) = (a01 * i0, a02 * i0);
            let i1 = one / (a11 - l10 * a01);
            let part = a12 - l20 * a01;
            let l21 = part * i1;
            let i2 = one / (a22 - l20 * a02 - l21 * part);
            let factors = Factors {
                inverse: [i0, i1, i2],
                below: [l10, l20, l21],
            };
            step.discs[disc] = factors.solve_negative(terms.gradient);
            let follow = factors.solve_negative(terms.mixed);
            *following = follow;
            below += terms.flange_hessian + dot(follow, terms.mixed);
            above -= dot(follow, terms.gradient);
        }
        let flange = above / (below.max(zero) + shift);
        step.flange = flange;
        for (step, following) in step.discs[..mechanism.discs].iter_mut().zip(&following) {
            for (value, following) in step.iter_mut().zip(following) {
                *value += *following * flange;
            }
        }
        below
    }

    /// Stiffness (N/m at R_OP) of the flange with the discs free to follow.
    #[inline(always)]
    pub(crate) fn stiffness(&self, terms: &Terms<S>) -> Vector<S> {
        let mut step = Motions::zero(self.simd);
        self.newton_step(terms, Vector::zero(self.simd), &mut step)
    }

    /// Slope of the energy along a step.
    #[inline(always)]
    fn slope(&self, terms: &Terms<S>, step: &Motions<S>) -> Vector<S> {
        let mut slope = terms.flange_gradient * step.flange;
        for disc in 0..self.mechanism.discs {
            for (gradient, step) in terms.discs[disc].gradient.iter().zip(&step.discs[disc]) {
                slope += *gradient * *step;
            }
        }
        slope
    }

    /// A step in every lane: its length scaled, nothing where at rest.
    #[inline(always)]
    fn scale(&self, step: &mut Motions<S>, factor: Vector<S>) {
        step.flange *= factor;
        for disc in &mut step.discs[..self.mechanism.discs] {
            for value in disc {
                *value *= factor;
            }
        }
    }

    #[inline(always)]
    fn longest(&self, step: &Motions<S>) -> Vector<S> {
        let mut longest = step.flange.abs();
        for disc in &step.discs[..self.mechanism.discs] {
            for value in disc {
                longest = longest.max(value.abs());
            }
        }
        longest
    }

    #[inline(always)]
    fn moved(&self, motion: &Motions<S>, step: &Motions<S>, part: Vector<S>, to: &mut Motions<S>) {
        to.flange = motion.flange + part * step.flange;
        for disc in 0..self.mechanism.discs {
            for k in 0..3 {
                to.discs[disc][k] = motion.discs[disc][k] + part * step.discs[disc][k];
            }
        }
    }

    /// Equilibria under a force (N) at R_OP from motions near them; where they are found. Forces out
    /// of balance below `tolerance` count as none, below `accepted` where steps are rounding errors.
    #[inline(always)]
    pub(crate) fn solve<L: Laws<S>>(
        &self,
        laws: &mut L,
        force: f64,
        motion: &mut Motions<S>,
        terms: &mut Terms<S>,
        (tolerance, accepted): (f64, f64),
    ) -> Mask<S> {
        let simd = self.simd;
        let e = self.mechanism.eccentricity;
        let (zero, one) = (Vector::splat(simd, 0.0), Vector::splat(simd, 1.0));
        let tolerance = Vector::splat(simd, tolerance * force.abs());
        let accepted = Vector::splat(simd, accepted * force.abs());
        let cap = Vector::splat(simd, LONGEST_STEP * e);
        let mut step = Motions::zero(simd);
        let mut trial_at = *motion;
        self.set_terms(terms, laws, motion, force, &mut Nobody);
        let mut resting = Mask::none(simd);
        for _ in 0..MOST_STEPS {
            let moving = resting.or(terms.residual.at_most(tolerance)).not();
            if !moving.any() {
                break;
            }
            laws.next_step();
            self.newton_step(terms, terms.residual, &mut step);
            let longest = self.longest(&step);
            let tiny = longest.at_most(Vector::splat(simd, ROUNDING * e));
            resting = resting.or(tiny.and(terms.residual.at_most(accepted)));
            let limited = longest.above(cap);
            let factor = limited.select(cap / longest.max(Vector::splat(simd, 1e-300)), one);
            let moving = moving.and(resting.not());
            self.scale(&mut step, moving.keep(factor));
            let slope = self.slope(terms, &step);
            // The slope rises along the step: what is left of it lies between these two.
            let (mut short, mut short_slope) = (zero, slope);
            let (mut long, mut long_slope) = (Vector::splat(simd, f64::INFINITY), zero);
            let mut part = one;
            let mut enough = moving.not();
            for trial in 0..MOST_TRIALS {
                self.moved(motion, &step, part, &mut trial_at);
                self.set_terms(terms, laws, &trial_at, force, &mut Nobody);
                let there = self.slope(terms, &step);
                let mut good = there.abs().at_most(slope.abs() * SLOPE_LEFT);
                good = good.or(terms.residual.at_most(tolerance));
                if trial == 0 {
                    good = good.or(zero.above(there));
                }
                enough = enough.or(good);
                if trial + 1 == MOST_TRIALS || !enough.not().any() {
                    break;
                }
                let before = zero.above(there);
                short = before.select(part, short);
                short_slope = before.select(there, short_slope);
                long = before.select(long, part);
                long_slope = before.select(long_slope, there);
                // Where a straight slope would vanish, not too near either end.
                let width = long - short;
                let straight = short - short_slope * width / (long_slope - short_slope);
                let next = straight.max(short + width * 0.1).min(long - width * 0.1);
                part = enough.select(part, next);
            }
            *motion = trial_at;
        }
        resting.or(terms.residual.at_most(tolerance.max(accepted)))
    }

    /// Motions to start from: every disc touches the ring and a pin, as deep (m) as given.
    #[inline(always)]
    pub(crate) fn first_motion(&self, sense: f64, ring_depth: f64, pin_depth: f64) -> Motions<S> {
        let simd = self.simd;
        let (zero, never) = (Vector::splat(simd, 0.0), Vector::splat(simd, f64::INFINITY));
        let mut motion = Motions::zero(simd);
        let mut furthest = zero;
        for disc in 0..self.mechanism.discs {
            // The shift across u at which the first ring pin is touched, and the turn of the
            // flange at which the first hole is.
            let mut across = never;
            if self.rings[disc].is_uniform() {
                let mut fastest = Vector::splat(simd, 0.2);
                for ([_, y], _) in self.rings[disc].rows(simd) {
                    fastest = fastest.max(y * -sense);
                }
                across = Vector::splat(simd, self.mechanism.ring_gap + ring_depth) / fastest;
            } else {
                for ([_, y], gap) in self.rings[disc].rows(simd) {
                    let closing = y * -sense;
                    let there = (gap + ring_depth) / closing;
                    across = closing
                        .above(Vector::splat(simd, 0.2))
                        .select(across.min(there), across);
                }
            }
            let mut ahead = never;
            for ([x, _], gap) in self.pins[disc].rows(simd) {
                let closing = x * -sense;
                let there = Vector::splat(simd, gap + pin_depth) / closing;
                ahead = closing
                    .above(Vector::splat(simd, 0.2))
                    .select(ahead.min(there), ahead);
            }
            let turn = never.above(across).keep(across) * (1.0 / self.lever());
            motion.discs[disc][0] = turn * sense;
            furthest = furthest.max(turn + never.above(ahead).keep(ahead));
        }
        motion.flange = furthest * sense;
        motion
    }
}
