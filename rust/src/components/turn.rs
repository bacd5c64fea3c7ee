//! One drive over a turn of its crank: equilibria at a few positions and loads, and the columns that
//! follow from them.

use std::f64::consts::{PI, TAU};

use pulp::{Arch, Scalar, Simd, WithSimd};

use crate::components::details::without_clearance;
use crate::components::equilibrium::Motion;
use crate::components::forces::{Factors, RatedForces};
use crate::components::inputs::PartInput;
use crate::components::mechanism::Mechanism;
use crate::components::outputs::{PART_OUTPUTS, PartOutput, Wanted};
use crate::components::parts::{Fixed, Parts};
use crate::components::positions::{Found, Group, Memory, State, lanes};
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
    memory: Memory,
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

/// A load over the positions of the crank.
#[derive(Debug, Clone, Copy)]
struct Trace {
    share: f64,
    /// Flange's motion (m at R_OP) and stiffness (N/m) at each position of a period.
    flange: [f64; POSITIONS],
    stiffness: [f64; POSITIONS],
    /// Sums over the periods of their means over a period.
    flange_sum: f64,
    stiffness_sum: f64,
    periods: f64,
    found: Found,
}

impl Trace {
    const fn new(share: f64) -> Self {
        Self {
            share,
            flange: [f64::NAN; POSITIONS],
            stiffness: [f64::NAN; POSITIONS],
            flange_sum: 0.0,
            stiffness_sum: 0.0,
            periods: 0.0,
            found: Found {
                by_full: false,
                failed: false,
            },
        }
    }

    fn add(&mut self, found: Found) {
        self.found.by_full |= found.by_full;
        self.found.failed |= found.failed;
    }

    /// Adds a period all positions of which have been solved.
    fn add_period(&mut self) {
        self.flange_sum += mean(&self.flange);
        self.stiffness_sum += mean(&self.stiffness);
        self.periods += 1.0;
    }

    /// Twist (arc minutes) with a shaft of this compliance behind the flange.
    fn twist(&self, parts: &Parts, radius: f64) -> f64 {
        if self.found.failed {
            return f64::NAN;
        }
        let flange = self.flange_sum / self.periods / radius;
        (flange + self.share * parts.torque * parts.shaft_compliance) / ARCMIN
    }

    /// Tangent stiffness (N m per arc minute), the shaft in series.
    fn tangent(&self, parts: &Parts, radius: f64) -> f64 {
        if self.found.failed {
            return f64::NAN;
        }
        let stiffness = self.stiffness_sum / self.periods * radius * radius;
        ARCMIN / (1.0 / stiffness + parts.shaft_compliance)
    }
}

/// Mean in the order of the positions, however many stood side by side.
fn mean(values: &[f64; POSITIONS]) -> f64 {
    values.iter().sum::<f64>() / POSITIONS as f64
}

impl Turn<'_> {
    /// Every column asked for, with the widest instructions that this machine has.
    #[must_use]
    pub fn solve(self) -> Row {
        Arch::new().dispatch(self)
    }
}

impl WithSimd for Turn<'_> {
    type Output = Row;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Row {
        let mechanism = self.parts.mechanism(self.fixed);
        let mut row = [f64::NAN; PART_OUTPUTS];
        let mut put = |output: PartOutput, value: f64| row[output as usize] = value;
        let (parts, wanted) = (self.parts, self.wanted);
        let memory = &mut self.scratch.memory;
        if wanted.rated || wanted.gaps {
            loaded_turn(
                simd,
                parts,
                wanted,
                &mechanism,
                self.engine,
                memory,
                &mut put,
            );
        }
        if wanted.fine {
            fine_turn(simd, parts, &mechanism, self.engine, memory, &mut put);
        }
        if wanted.without_clearance {
            tight_turn(simd, parts, &mechanism, self.engine, memory, &mut put);
        }
        put_shape(parts, wanted, &mut put);
        row
    }
}

