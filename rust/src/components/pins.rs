//! Contacts of one disc with the output pins: exact distances of hole and pin centres, and the
//! forces of a Hertzian contact in series with a bending pin.

use crate::components::contact::{ContactLaws, LEAST_DEPTH};
use crate::components::mechanism::{Circle, Mechanism};

/// Contacts computed side by side.
const WIDTH: usize = 4;
/// Gap of a contact that is only there to fill the last group (m).
const NEVER: f64 = 1e6;

/// Output contacts of one disc in its own directions u and v, filled up to a whole group.
#[derive(Debug, Clone, Default)]
pub struct PinRow {
    pins: usize,
    /// Direction in which a rotation of the disc moves the hole.
    tangent_x: Vec<f64>,
    tangent_y: Vec<f64>,
    gap: Vec<f64>,
}

/// One contact of a disc with an output pin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinContact {
    /// Force (N).
    pub force: f64,
    /// Penetration (m), the pin's deflection included.
    pub depth: f64,
    /// Clearance taken up before, and what the turn of the line of centres adds to it (m).
    pub taken_up: f64,
    /// Share of the force along the motion of the hole under a rotation of the disc.
    pub along: f64,
}

/// Sum of the forces on a disc and of their growth with its motion (rotation times R_OP, x, y).
///
/// The flange's rotation enters all of them as the disc's with the other sign.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PinForce {
    /// Gradient of the pins' energy (N).
    pub gradient: [f64; 3],
    /// Second derivatives bb, bx, by, xx, xy, yy of it (N/m).
    pub hessian: [f64; 6],
}

impl PinRow {
    /// The contacts of a disc whose holes are turned back by `at` (rad), into memory used before.
    #[inline(always)]
    pub(crate) fn set(&mut self, mechanism: &Mechanism, circle: &Circle, at: f64) {
        let pins = mechanism.output_pins;
        let padded = pins.div_ceil(WIDTH) * WIDTH;
        self.pins = pins;
        self.tangent_x.clear();
        self.tangent_y.clear();
        let (sin, cos) = at.sin_cos();
        for (c, s) in circle.cos.iter().zip(&circle.sin) {
            self.tangent_x.push(c * sin - s * cos);
            self.tangent_y.push(c * cos + s * sin);
        }
        self.tangent_x.resize(padded, 0.0);
        self.tangent_y.resize(padded, 1.0);
        self.gap.clear();
        self.gap.resize(pins, mechanism.hole_gap);
        for (gap, error) in self.gap.iter_mut().zip(&mechanism.hole_gap_errors) {
            *gap += error;
        }
        self.gap.resize(padded, NEVER);
    }

    /// Forces under a disc's motion against the flange: rotation times R_OP, x and y (m).
    #[inline(always)]
    #[must_use]
    pub fn force<L: ContactLaws>(
        &self,
        laws: &L,
        disc: usize,
        eccentricity: f64,
        motion: [f64; 3],
    ) -> PinForce {
        let mut gradient = [[0.0_f64; WIDTH]; 3];
        let mut hessian = [[0.0_f64; WIDTH]; 6];
        let [turn, x, y] = motion;
        let groups = self.tangent_x.chunks_exact(WIDTH);
        let groups = groups.zip(self.tangent_y.chunks_exact(WIDTH));
        for ((tx, ty), gap) in groups.zip(self.gap.chunks_exact(WIDTH)) {
            for lane in 0..WIDTH {
                let dx = eccentricity + x + turn * tx[lane];
                let dy = y + turn * ty[lane];
                let distance = (dx * dx + dy * dy).sqrt();
                let (mx, my) = (dx / distance, dy / distance);
                let depth = distance - eccentricity - gap[lane];
                let touches = depth > LEAST_DEPTH;
                let (force, slope) = laws.pin(disc, if touches { depth } else { LEAST_DEPTH });
                let force = if touches { force } else { 0.0 };
                let slope = if touches { slope } else { 0.0 };
                // Along the line of centres and across it, under (turn, x, y).
                let along = mx * tx[lane] + my * ty[lane];
                let across = mx * ty[lane] - my * tx[lane];
                let stiffening = force / distance;
                gradient[0][lane] += force * along;
                gradient[1][lane] += force * mx;
                gradient[2][lane] += force * my;
                hessian[0][lane] += slope * along * along + stiffening * across * across;
                hessian[1][lane] += slope * along * mx - stiffening * across * my;
                hessian[2][lane] += slope * along * my + stiffening * across * mx;
                hessian[3][lane] += slope * mx * mx + stiffening * my * my;
                hessian[4][lane] += (slope - stiffening) * mx * my;
                hessian[5][lane] += slope * my * my + stiffening * mx * mx;
            }
        }
        PinForce {
            gradient: gradient.map(|lanes| sum(&lanes)),
            hessian: hessian.map(|lanes| sum(&lanes)),
        }
    }

