//! Equilibrium of flange and discs under an output torque, by Newton's method on the exact
//! geometry, whatever the law of the contacts.

use crate::components::block::{Block, Sym3};
use crate::components::contact::{ContactLaws, PowerLaws};
use crate::components::laws::APPROACH_EXPONENT;
use crate::components::mechanism::{MAX_DISCS, Mechanism, Position};
use crate::components::pins::PinContact;
use crate::components::quadratic::weighted_mean;
use crate::components::ring::RingContact;

/// Rotation of the flange, and rotation and shift of every disc, as lengths (m): rotations times
/// the pin circle's radius R_OP.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motion {
    /// Flange.
    pub flange: f64,
    /// Discs: rotation, shift along the eccentricity, shift across it.
    pub discs: [[f64; 3]; MAX_DISCS],
}

/// An equilibrium, or where the search for it ended.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Equilibrium {
    /// Where flange and discs stand.
    pub motion: Motion,
    /// Whether the forces balance within the tolerance.
    pub converged: bool,
    /// Largest force out of balance (N).
    pub residual: f64,
    /// Growth of the force at R_OP with the flange's motion (N/m).
    pub stiffness: f64,
    /// Newton steps taken.
    pub steps: u32,
}

/// Largest force out of balance that counts as none, over the force at the pin circle.
pub(crate) const TOLERANCE: f64 = 1e-10;
/// Steps below this share of the eccentricity are rounding errors: what they leave is accepted where
/// it is below [`ACCEPTED`] times the force at the pin circle.
pub(crate) const ROUNDING: f64 = 1e-14;
/// Largest force out of balance that is accepted at last, over the force at the pin circle.
pub(crate) const ACCEPTED: f64 = 1e-8;
/// Newton steps after which a position is given up.
const MOST_STEPS: u32 = 200;
/// Points looked at along one step.
pub(crate) const MOST_TRIALS: usize = 20;
/// Longest step of any unknown over the eccentricity.
pub(crate) const LONGEST_STEP: f64 = 0.4;
/// A step is taken in full when the slope along it has fallen to this share, on either side.
pub(crate) const SLOPE_LEFT: f64 = 0.7;

/// What one disc adds to the gradient and the second derivatives.
#[derive(Debug, Clone, Copy, Default)]
struct DiscTerms {
    gradient: [f64; 3],
    hessian: Sym3,
    /// Derivative with respect to the flange, and the mixed ones.
    flange_gradient: f64,
    flange_hessian: f64,
    mixed: [f64; 3],
}

#[derive(Debug, Clone, Copy, Default)]
struct Terms {
    discs: [DiscTerms; MAX_DISCS],
    flange_gradient: f64,
    /// Stiffness (N/m) of what holds the flange.
    held: f64,
    residual: f64,
}

/// What acts on the flange: a force that does not change, or a spring whose far end is held.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pull {
    /// Force (N) at R_OP on a flange in its middle.
    pub force: f64,
    /// How much of it goes with the flange's motion (N/m); zero for a force that does not change.
    pub stiffness: f64,
    /// Force (N) against which forces out of balance are measured.
    pub scale: f64,
}

impl Pull {
    /// A constant force (N).
    #[inline(always)]
    #[must_use]
    pub const fn of_force(force: f64) -> Self {
        Self {
            force,
            stiffness: 0.0,
            scale: force.abs(),
        }
    }
}

/// Spring of the eccentric's bearing: gradient and second derivatives xx, xy, yy.
#[inline(always)]
pub(crate) fn bearing(mechanism: &Mechanism, x: f64, y: f64) -> ([f64; 2], [f64; 3]) {
    let stiffness = mechanism.bearing_stiffness;
    let clearance = mechanism.bearing_clearance;
    if clearance == 0.0 {
        return ([stiffness * x, stiffness * y], [stiffness, 0.0, stiffness]);
    }
    let distance = (x * x + y * y).sqrt();
    if distance <= clearance {
        return ([0.0; 2], [0.0; 3]);
    }
    let (ux, uy) = (x / distance, y / distance);
    let force = stiffness * (distance - clearance);
    let across = force / distance;
    (
        [force * ux, force * uy],
        [
            stiffness * ux * ux + across * uy * uy,
            (stiffness - across) * ux * uy,
            stiffness * uy * uy + across * ux * ux,
        ],
    )
}

