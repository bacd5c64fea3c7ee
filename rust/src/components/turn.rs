//! One drive over a turn of its crank: equilibria at a few positions and loads, and the columns that
//! follow from them.

use std::f64::consts::{PI, TAU};

use crate::components::contact::PowerLaws;
use crate::components::equilibrium::{Equilibrium, Loaded, Motion};
use crate::components::forces::RatedForces;
use crate::components::inputs::PartInput;
use crate::components::mechanism::{Circles, Mechanism, Position};
use crate::components::outputs::{PART_OUTPUTS, PartOutput, Wanted};
use crate::components::parts::{Fixed, Parts};
use crate::components::quadratic::{self, Expected};
use crate::kernel::lanes::Wide;
use crate::model::inputs::Input;

/// Positions of the crank over one period of the output pins, for means and extremes.
pub const POSITIONS: usize = 8;
/// Positions for the transmission error and the ripple of the input torque.
pub const FINE_POSITIONS: usize = 48;
/// Share of the rated torque at which lost motion is measured.
pub const LOST_MOTION_LOAD: f64 = 0.03;

/// An arc minute (rad).
pub const ARCMIN: f64 = PI / 10_800.0;

/// How equilibria are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// By the exact power laws: the reference.
    Full,
    /// By their secants, and by the full engine where that fails.
    Quadratic,
}

/// Memory of one thread.
#[derive(Debug, Default)]
pub struct Scratch {
    circles: Circles,
    position: Position,
    forces: RatedForces,
    memory: Vec<f64>,
}

/// Values of every column; NaN where not asked for.
pub type Row = [f64; PART_OUTPUTS];

/// Work on one drive, to be run with the machine's widest instructions.
#[derive(Debug)]
pub struct Turn<'a> {
    /// The drive's parts.
    pub parts: &'a Parts,
    /// What of them no study varies.
    pub fixed: &'a Fixed,
    /// How equilibria are found.
    pub engine: Engine,
    /// What is asked for.
    pub wanted: Wanted,
    /// Memory to use.
    pub scratch: &'a mut Scratch,
}

/// A load over the positions of the crank: the last equilibrium, from which the next one starts,
/// and sums of what is asked for.
#[derive(Debug, Clone, Copy)]
struct Trace {
    share: f64,
    before: Option<(Motion, Expected)>,
    twist: f64,
    stiffness: f64,
    /// Whether any equilibrium is the full engine's, and whether any was not found at all.
    by_full: bool,
    failed: bool,
}

impl Trace {
    const fn new(share: f64) -> Self {
        Self {
            share,
            before: None,
            twist: 0.0,
            stiffness: 0.0,
            by_full: false,
            failed: false,
        }
    }

    /// The next equilibrium: after the last one of this load or, first of all, of a higher one.
    /// Where secants fail the full engine takes over.
    #[inline(always)]
    fn step(
        &mut self,
        mechanism: &Mechanism,
        position: &Position,
        engine: Engine,
        torque: f64,
        higher: Option<Motion>,
    ) -> Option<Equilibrium> {
        if engine == Engine::Quadratic {
            let start = self.before.as_ref();
            let start = start.map(|(motion, expected)| (motion, expected));
            let (mut found, expected) = quadratic::solve(mechanism, position, torque, start);
            if found.converged {
                self.before = Some((found.motion, expected));
                found.stiffness = f64::NAN;
                return Some(found);
            }
        }
        self.by_full = true;
        let loaded = Loaded::full(mechanism, position);
        let start = self.before.map(|(motion, _)| motion).or(higher);
        let start = start.unwrap_or_else(|| loaded.first_motion(torque));
        let mut found = loaded.solve(torque, &start);
        if !found.converged {
            found = loaded.solve(torque, &loaded.first_motion(torque));
        }
        if !found.converged {
            self.failed = true;
            self.before = None;
            return None;
        }
        let expected = Expected::first(mechanism, torque);
        self.before = Some((found.motion, expected));
        Some(found)
    }

    /// Adds a position's twist, and its stiffness by the true laws, whichever laws it is of.
    #[inline(always)]
    fn add(&mut self, full: &Loaded<'_, PowerLaws>, found: &Equilibrium, with_stiffness: bool) {
        self.twist += found.motion.flange;
        if with_stiffness {
            self.stiffness += if found.stiffness.is_nan() {
                full.stiffness_at(&found.motion)
            } else {
                found.stiffness
            };
        }
    }
}