    /// Penetration (m, below zero a gap) of each pin under a disc's motion against the flange.
    pub fn depths(&self, eccentricity: f64, motion: [f64; 3]) -> impl Iterator<Item = f64> + '_ {
        let [turn, x, y] = motion;
        let tangents = self.tangent_x.iter().zip(&self.tangent_y);
        tangents
            .zip(&self.gap)
            .map(move |((tx, ty), gap)| {
                let (dx, dy) = (eccentricity + x + turn * tx, y + turn * ty);
                (dx * dx + dy * dy).sqrt() - eccentricity - gap
            })
            .take(self.pins)
    }

    /// Appends the force (N) on each pin under a disc's motion against the flange.
    pub fn forces<L: ContactLaws>(
        &self,
        laws: &L,
        disc: usize,
        eccentricity: f64,
        motion: [f64; 3],
        out: &mut Vec<f64>,
    ) {
        let depths = self.depths(eccentricity, motion);
        out.extend(depths.map(|depth| {
            if depth > LEAST_DEPTH {
                laws.pin(disc, depth).0
            } else {
                0.0
            }
        }));
    }

    /// Growth of the pins' energy with the crank's angle (N m) at a disc's motion, with the forces
    /// found for it: the holes turn against the eccentricity as the crank goes on.
    #[must_use]
    pub fn crank_torque(&self, mechanism: &Mechanism, motion: [f64; 3], forces: &[f64]) -> f64 {
        let [turn, x, y] = motion;
        let rate = 1.0 + 1.0 / mechanism.lobes as f64;
        let torque = |(([tx, ty], _), force): (([f64; 2], f64), &f64)| {
            let (dx, dy) = (mechanism.eccentricity + x + turn * tx, y + turn * ty);
            let distance = (dx * dx + dy * dy).sqrt();
            force * rate * turn * (dx * ty - dy * tx) / distance
        };
        self.contacts().zip(forces).map(torque).sum()
    }

    /// Every contact under a disc's motion against the flange, with the forces found for it.
    pub fn details<'a>(
        &'a self,
        eccentricity: f64,
        motion: [f64; 3],
        forces: &'a [f64],
    ) -> impl Iterator<Item = PinContact> + 'a {
        let [turn, x, y] = motion;
        self.contacts()
            .zip(forces)
            .map(move |((tangent, gap), force)| {
                let (dx, dy) = (eccentricity + x + turn * tangent[0], y + turn * tangent[1]);
                let distance = (dx * dx + dy * dy).sqrt();
                PinContact {
                    force: *force,
                    depth: distance - eccentricity - gap,
                    taken_up: gap + eccentricity * (1.0 - dx / distance),
                    along: (dx * tangent[0] + dy * tangent[1]) / distance,
                }
            })
    }

    /// Direction in which a rotation moves each hole, and the gap (m) there.
    pub fn contacts(&self) -> impl Iterator<Item = ([f64; 2], f64)> + '_ {
        let tangents = self.tangent_x.iter().zip(&self.tangent_y);
        tangents
            .zip(&self.gap)
            .map(|((x, y), gap)| ([*x, *y], *gap))
            .take(self.pins)
    }
}

#[inline(always)]
fn sum(lanes: &[f64; WIDTH]) -> f64 {
    let [a, b, c, d] = *lanes;
    (a + c) + (b + d)
}
