//! What an equilibrium needs of a drive: its exact geometry, gaps and stiffnesses, in SI.

use crate::components::pins::PinRow;
use crate::components::ring::RingRow;

/// Most cycloid discs of a drive.
pub const MAX_DISCS: usize = 4;

/// Geometry, gaps and stiffnesses of a drive whose discs, flange and eccentric are rigid but for
/// their contacts, pins and bearings. SI.
///
/// With the crank at `theta`, disc `k` stands at `theta_k = theta + 2 pi k / n`, `u` points along
/// its eccentricity and `v` across. Its contacts with the ring all pass through the pitch point
/// `P = e (N + 1) u`, so the ring sees no more of a disc's motion `(x, y, beta)` than the shift
/// `(x, y + e N beta)` of that point.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// Lobes N of a disc; the ring has one pin more.
    pub lobes: usize,
    /// Cycloid discs, equally phased.
    pub discs: usize,
    /// Output pins.
    pub output_pins: usize,
    /// Eccentricity e (m).
    pub eccentricity: f64,
    /// Radius R of the ring pins' circle (m).
    pub ring_radius: f64,
    /// Radius R_OP of the output pins' circle (m).
    pub pin_circle_radius: f64,
    /// Angle of output pin 0 from ring pin 0 with the crank at zero (rad).
    pub hole_clocking: f64,
    /// Gap at every ring pin along its normal (m): an equidistant profile offset. Below zero it is
    /// an interference.
    pub ring_gap: f64,
    /// How much larger the ring pins' circle is than the profile's (m).
    pub ring_enlargement: f64,
    /// Angle by which both flanks of the profile are turned back (rad).
    pub profile_rotation: f64,
    /// Further gap of each ring pin (m); empty where all are alike.
    pub ring_gap_errors: Vec<f64>,
    /// Radial gap of every hole beyond pin, bush and eccentricity (m).
    pub hole_gap: f64,
    /// Further gap of each hole, one list for all discs (m); empty where all are alike.
    pub hole_gap_errors: Vec<f64>,
    /// Stiffness of a ring pin's contacts (N/m^(10/9)).
    pub ring_stiffness: f64,
    /// Stiffness of a hole's contact (N/m^(10/9)).
    pub hole_stiffness: f64,
    /// Stiffness of an output pin with its root, under the force of each disc (N/m).
    pub pin_stiffness: [f64; MAX_DISCS],
    /// Stiffness of the eccentric's bearing, each disc (N/m).
    pub bearing_stiffness: f64,
    /// Radial clearance of the eccentric's bearing (m).
    pub bearing_clearance: f64,
}

/// Cosines and sines of equal parts of a turn.
#[derive(Debug, Clone, Default)]
pub struct Circle {
    /// Cosine of each part.
    pub cos: Vec<f64>,
    /// Sine of each part.
    pub sin: Vec<f64>,
}

impl Circle {
    /// `count` equal parts of a turn, beginning at `first` (rad).
    pub fn divide(&mut self, count: usize, first: f64) {
        let pitch = std::f64::consts::TAU / count as f64;
        let angles = (0..count).map(|k| first + pitch * k as f64);
        self.cos.clear();
        self.cos.extend(angles.clone().map(f64::cos));
        self.sin.clear();
        self.sin.extend(angles.map(f64::sin));
    }
}

impl Mechanism {
    /// Ring pins.
    #[inline(always)]
    #[must_use]
    pub const fn ring_pins(&self) -> usize {
        self.lobes + 1
    }

    /// Position (rad) of a disc with the crank at `crank` (rad).
    #[inline(always)]
    #[must_use]
    pub fn disc_angle(&self, crank: f64, disc: usize) -> f64 {
        crank + std::f64::consts::TAU * disc as f64 / self.discs as f64
    }

    /// Lever e N (m) of the ring's tangential force on a disc: `T_disc = e N F_t` in every
    /// equilibrium.
    #[inline(always)]
    #[must_use]
    pub fn ring_lever(&self) -> f64 {
        self.eccentricity * self.lobes as f64
    }
}

/// All contacts of a drive at one position of the crank.
#[derive(Debug, Clone, Default)]
pub struct Position {
    /// Ring contacts of each disc.
    pub rings: [RingRow; MAX_DISCS],
    /// Output contacts of each disc.
    pub pins: [PinRow; MAX_DISCS],
}

/// The circles of ring pins and output pins of a drive, as they stand at crank zero.
#[derive(Debug, Clone, Default)]
pub struct Circles {
    ring: Circle,
    output: Circle,
}

impl Circles {
    /// The circles of a drive, into memory used before.
    pub fn set(&mut self, mechanism: &Mechanism) {
        self.ring.divide(mechanism.ring_pins(), 0.0);
        self.output
            .divide(mechanism.output_pins, mechanism.hole_clocking);
    }
}

impl Position {
    /// The contacts with the crank at `crank` (rad), into memory used before.
    #[inline(always)]
    pub fn set(&mut self, mechanism: &Mechanism, circles: &Circles, crank: f64) {
        for disc in 0..mechanism.discs {
            let at = mechanism.disc_angle(crank, disc);
            self.rings[disc].set(mechanism, &circles.ring, at);
            let turned = at + crank / mechanism.lobes as f64;
            self.pins[disc].set(mechanism, &circles.output, turned);
        }
    }
}