/// A drive at one position of the crank, ready to be loaded.
#[derive(Debug, Clone, Copy)]
pub struct Loaded<'a, L> {
    mechanism: &'a Mechanism,
    position: &'a Position,
    /// Ring lever over R_OP: shift of the pitch point across u by a disc's rotation.
    lever: f64,
    laws: L,
    tolerance: f64,
}

impl<'a> Loaded<'a, PowerLaws> {
    /// The drive at the position, by the full engine.
    #[inline(always)]
    #[must_use]
    pub fn full(mechanism: &'a Mechanism, position: &'a Position) -> Self {
        Self::new(mechanism, position, PowerLaws::of(mechanism), TOLERANCE)
    }
}

impl<'a, L: ContactLaws> Loaded<'a, L> {
    /// The drive at the position. Forces out of balance below `tolerance` times the force at the
    /// pin circle count as none.
    #[inline(always)]
    #[must_use]
    pub fn new(mechanism: &'a Mechanism, position: &'a Position, laws: L, tolerance: f64) -> Self {
        Self {
            mechanism,
            position,
            lever: mechanism.ring_lever() / mechanism.pin_circle_radius,
            laws,
            tolerance,
        }
    }

    /// Shift of a disc's pitch point (m).
    #[inline(always)]
    #[must_use]
    pub fn pitch_shift(&self, disc: [f64; 3]) -> [f64; 2] {
        [disc[1], disc[2] + self.lever * disc[0]]
    }

    #[inline(always)]
    fn disc(&self, disc: usize, motion: &Motion) -> DiscTerms {
        let [turn, x, y] = motion.discs[disc];
        let ring =
            self.position.rings[disc].force(&self.laws, disc, self.pitch_shift(motion.discs[disc]));
        let pins = self.position.pins[disc].force(
            &self.laws,
            disc,
            self.mechanism.eccentricity,
            [turn - motion.flange, x, y],
        );
        let (bearing, springs) = bearing(self.mechanism, x, y);
        let [bb, bx, by, xx, xy, yy] = pins.hessian;
        let [ring_xx, ring_xy, ring_yy] = ring.hessian;
        let lever = self.lever;
        DiscTerms {
            gradient: [
                pins.gradient[0] + lever * ring.gradient[1],
                pins.gradient[1] + ring.gradient[0] + bearing[0],
                pins.gradient[2] + ring.gradient[1] + bearing[1],
            ],
            hessian: Sym3([
                bb + lever * lever * ring_yy,
                bx + lever * ring_xy,
                by + lever * ring_yy,
                xx + ring_xx + springs[0],
                xy + ring_xy + springs[1],
                yy + ring_yy + springs[2],
            ]),
            flange_gradient: -pins.gradient[0],
            flange_hessian: bb,
            mixed: [-bb, -bx, -by],
        }
    }

    #[inline(always)]
    fn terms(&self, motion: &Motion, pull: Pull) -> Terms {
        let mut terms = Terms {
            flange_gradient: pull.stiffness * motion.flange - pull.force,
            held: pull.stiffness,
            ..Terms::default()
        };
        for disc in 0..self.mechanism.discs {
            let of_disc = self.disc(disc, motion);
            terms.flange_gradient += of_disc.flange_gradient;
            for gradient in of_disc.gradient {
                terms.residual = terms.residual.max(gradient.abs());
            }
            terms.discs[disc] = of_disc;
        }
        terms.residual = terms.residual.max(terms.flange_gradient.abs());
        terms
    }