/// Whether the contacts of a kind have gaps of their own.
fn differ(gap_errors: &[f64]) -> bool {
    gap_errors.windows(2).any(|pair| pair[0] != pair[1])
}

/// Periods of the output pins that are looked through: one where all contacts of a kind are alike,
/// else all, until every contact with a gap of its own has passed the load.
fn periods(mechanism: &Mechanism) -> usize {
    if differ(&mechanism.ring_gap_errors) || differ(&mechanism.hole_gap_errors) {
        mechanism.output_pins
    } else {
        1
    }
}

/// Angles (rad) of the crank over a period of the output pins, `2 pi / N_OP` of the hole pattern
/// against the eccentricity, or of the ring against it where ring pins have gaps of their own.
fn positions(
    mechanism: &Mechanism,
    period: usize,
    count: usize,
) -> impl Iterator<Item = f64> + use<> {
    let lobes = mechanism.lobes as f64;
    let holes_by_ring = if differ(&mechanism.ring_gap_errors) {
        1.0
    } else {
        lobes / (lobes + 1.0)
    };
    let pitch = TAU / mechanism.output_pins as f64 * holes_by_ring;
    let places = period * count..(period + 1) * count;
    places.map(move |place| pitch * place as f64 / count as f64)
}

/// The few positions of a period.
fn few_positions(mechanism: &Mechanism, period: usize) -> [f64; POSITIONS] {
    let mut cranks = [0.0; POSITIONS];
    for (crank, position) in cranks
        .iter_mut()
        .zip(positions(mechanism, period, POSITIONS))
    {
        *crank = position;
    }
    cranks
}

/// Columns of equilibria at the few positions: means, extremes and forces.
#[inline(always)]
fn loaded_turn<S: Simd>(
    simd: S,
    parts: &Parts,
    wanted: Wanted,
    mechanism: &Mechanism,
    engine: Engine,
    memory: &mut Memory,
    put: &mut impl FnMut(PartOutput, f64),
) {
    let factors = Factors::of(parts);
    let mut forces = RatedForces::default();
    let mut gaps = [0.0; POSITIONS];
    let mut gap_sum = 0.0;
    let mut traces = [
        (wanted.rated, Trace::new(1.0)),
        (wanted.half, Trace::new(0.5)),
        (wanted.low, Trace::new(LOST_MOTION_LOAD)),
        (wanted.reverse, Trace::new(-LOST_MOTION_LOAD)),
    ];
    let (lanes, periods) = (lanes::<S>(), periods(mechanism));
    for period in 0..periods {
        let cranks = few_positions(mechanism, period);
        for first in (0..POSITIONS).step_by(lanes) {
            let at = first..first + lanes;
            let mut group = Group::new(simd, mechanism, engine, &cranks[at.clone()], memory);
            if wanted.gaps {
                group.backlash(&mut gaps[at.clone()]);
            }
            if wanted.rated {
                group.guess(parts.torque);
            }
            // Lower loads start from the rated one, whichever of them are asked for.
            let mut rated = group.state();
            for (_, trace) in traces.iter_mut().filter(|(wanted, _)| *wanted) {
                if trace.share < 0.0 {
                    group.mirror();
                } else if trace.share < 1.0 {
                    group.go_on_from(&rated);
                }
                trace.add(group.solve(trace.share * parts.torque));
                if trace.share == 1.0 {
                    rated = group.state();
                }
                group.flange(&mut trace.flange[at.clone()]);
                let stiffness = &mut trace.stiffness[at.clone()];
                if trace.share == 1.0 && wanted.forces {
                    group.forces(&factors, stiffness, |found| {
                        for position in 0..lanes {
                            forces.add(parts, cranks[first + position], &found.at(position));
                        }
                    });
                } else if trace.share > 0.0 && (trace.share < 1.0 || wanted.stiffness) {
                    group.stiffness(stiffness);
                }
            }
        }
        gap_sum += mean(&gaps);
        for (_, trace) in &mut traces {
            trace.add_period();
        }
    }
    let radius = mechanism.pin_circle_radius;
    if wanted.gaps {
        let gap = gap_sum / periods as f64;
        put(PartOutput::Backlash, gap / radius / ARCMIN);
    }
    let [(_, rated), (_, half), (_, low), (_, reverse)] = &traces;
    if wanted.rated {
        put(PartOutput::LoadedTwist, rated.twist(parts, radius));
        let solver = if rated.found.failed {
            2
        } else {
            u8::from(rated.found.by_full)
        };
        put(PartOutput::Solver, f64::from(solver));
    }
    if wanted.stiffness {
        put(
            PartOutput::TangentStiffness100,
            rated.tangent(parts, radius),
        );
    }
    if wanted.half {
        put(PartOutput::TangentStiffness50, half.tangent(parts, radius));
    }
    if wanted.low {
        put(PartOutput::TangentStiffness3, low.tangent(parts, radius));
    }
    if wanted.reverse {
        let lost = low.twist(parts, radius) - reverse.twist(parts, radius);
        put(PartOutput::LostMotion3, lost);
    }
    if wanted.forces && !rated.found.failed {
        forces.put(parts, put);
        if wanted.details {
            forces.details().put(parts, put);
        }
    }
}

