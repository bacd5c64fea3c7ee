//! Contacts of one disc with its ring pins: normals, gaps, and the forces under a shift of the
//! pitch point.

use crate::components::contact::{ContactLaws, LEAST_DEPTH};
use crate::components::mechanism::{Circle, Mechanism};

/// Contacts computed side by side.
const WIDTH: usize = 8;
/// Gap of a contact that is only there to fill the last group (m).
const NEVER: f64 = 1e6;

/// Ring contacts of one disc in its own directions u and v, filled up to a whole group.
#[derive(Debug, Clone, Default)]
pub struct RingRow {
    pins: usize,
    normal_x: Vec<f64>,
    normal_y: Vec<f64>,
    gap: Vec<f64>,
    /// Cosine of each pin's direction to u, and distance from pin to pitch point (m).
    cosine: Vec<f64>,
    to_pitch: Vec<f64>,
}

/// One contact of a disc with a ring pin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingContact {
    /// Direction of the force on the disc.
    pub normal: [f64; 2],
    /// Force (N).
    pub force: f64,
    /// Penetration (m).
    pub depth: f64,
    /// Gap (m) before any motion.
    pub gap: f64,
    /// Cosine of the pin's direction to u.
    pub cosine: f64,
    /// Distance (m) from the pin's centre to the pitch point.
    pub to_pitch: f64,
}

/// Sum of the forces on a disc and of their growth with the pitch point's shift.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RingForce {
    /// What the ring resists with along u and v: the gradient of its energy (N).
    pub gradient: [f64; 2],
    /// Second derivatives xx, xy, yy of its energy (N/m).
    pub hessian: [f64; 3],
}

impl RingRow {
    /// The contacts of a disc at `at` (rad), into memory used before.
    #[inline(always)]
    pub(crate) fn set(&mut self, mechanism: &Mechanism, circle: &Circle, at: f64) {
        let pins = mechanism.ring_pins();
        let padded = pins.div_ceil(WIDTH) * WIDTH;
        self.pins = pins;
        self.normal_x.clear();
        self.normal_x.resize(padded, 0.0);
        self.normal_y.clear();
        self.normal_y.resize(padded, 0.0);
        self.gap.clear();
        self.gap.resize(padded, NEVER);
        self.cosine.clear();
        self.cosine.resize(padded, 0.0);
        self.to_pitch.clear();
        self.to_pitch.resize(padded, 0.0);
        let (sin, cos) = at.sin_cos();
        let width = mechanism.eccentricity * pins as f64 / mechanism.ring_radius;
        let uniform = mechanism.ring_gap;
        let enlargement = mechanism.ring_enlargement;
        let turned = mechanism.profile_rotation.abs() * mechanism.ring_lever();
        let normals = self.normal_x.iter_mut().zip(&mut self.normal_y);
        let circle = circle.cos.iter().zip(&circle.sin);
        let places = self.cosine.iter_mut().zip(&mut self.to_pitch);
        let rows = normals.zip(&mut self.gap).zip(places).zip(circle);
        for ((((x, y), gap), (cosine, to_pitch)), (c, s)) in rows {
            // Pin over R, in the disc's directions.
            let (pin_x, pin_y) = (c * cos + s * sin, s * cos - c * sin);
            let (to_pitch_x, to_pitch_y) = (width - pin_x, -pin_y);
            let length = (to_pitch_x * to_pitch_x + to_pitch_y * to_pitch_y).sqrt();
            *cosine = pin_x;
            *to_pitch = mechanism.ring_radius * length;
            *x = to_pitch_x / length;
            *y = to_pitch_y / length;
            let outward = (1.0 - width * pin_x) / length;
            *gap = uniform + enlargement * outward + turned * y.abs();
        }
        for (gap, error) in self.gap.iter_mut().zip(&mechanism.ring_gap_errors) {
            *gap += error;
        }
    }

    /// Forces under a shift (m) of the pitch point along u and v.
    #[inline(always)]
    #[must_use]
    pub fn force<L: ContactLaws>(&self, laws: &L, disc: usize, shift: [f64; 2]) -> RingForce {
        let [mut fx, mut fy] = [[0.0_f64; WIDTH]; 2];
        let [mut xx, mut xy, mut yy] = [[0.0_f64; WIDTH]; 3];
        let groups = self.normal_x.chunks_exact(WIDTH);
        let groups = groups.zip(self.normal_y.chunks_exact(WIDTH));
        for ((x, y), gap) in groups.zip(self.gap.chunks_exact(WIDTH)) {
            let mut depth = [0.0_f64; WIDTH];
            let mut any = false;
            for lane in 0..WIDTH {
                depth[lane] = -(x[lane] * shift[0] + y[lane] * shift[1]) - gap[lane];
                any |= depth[lane] > 0.0;
            }
            if !any {
                continue;
            }
            for lane in 0..WIDTH {
                let touches = depth[lane] > LEAST_DEPTH;
                let depth = if touches { depth[lane] } else { LEAST_DEPTH };
                let (secant, growth) = laws.ring(disc, depth);
                let force = if touches { secant * depth } else { 0.0 };
                let growth = if touches { growth } else { 0.0 };
                fx[lane] -= force * x[lane];
                fy[lane] -= force * y[lane];
                xx[lane] += growth * x[lane] * x[lane];
                xy[lane] += growth * x[lane] * y[lane];
                yy[lane] += growth * y[lane] * y[lane];
            }
        }
        RingForce {
            gradient: [sum(&fx), sum(&fy)],
            hessian: [sum(&xx), sum(&xy), sum(&yy)],
        }
    }