    /// Force (N) at R_OP that holds the flange in a motion.
    #[must_use]
    pub fn flange_force(&self, motion: &Motion) -> f64 {
        self.terms(motion, Pull::default()).flange_gradient
    }

    /// The contacts' laws.
    #[inline(always)]
    #[must_use]
    pub const fn laws(&self) -> &L {
        &self.laws
    }

    /// Mean penetration (m) of a disc's ring contacts, each weighed by its own.
    #[inline(always)]
    #[must_use]
    pub fn mean_ring_depth(&self, disc: usize, motion: &Motion) -> Option<f64> {
        self.position.rings[disc].weighted_depth(self.pitch_shift(motion.discs[disc]))
    }

    /// Mean penetration (m) of a disc's output contacts, each weighed by its own.
    #[inline(always)]
    #[must_use]
    pub fn mean_pin_depth(&self, disc: usize, motion: &Motion) -> Option<f64> {
        weighted_mean(self.pin_depths(disc, motion))
    }

    /// The flange's stiffness (N/m at R_OP) in a motion, the discs free to follow.
    #[inline(always)]
    #[must_use]
    pub fn stiffness_at(&self, motion: &Motion) -> f64 {
        // What is out of balance shortens steps; it has no part in the stiffness.
        let terms = Terms {
            residual: 0.0,
            ..self.terms(motion, Pull::default())
        };
        self.newton_step(&terms).1
    }

    /// A motion to start from: every disc touches the ring and a pin, about as deep as the load
    /// asks for.
    #[inline(always)]
    #[must_use]
    pub fn first_motion(&self, torque: f64) -> Motion {
        let mechanism = self.mechanism;
        let sense = if torque < 0.0 { -1.0 } else { 1.0 };
        let share = torque.abs() / mechanism.discs as f64;
        let ring_force = 4.0 * share / (mechanism.ring_lever() * mechanism.ring_pins() as f64);
        let ring_depth = (ring_force / mechanism.ring_stiffness).powf(APPROACH_EXPONENT);
        let pin_force = 4.0 * share / (mechanism.pin_circle_radius * mechanism.output_pins as f64);
        let pin_depth = (pin_force / mechanism.hole_stiffness).powf(APPROACH_EXPONENT)
            + pin_force / mechanism.pin_stiffness[0];
        let mut motion = Motion::default();
        let mut furthest = 0.0_f64;
        for disc in 0..mechanism.discs {
            // The shift across u at which the first ring pin is touched, and the turn of the
            // flange at which the first hole is.
            let mut across = f64::INFINITY;
            for (normal, gap) in self.position.rings[disc].contacts() {
                let closing = -sense * normal[1];
                if closing > 0.2 {
                    across = across.min((gap + ring_depth) / closing);
                }
            }
            let mut ahead = f64::INFINITY;
            for (tangent, gap) in self.position.pins[disc].contacts() {
                let closing = -sense * tangent[0];
                if closing > 0.2 {
                    ahead = ahead.min((gap + pin_depth) / closing);
                }
            }
            let turn = if across.is_finite() {
                across / self.lever
            } else {
                0.0
            };
            let ahead = if ahead.is_finite() { ahead } else { 0.0 };
            motion.discs[disc] = [sense * turn, 0.0, 0.0];
            furthest = furthest.max(turn + ahead);
        }
        motion.flange = sense * furthest;
        motion
    }

    /// The equilibrium under an output torque (N m), from a motion near it.
    #[inline(always)]
    #[must_use]
    pub fn solve(&self, torque: f64, start: &Motion) -> Equilibrium {
        self.settle(
            Pull::of_force(torque / self.mechanism.pin_circle_radius),
            start,
        )
    }