/// The stiffness that a drive has without its clearances.
#[inline(always)]
fn tight_turn<S: Simd>(
    simd: S,
    parts: &Parts,
    mechanism: &Mechanism,
    engine: Engine,
    memory: &mut Memory,
    put: &mut impl FnMut(PartOutput, f64),
) {
    let tight = without_clearance(mechanism);
    let cranks = few_positions(&tight, 0);
    let lanes = lanes::<S>();
    let mut trace = Trace::new(1.0);
    for first in (0..POSITIONS).step_by(lanes) {
        let at = first..first + lanes;
        let mut group = Group::new(simd, &tight, engine, &cranks[at.clone()], memory);
        group.guess(parts.torque);
        trace.add(group.solve(parts.torque));
        group.stiffness(&mut trace.stiffness[at]);
    }
    trace.add_period();
    let stiffness = trace.tangent(parts, mechanism.pin_circle_radius);
    put(PartOutput::StiffnessWithoutClearance, stiffness);
}

/// Columns of equilibria at the many positions: how twist and input torque pulsate.
#[inline(always)]
fn fine_turn<S: Simd>(
    simd: S,
    parts: &Parts,
    mechanism: &Mechanism,
    engine: Engine,
    memory: &mut Memory,
    put: &mut impl FnMut(PartOutput, f64),
) {
    // Each lane goes on in small steps through its own part of the period.
    const STEPS: usize = FINE_POSITIONS / POSITIONS;
    let lanes = lanes::<S>();
    let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let (mut flange, mut input) = ([0.0; POSITIONS], [0.0; POSITIONS]);
    for period in 0..periods(mechanism) {
        let mut cranks = [[0.0; POSITIONS]; STEPS];
        for (place, crank) in positions(mechanism, period, FINE_POSITIONS).enumerate() {
            cranks[place % STEPS][place / STEPS] = crank;
        }
        for first in (0..POSITIONS).step_by(lanes) {
            let mut before: Option<State<S>> = None;
            for cranks in &cranks {
                let cranks = &cranks[first..first + lanes];
                let mut group = Group::new(simd, mechanism, engine, cranks, memory);
                match &before {
                    Some(state) => group.go_on_from(state),
                    None => group.guess(parts.torque),
                }
                if group.solve(parts.torque).failed {
                    return;
                }
                before = Some(group.state());
                let (flange, input) = (&mut flange[..lanes], &mut input[..lanes]);
                group.flange(flange);
                group.input_torque(parts.torque, input);
                for (flange, input) in flange.iter().zip(input) {
                    let ripple = *input * mechanism.lobes as f64 / parts.torque;
                    let twist = flange / mechanism.pin_circle_radius / ARCMIN;
                    for (k, value) in [twist, ripple].into_iter().enumerate() {
                        least[k] = least[k].min(value);
                        most[k] = most[k].max(value);
                    }
                }
            }
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
    crank: f64,
    motion: &Motion,
) -> ([f64; 2], [f64; 6]) {
    let (factors, mut memory) = (Factors::of(parts), Memory::default());
    let cranks = [crank];
    let mut group = Group::new(Scalar, mechanism, Engine::Full, &cranks, &mut memory);
    group.put(motion);
    let mut forces = RatedForces::default();
    group.forces(&factors, &mut [0.0], |found| {
        forces.add(parts, crank, &found.at(0))
    });
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::inputs::PART_INPUTS;
    use crate::model::inputs::SCALARS;

    /// The 87:1 drive with clearances, and one of few lobes with modified profile and pins.
    fn drives() -> [(Parts, Fixed); 2] {
        let mut scalars = [0.0; SCALARS];
        for (input, value) in [
            (Input::Ratio, 87.0),
            (Input::DiscCount, 2.0),
            (Input::Eccentricity, 0.9e-3),
            (Input::RingPinCircleRadius, 0.090),
            (Input::OutputPinCount, 8.0),
            (Input::OutputPinCircleRadius, 0.045),
            (Input::OutputPinDiameter, 0.016),
            (Input::DiscBoreRadius, 0.02),
            (Input::YoungsModulus, 206e9),
            (Input::PoissonRatio, 0.3),
            (Input::OutputTorque, 585.0),
        ] {
            scalars[input as usize] = value;
        }
        let mut values = [f64::NAN; PART_INPUTS];
        for (input, value) in [
            (PartInput::RingPinRadius, 0.002),
            (PartInput::DiscWidth, 0.012),
            (PartInput::RingClearance, 0.02e-3),
            (PartInput::HoleClearance, 0.05e-3),
            (PartInput::BearingStiffness, 4e8),
        ] {
            values[input as usize] = value;
        }
        let plain = Fixed::default();
        let first = Parts::of(&scalars, &values, &plain, 1e-6).unwrap_or_else(|e| panic!("{e}"));
        scalars[Input::Ratio as usize] = 11.0;
        scalars[Input::Eccentricity as usize] = 4e-3;
        scalars[Input::DiscCount as usize] = 3.0;
        scalars[Input::OutputPinCount as usize] = 6.0;
        scalars[Input::HoleClocking as usize] = 0.01;
        values[PartInput::RingCircleEnlargement as usize] = 0.01e-3;
        values[PartInput::ProfileRotation as usize] = 2e-4;
        values[PartInput::BearingClearance as usize] = 0.01e-3;
        let uneven = Fixed {
            ring_gap_errors: (0..12).map(|k| 1e-6 * f64::from(k % 5)).collect(),
            hole_gap_errors: (0..6).map(|k| 2e-6 * f64::from(k % 4)).collect(),
            ..Fixed::default()
        };
        let second = Parts::of(&scalars, &values, &uneven, 0.0).unwrap_or_else(|e| panic!("{e}"));
        [(first, plain), (second, uneven)]
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn every_width_of_instructions_gives_the_same_bits() {
        let every = Wanted::by(PartOutput::ALL);
        for (parts, fixed) in &drives() {
            for engine in [Engine::Full, Engine::Quadratic] {
                let mut scratch = [Scratch::default(), Scratch::default(), Scratch::default()];
                let [one, four, eight] = scratch.each_mut().map(|scratch| Turn {
                    parts,
                    fixed,
                    engine,
                    wanted: every,
                    scratch,
                });
                let alone = Simd::vectorize(Scalar, one);
                assert!(alone.iter().all(|value| value.is_finite()), "{alone:?}");
                let bits = |row: Row| row.map(f64::to_bits);
                if let Some(v3) = pulp::x86::V3::try_new() {
                    assert_eq!(bits(Simd::vectorize(v3, four)), bits(alone));
                }
                if let Some(v4) = pulp::x86::V4::try_new() {
                    assert_eq!(bits(Simd::vectorize(v4, eight)), bits(alone));
                }
            }
        }
    }
}