impl Wide for Turn<'_> {
    type Output = Row;

    #[inline(always)]
    fn run(self) -> Row {
        let mechanism = self.parts.mechanism(self.fixed);
        self.scratch.circles.set(&mechanism);
        let mut row = [f64::NAN; PART_OUTPUTS];
        let mut put = |output: PartOutput, value: f64| row[output as usize] = value;
        let (parts, wanted) = (self.parts, self.wanted);
        if wanted.gaps {
            put(
                PartOutput::Backlash,
                mean_backlash(&mechanism, self.scratch),
            );
        }
        if wanted.rated {
            loaded_turn(
                parts,
                wanted,
                &mechanism,
                self.engine,
                self.scratch,
                &mut put,
            );
        }
        if wanted.fine {
            fine_turn(parts, &mechanism, self.engine, self.scratch, &mut put);
        }
        put_shape(parts, wanted, &mut put);
        row
    }
}

/// Angles (rad) of the crank over one period of the output pins, `2 pi / N_OP` of the hole pattern
/// against the eccentricity.
pub fn positions(mechanism: &Mechanism, count: usize) -> impl Iterator<Item = f64> + use<> {
    let lobes = mechanism.lobes as f64;
    let period = TAU / mechanism.output_pins as f64 * lobes / (lobes + 1.0);
    (0..count).map(move |k| period * k as f64 / count as f64)
}

/// Columns of equilibria at the few positions: means, extremes and forces.
#[inline(always)]
fn loaded_turn(
    parts: &Parts,
    wanted: Wanted,
    mechanism: &Mechanism,
    engine: Engine,
    scratch: &mut Scratch,
    put: &mut impl FnMut(PartOutput, f64),
) {
    let Scratch {
        circles,
        position,
        forces,
        ..
    } = scratch;
    let (radius, shaft) = (mechanism.pin_circle_radius, parts.shaft_compliance);
    forces.clear();
    let mut rated = Trace::new(1.0);
    let mut lower = [
        (wanted.half, Trace::new(0.5)),
        (wanted.low, Trace::new(LOST_MOTION_LOAD)),
        (wanted.reverse, Trace::new(-LOST_MOTION_LOAD)),
    ];
    for crank in positions(mechanism, POSITIONS) {
        position.set(mechanism, circles, crank);
        let full = Loaded::full(mechanism, position);
        let at_rated = rated.step(mechanism, position, engine, parts.torque, None);
        if let Some(found) = &at_rated {
            rated.add(&full, found, wanted.stiffness);
            if wanted.forces {
                forces.add(parts, mechanism, &full, &found.motion);
            }
        }
        for (_, trace) in lower.iter_mut().filter(|(wanted, _)| *wanted) {
            let torque = trace.share * parts.torque;
            let above = at_rated.map(|found| found.motion);
            let higher = if trace.share > 0.0 { above } else { None };
            if let Some(found) = trace.step(mechanism, position, engine, torque, higher) {
                trace.add(&full, &found, trace.share > 0.0);
            }
        }
    }
    let mean = 1.0 / POSITIONS as f64;
    let found = |trace: &Trace, value: f64| if trace.failed { f64::NAN } else { value };
    let twist = |trace: &Trace| {
        let shaft = trace.share * parts.torque * shaft;
        found(trace, (trace.twist * mean / radius + shaft) / ARCMIN)
    };
    let tangent = |trace: &Trace| {
        let stiffness = trace.stiffness * mean * radius * radius;
        found(trace, ARCMIN / (1.0 / stiffness + shaft))
    };
    let [(_, half), (_, low), (_, reverse)] = &lower;
    put(PartOutput::LoadedTwist, twist(&rated));
    if wanted.stiffness {
        put(PartOutput::TangentStiffness100, tangent(&rated));
    }
    if wanted.half {
        put(PartOutput::TangentStiffness50, tangent(half));
    }
    if wanted.low {
        put(PartOutput::TangentStiffness3, tangent(low));
    }
    if wanted.reverse {
        put(PartOutput::LostMotion3, twist(low) - twist(reverse));
    }
    if wanted.forces && !rated.failed {
        forces.put(parts, put);
    }
    let solver = if rated.failed {
        2
    } else {
        u8::from(rated.by_full)
    };
    put(PartOutput::Solver, f64::from(solver));
}

/// Columns of equilibria at the many positions: how twist and input torque pulsate.
#[inline(always)]
fn fine_turn(
    parts: &Parts,
    mechanism: &Mechanism,
    engine: Engine,
    scratch: &mut Scratch,
    put: &mut impl FnMut(PartOutput, f64),
) {
    let Scratch {
        circles,
        position,
        memory,
        ..
    } = scratch;
    let mut trace = Trace::new(1.0);
    let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for crank in positions(mechanism, FINE_POSITIONS) {
        position.set(mechanism, circles, crank);
        let Some(found) = trace.step(mechanism, position, engine, parts.torque, None) else {
            return;
        };
        let loaded = Loaded::full(mechanism, position);
        let input = loaded.input_torque(parts.torque, &found.motion, memory);
        let ripple = input * mechanism.lobes as f64 / parts.torque;
        let twist = found.motion.flange / mechanism.pin_circle_radius / ARCMIN;
        for (k, value) in [twist, ripple].into_iter().enumerate() {
            least[k] = least[k].min(value);
            most[k] = most[k].max(value);
        }
    }
    put(PartOutput::TransmissionError, most[0] - least[0]);
    put(PartOutput::InputTorqueRipple, most[1] - least[1]);
}