    /// The equilibrium under a pull on the flange, from a motion near it.
    #[inline(always)]
    #[must_use]
    pub fn settle(&self, pull: Pull, start: &Motion) -> Equilibrium {
        let mechanism = self.mechanism;
        let tolerance = self.tolerance * pull.scale;
        let accepted = tolerance.max(ACCEPTED * pull.scale);
        let cap = LONGEST_STEP * mechanism.eccentricity;
        let mut motion = *start;
        let mut terms = self.terms(&motion, pull);
        let mut steps = 0;
        while terms.residual > tolerance && steps < MOST_STEPS {
            steps += 1;
            let (mut step, _) = self.newton_step(&terms);
            let longest = longest(&step, mechanism.discs);
            if longest <= ROUNDING * mechanism.eccentricity && terms.residual <= accepted {
                break;
            }
            if longest > cap {
                scale_motion(&mut step, cap / longest);
            }
            let slope = self.slope(&terms, &step);
            // The slope rises along the step: what is left of it lies between these two.
            let (mut short, mut long) = ((0.0, slope), (f64::INFINITY, 0.0));
            let mut part = 1.0;
            for trial in 0..MOST_TRIALS {
                let at_trial = moved(&motion, &step, part);
                let terms_there = self.terms(&at_trial, pull);
                let slope_there = self.slope(&terms_there, &step);
                let enough = slope_there.abs() <= SLOPE_LEFT * slope.abs()
                    || terms_there.residual <= tolerance
                    || (part == 1.0 && slope_there < 0.0);
                if enough || trial + 1 == MOST_TRIALS {
                    motion = at_trial;
                    terms = terms_there;
                    break;
                }
                if slope_there < 0.0 {
                    short = (part, slope_there);
                } else {
                    long = (part, slope_there);
                }
                // Where a straight slope would vanish, not too near either end.
                let width = long.0 - short.0;
                let straight = short.0 - short.1 * width / (long.1 - short.1);
                part = straight.clamp(short.0 + 0.1 * width, long.0 - 0.1 * width);
            }
        }
        let (_, stiffness) = self.newton_step(&terms);
        Equilibrium {
            motion,
            converged: terms.residual <= accepted,
            residual: terms.residual,
            stiffness,
            steps,
        }
    }

    /// Newton's step, by elimination of each disc and then of the flange, and the flange's
    /// stiffness with the discs free to follow.
    #[inline(always)]
    fn newton_step(&self, terms: &Terms) -> (Motion, f64) {
        let mechanism = self.mechanism;
        let least = 1e-10
            * mechanism
                .bearing_stiffness
                .min(1e3 * mechanism.pin_stiffness[0]);
        let shift = least + 0.01 * terms.residual / mechanism.eccentricity;
        let mut blocks = [Block::default(); MAX_DISCS];
        let (mut below, mut above) = (0.0, -terms.flange_gradient);
        for (block, of_disc) in blocks.iter_mut().zip(&terms.discs[..mechanism.discs]) {
            *block = Block::eliminate(
                of_disc.hessian.shifted(shift),
                of_disc.gradient,
                of_disc.mixed,
            );
            below += of_disc.flange_hessian - block.reduction(of_disc.mixed);
            above += block.transfer(of_disc.gradient);
        }
        let stiffness = below;
        let flange = above / (below.max(0.0) + terms.held + shift);
        let mut step = Motion {
            flange,
            ..Motion::default()
        };
        for (step, block) in step.discs.iter_mut().zip(&blocks[..mechanism.discs]) {
            *step = block.back(flange);
        }
        (step, stiffness)
    }

    /// Slope of the energy along a step.
    #[inline(always)]
    fn slope(&self, terms: &Terms, step: &Motion) -> f64 {
        let mut slope = terms.flange_gradient * step.flange;
        for disc in 0..self.mechanism.discs {
            for (gradient, step) in terms.discs[disc].gradient.iter().zip(step.discs[disc]) {
                slope += gradient * step;
            }
        }
        slope
    }

