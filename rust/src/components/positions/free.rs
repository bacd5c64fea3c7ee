//! Free turn of the flange, and the torque that holds the input, at positions side by side.

use pulp::Simd;

use crate::components::contact::PowerLaws;
use crate::components::positions::contacts::{Nobody, PinContacts, RingContacts, Visit};
use crate::components::positions::equilibrium::{Loaded, Motions, bearing};
use crate::components::positions::laws::Power;
use crate::components::positions::vector::Vector;

/// Halvings of the range in which a disc is looked for that the ring pushes.
const HALVINGS: usize = 50;

/// Turn of the flange (m at R_OP) between the first contacts of a disc in either sense, without
/// load: the least one of the discs. The eccentric's bearing is in its middle, or where contacts
/// that interfere push it to.
#[inline(always)]
pub(crate) fn backlash<S: Simd>(loaded: &Loaded<'_, S>) -> Vector<S> {
    let (simd, mechanism) = (loaded.simd, loaded.mechanism);
    let (zero, never) = (Vector::splat(simd, 0.0), Vector::splat(simd, f64::INFINITY));
    let lever = loaded.lever();
    let e = mechanism.eccentricity;
    let mut ends = [never; 2];
    for disc in 0..mechanism.discs {
        let ring = &loaded.rings[disc];
        let pushed = pushed_by_interference(loaded, disc);
        let is_pushed = pushed.above(zero).or((-pushed).above(zero)).any();
        let mut turn = [never; 2];
        if ring.is_uniform() && !is_pushed {
            let mut fastest = [zero; 2];
            for ([_, y], _) in ring.rows(simd) {
                fastest = [fastest[0].max(-y), fastest[1].max(y)];
            }
            let gap = Vector::splat(simd, mechanism.ring_gap.max(0.0));
            turn = [gap / (fastest[0] * lever), gap / (fastest[1] * lever)];
        } else {
            for ([x, y], gap) in ring.rows(simd) {
                let there = (gap + x * pushed).max(zero) / (y.abs() * lever);
                let (ahead, behind) = (y.above(zero), (-y).above(zero));
                turn[0] = behind.select(turn[0].min(there), turn[0]);
                turn[1] = ahead.select(turn[1].min(there), turn[1]);
            }
        }
        let mut ahead = [never; 2];
        for ([x, _], gap) in loaded.pins[disc].rows(simd) {
            // |(e + p, 0) + s t| = e + c in both senses of s, with the disc pushed by p.
            let gap = Vector::splat(simd, gap);
            let along = x * (pushed + e);
            let left = (gap - pushed).max(zero) * (gap + pushed + 2.0 * e);
            let root = (along * along + left).sqrt();
            ahead = [ahead[0].min(root + along), ahead[1].min(root - along)];
        }
        for sense in 0..2 {
            ends[sense] = ends[sense].min(turn[sense] + ahead[sense]);
        }
    }
    ends[0] + ends[1]
}

/// Shift (m) of a disc along its eccentricity at which ring, holes and bearing balance without
/// load; zero where nothing interferes. Where gaps of holes differ, a hole that interferes is
/// relieved by the disc's turn instead and does not push.
#[inline(always)]
fn pushed_by_interference<S: Simd>(loaded: &Loaded<'_, S>, disc: usize) -> Vector<S> {
    let (simd, mechanism) = (loaded.simd, loaded.mechanism);
    let zero = Vector::zero(simd);
    let ring = &loaded.rings[disc];
    let holes = &loaded.pins[disc];
    let even_gap = holes.even_gap();
    let mut deepest = Vector::splat(simd, (-even_gap.unwrap_or(0.0)).max(0.0));
    if !ring.is_uniform() || mechanism.ring_gap < 0.0 {
        for (_, gap) in ring.rows(simd) {
            deepest = deepest.max(-gap);
        }
    }
    if !deepest.above(zero).any() {
        return zero;
    }
    let mut laws = Power::<S, 3>::new(simd, PowerLaws::of(mechanism));
    // The farther it is pushed, the more the bearing and the holes hold and the less the ring does.
    let mut high = deepest * 4.0 + mechanism.bearing_clearance;
    let mut low = -high;
    for _ in 0..HALVINGS {
        let middle = (low + high) * 0.5;
        let of_ring = ring.sums(simd, &mut laws, disc, [middle, zero], &mut Nobody);
        let ([of_bearing, _], _) = bearing(simd, mechanism, [middle, zero]);
        let mut pull = of_ring.gradient[0] + of_bearing;
        if even_gap.is_some() {
            let motion = [zero, middle, zero];
            let e = mechanism.eccentricity;
            let of_holes = holes.sums(simd, &mut laws, disc, e, motion, &mut Nobody);
            pull += of_holes.gradient[1];
        }
        let beyond = pull.above(zero);
        high = beyond.select(middle, high);
        low = beyond.select(low, middle);
    }
    deepest.above(zero).keep((low + high) * 0.5)
}

/// Growth of the contacts' energy with the crank's angle (N m): the normals turn and the holes go
/// round as the crank goes on.
pub(crate) struct InputTorque<'a, S: Simd> {
    loaded: &'a Loaded<'a, S>,
    motion: &'a Motions<S>,
    /// Torques so far.
    pub sum: Vector<S>,
    /// Coefficient e (N + 1) / R.
    width: f64,
    turned: f64,
}

impl<'a, S: Simd> InputTorque<'a, S> {
    #[inline(always)]
    pub(crate) fn new(loaded: &'a Loaded<'a, S>, motion: &'a Motions<S>) -> Self {
        let mechanism = loaded.mechanism;
        let pins = mechanism.ring_pins() as f64;
        Self {
            loaded,
            motion,
            sum: Vector::zero(loaded.simd),
            width: mechanism.eccentricity * pins / mechanism.ring_radius,
            turned: mechanism.profile_rotation.abs() * mechanism.ring_lever(),
        }
    }
}

impl<S: Simd> Visit<S> for InputTorque<'_, S> {
    #[inline(always)]
    fn ring(&mut self, disc: usize, contacts: &RingContacts<S>) {
        let shift = self.loaded.pitch_shift(self.motion.discs[disc]);
        let [x, y] = contacts.normal;
        let simd = self.loaded.simd;
        // Angle by which the normal turns back for a crank that goes on by one: with the pins'
        // cosine by the law of cosines, (1 - width cosine) / length^2.
        let square = contacts.length * contacts.length;
        let rest = Vector::splat(simd, 1.0 - self.width * self.width);
        let turn = (rest / square + 1.0) * 0.5;
        let closing = turn * (x * shift[1] - y * shift[0]);
        let wider = y * (turn - 1.0) * (-self.loaded.mechanism.ring_enlargement * self.width);
        let turned = turn * x * self.turned;
        let turned = y.above(Vector::zero(simd)).select(turned, -turned);
        self.sum += contacts.force * (closing - (wider - turned));
    }

    #[inline(always)]
    fn pin(&mut self, disc: usize, contacts: &PinContacts<S>) {
        let rate = 1.0 + 1.0 / self.loaded.mechanism.lobes as f64;
        let [turn, _, _] = self.motion.against_flange(disc);
        self.sum += contacts.force * turn * contacts.across * rate;
    }
}