    /// Appends the force (N) of each ring pin under a shift (m) of the pitch point.
    #[inline(always)]
    pub fn forces<L: ContactLaws>(
        &self,
        laws: &L,
        disc: usize,
        shift: [f64; 2],
        out: &mut Vec<f64>,
    ) {
        let end = out.len() + self.pins;
        let groups = self.normal_x.chunks_exact(WIDTH);
        let groups = groups.zip(self.normal_y.chunks_exact(WIDTH));
        for ((x, y), gap) in groups.zip(self.gap.chunks_exact(WIDTH)) {
            let mut forces = [0.0; WIDTH];
            for lane in 0..WIDTH {
                let depth = -(x[lane] * shift[0] + y[lane] * shift[1]) - gap[lane];
                let touches = depth > LEAST_DEPTH;
                let depth = if touches { depth } else { LEAST_DEPTH };
                let force = laws.ring(disc, depth).0 * depth;
                forces[lane] = if touches { force } else { 0.0 };
            }
            out.extend_from_slice(&forces);
        }
        out.truncate(end);
    }

    /// Every contact under a shift of the pitch point, with the forces found for it.
    pub fn details<'a>(
        &'a self,
        shift: [f64; 2],
        forces: &'a [f64],
    ) -> impl Iterator<Item = RingContact> + 'a {
        let places = self.cosine.iter().zip(&self.to_pitch);
        let rows = self.contacts().zip(forces).zip(places);
        rows.map(
            move |(((normal, gap), force), (cosine, to_pitch))| RingContact {
                normal,
                force: *force,
                depth: -(normal[0] * shift[0] + normal[1] * shift[1]) - gap,
                gap,
                cosine: *cosine,
                to_pitch: *to_pitch,
            },
        )
    }

    /// Growth of the ring's energy with the crank's angle (N m) at a disc's motion, with the forces
    /// found for it: the normals turn as the crank goes on.
    #[must_use]
    pub fn crank_torque(&self, mechanism: &Mechanism, shift: [f64; 2], forces: &[f64]) -> f64 {
        let width = mechanism.eccentricity * self.pins as f64 / mechanism.ring_radius;
        let turned = mechanism.profile_rotation.abs() * mechanism.ring_lever();
        let mut torque = 0.0;
        for contact in self.details(shift, forces) {
            let length = contact.to_pitch / mechanism.ring_radius;
            let outward = (1.0 - width * contact.cosine) / length;
            // Angle by which the normal turns back for a crank that goes on by one.
            let turn = outward / length;
            let [x, y] = contact.normal;
            let closing = turn * (x * shift[1] - y * shift[0]);
            let opening = -mechanism.ring_enlargement * width * y * (turn - 1.0)
                - turned * turn * x * y.signum();
            torque += contact.force * (closing - opening);
        }
        torque
    }

    /// Mean penetration (m) under a shift of the pitch point, each contact weighed by its own; none
    /// where none touches.
    #[inline(always)]
    #[must_use]
    pub fn weighted_depth(&self, shift: [f64; 2]) -> Option<f64> {
        let [mut first, mut second] = [[0.0_f64; WIDTH]; 2];
        let groups = self.normal_x.chunks_exact(WIDTH);
        let groups = groups.zip(self.normal_y.chunks_exact(WIDTH));
        for ((x, y), gap) in groups.zip(self.gap.chunks_exact(WIDTH)) {
            for lane in 0..WIDTH {
                let depth = -(x[lane] * shift[0] + y[lane] * shift[1]) - gap[lane];
                let depth = if depth > 0.0 { depth } else { 0.0 };
                first[lane] += depth;
                second[lane] += depth * depth;
            }
        }
        let sum_of_depths = sum(&first);
        (sum_of_depths > LEAST_DEPTH).then(|| sum(&second) / sum_of_depths)
    }

    /// Normal on the disc and gap (m) of each contact.
    pub fn contacts(&self) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
        let normals = self.normal_x.iter().zip(&self.normal_y);
        normals
            .zip(&self.gap)
            .map(|((x, y), gap)| ([*x, *y], *gap))
            .take(self.pins)
    }
}

#[inline(always)]
fn sum(lanes: &[f64; WIDTH]) -> f64 {
    let [a, b, c, d, e, f, g, h] = *lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