    /// Penetration (m) of every output pin into a disc's hole, below zero where it does not touch.
    pub fn pin_depths(&self, disc: usize, motion: &Motion) -> impl Iterator<Item = f64> + '_ {
        let against_flange = against_flange(disc, motion);
        self.position.pins[disc].depths(self.mechanism.eccentricity, against_flange)
    }

    /// Appends the force (N) of every ring pin on a disc.
    #[inline(always)]
    pub fn ring_forces(&self, disc: usize, motion: &Motion, out: &mut Vec<f64>) {
        let shift = self.pitch_shift(motion.discs[disc]);
        self.position.rings[disc].forces(&self.laws, disc, shift, out);
    }

    /// Appends the force (N) of a disc on every output pin.
    #[inline(always)]
    pub fn pin_forces(&self, disc: usize, motion: &Motion, out: &mut Vec<f64>) {
        let (eccentricity, motion) = (self.mechanism.eccentricity, against_flange(disc, motion));
        self.position.pins[disc].forces(&self.laws, disc, eccentricity, motion, out);
    }

    /// Every contact of a disc with the ring, with the forces found for it.
    pub fn ring_contacts<'b>(
        &'b self,
        disc: usize,
        motion: &Motion,
        forces: &'b [f64],
    ) -> impl Iterator<Item = RingContact> + 'b {
        self.position.rings[disc].details(self.pitch_shift(motion.discs[disc]), forces)
    }

    /// Every contact of a disc with the output pins, with the forces found for it.
    pub fn pin_contacts<'b>(
        &'b self,
        disc: usize,
        motion: &Motion,
        forces: &'b [f64],
    ) -> impl Iterator<Item = PinContact> + 'b {
        let motion = against_flange(disc, motion);
        self.position.pins[disc].details(self.mechanism.eccentricity, motion, forces)
    }

    /// Torque (N m) at the input that holds the equilibrium under an output torque (N m) without
    /// friction, by virtual work: `T / N + dU / d theta`. `forces` is memory to use.
    #[must_use]
    pub fn input_torque(&self, torque: f64, motion: &Motion, forces: &mut Vec<f64>) -> f64 {
        let mechanism = self.mechanism;
        let mut input = torque / mechanism.lobes as f64;
        for disc in 0..mechanism.discs {
            forces.clear();
            self.ring_forces(disc, motion, forces);
            let shift = self.pitch_shift(motion.discs[disc]);
            input += self.position.rings[disc].crank_torque(mechanism, shift, forces);
            forces.clear();
            self.pin_forces(disc, motion, forces);
            let motion = against_flange(disc, motion);
            input += self.position.pins[disc].crank_torque(mechanism, motion, forces);
        }
        input
    }

    /// Force (N) of a disc on the eccentric's bearing, along u and across.
    #[must_use]
    pub fn bearing_force(&self, disc: usize, motion: &Motion) -> [f64; 2] {
        let [_, x, y] = motion.discs[disc];
        bearing(self.mechanism, x, y).0
    }
}

/// A disc's rotation against the flange, and its shift.
#[inline(always)]
fn against_flange(disc: usize, motion: &Motion) -> [f64; 3] {
    let [turn, x, y] = motion.discs[disc];
    [turn - motion.flange, x, y]
}

#[inline(always)]
fn moved(motion: &Motion, step: &Motion, part: f64) -> Motion {
    let mut moved = *motion;
    moved.flange += part * step.flange;
    for (disc, step) in moved.discs.iter_mut().zip(&step.discs) {
        for (value, step) in disc.iter_mut().zip(step) {
            *value += part * step;
        }
    }
    moved
}

#[inline(always)]
fn scale_motion(step: &mut Motion, factor: f64) {
    step.flange *= factor;
    for disc in &mut step.discs {
        for value in disc {
            *value *= factor;
        }
    }
}

#[inline(always)]
fn longest(step: &Motion, discs: usize) -> f64 {
    let mut longest = step.flange.abs();
    for disc in &step.discs[..discs] {
        for value in disc {
            longest = longest.max(value.abs());
        }
    }
    longest
}