/// Columns of the drive's shape alone.
fn put_shape(parts: &Parts, wanted: Wanted, put: &mut impl FnMut(PartOutput, f64)) {
    let width = parts.value(PartInput::DiscWidth);
    let profile = &parts.profile;
    put(PartOutput::CurvatureRadiusMin, 1e3 * profile.radius_min());
    let reach = PartInput::ALL[PartInput::Reach1 as usize + parts.counts[1] - 1];
    let length = parts.value(reach) + 0.5 * width;
    let outer = profile.ring_radius + profile.pin_radius;
    put(PartOutput::DriveVolume, 1e9 * PI * outer * outer * length);
    if wanted.mass {
        let (mass, inertia) = disc_mass(parts);
        put(PartOutput::DiscMass, mass);
        put(PartOutput::DiscInertia, inertia);
    }
}

/// Mean over the few positions of the flange's free turn (arc minutes).
fn mean_backlash(mechanism: &Mechanism, scratch: &mut Scratch) -> f64 {
    let turns = positions(mechanism, POSITIONS).map(|crank| {
        scratch.position.set(mechanism, &scratch.circles, crank);
        backlash(mechanism, &scratch.position)
    });
    let sum: f64 = turns.sum();
    sum / POSITIONS as f64 / mechanism.pin_circle_radius / ARCMIN
}

/// Turn of the flange (m at R_OP) between the first contacts of a disc in either sense, the
/// eccentric's bearing in its middle: the least one of the discs.
#[inline(always)]
fn backlash(mechanism: &Mechanism, position: &Position) -> f64 {
    let lever = mechanism.ring_lever() / mechanism.pin_circle_radius;
    let mut ends = [f64::INFINITY; 2];
    for disc in 0..mechanism.discs {
        let mut turn = [f64::INFINITY; 2];
        for (normal, gap) in position.rings[disc].contacts() {
            let sense = usize::from(normal[1] > 0.0);
            turn[sense] = turn[sense].min(gap.max(0.0) / (normal[1].abs() * lever));
        }
        let mut ahead = [f64::INFINITY; 2];
        let e = mechanism.eccentricity;
        for (tangent, gap) in position.pins[disc].contacts() {
            // |(e, 0) + s t| = e + c in both senses of s.
            let gap = gap.max(0.0);
            let along = e * tangent[0];
            let root = (along * along + gap * (2.0 * e + gap)).sqrt();
            ahead[0] = ahead[0].min(root + along);
            ahead[1] = ahead[1].min(root - along);
        }
        for sense in 0..2 {
            ends[sense] = ends[sense].min(turn[sense] + ahead[sense]);
        }
    }
    ends[0] + ends[1]
}

/// Mass (kg) and moment of inertia (kg m^2) of a disc about its own centre, holes and bore taken
/// out.
fn disc_mass(parts: &Parts) -> (f64, f64) {
    let (area, moment) = parts.profile.area_and_moment();
    let bore = parts.scalar(Input::DiscBoreRadius);
    let hole = parts.hole_radius();
    let circle = parts.scalar(Input::OutputPinCircleRadius);
    let holes = parts.counts[2] as f64;
    let per_area = parts.value(PartInput::DiscDensity) * parts.value(PartInput::DiscWidth);
    let hole_area = PI * hole * hole;
    let area = area - PI * bore * bore - holes * hole_area;
    let moment = moment
        - 0.5 * PI * bore.powi(4)
        - holes * hole_area * (0.5 * hole * hole + circle * circle);
    (per_area * area, per_area * moment)
}

/// Largest pressures (Pa) at ring and output contacts of one equilibrium, and the twist (rad) that
/// comes of ring contacts, output contacts, pin bending, pin root, bearing and clearances.
#[must_use]
pub fn contact_totals(
    parts: &Parts,
    mechanism: &Mechanism,
    loaded: &Loaded<'_, PowerLaws>,
    motion: &Motion,
) -> ([f64; 2], [f64; 6]) {
    let mut forces = RatedForces::default();
    forces.add(parts, mechanism, loaded, motion);
    let torque = forces.torque() * mechanism.pin_circle_radius;
    let budget = forces.budget();
    let of = [
        budget.ring,
        budget.output,
        budget.bending,
        budget.root,
        budget.bearing,
        budget.clearance,
    ];
    (forces.pressures(parts), of.map(|work| work / torque))
}
