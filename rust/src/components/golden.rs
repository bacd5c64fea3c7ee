//! Solved cases of the 87:1 drive of the design notes, each confirmed there by a separately written
//! residual solved by SciPy.

use approx::assert_relative_eq;

use crate::components::contact::PowerLaws;
use crate::components::equilibrium::{Equilibrium, Loaded};
use crate::components::laws::{STEEL, palmgren, power_stiffness};
use crate::components::mechanism::{Circles, Mechanism, Position};
use crate::components::pin_root::{PinFlexibility, RootCompliance};

const ARCMIN: f64 = std::f64::consts::PI / 10_800.0;

/// The drive: 87 lobes, two discs 12 mm wide at reaches of 8 and 24 mm, eight pins of 16 mm.
pub(super) fn drive() -> Mechanism {
    let contact = palmgren(STEEL, STEEL, 0.012);
    let root = RootCompliance {
        c_uu: 1.23,
        c_ut: 0.225,
        c_tt: 5.11,
    };
    let pin = |reach| PinFlexibility::at(reach, 0.016, 0.0, 206e9, 0.3, root).stiffness();
    Mechanism {
        lobes: 87,
        discs: 2,
        output_pins: 8,
        eccentricity: 0.9e-3,
        ring_radius: 0.090,
        pin_circle_radius: 0.045,
        hole_clocking: 0.0,
        ring_gap: 0.0,
        ring_enlargement: 0.0,
        profile_rotation: 0.0,
        ring_gap_errors: Vec::new(),
        hole_gap: 0.0,
        hole_gap_errors: Vec::new(),
        ring_stiffness: power_stiffness(2.0 * contact),
        hole_stiffness: power_stiffness(contact),
        pin_stiffness: [pin(0.008), pin(0.024), 0.0, 0.0],
        bearing_stiffness: 4e8,
        bearing_clearance: 0.0,
    }
}

fn with_clearance() -> Mechanism {
    Mechanism {
        ring_gap: 0.02e-3,
        hole_gap: 0.05e-3,
        ..drive()
    }
}

pub(super) fn at(mechanism: &Mechanism, crank: f64) -> Position {
    let mut circles = Circles::default();
    circles.set(mechanism);
    let mut position = Position::default();
    position.set(mechanism, &circles, crank);
    position
}

fn solved(mechanism: &Mechanism, position: &Position, torque: f64) -> Equilibrium {
    let loaded = Loaded::full(mechanism, position);
    let found = loaded.solve(torque, &loaded.first_motion(torque));
    assert!(found.converged, "{found:?}");
    found
}

/// Unknowns in mm, output forces of each disc, number and largest of the ring forces.
struct Golden {
    unknowns: [f64; 7],
    pins: [&'static [f64]; 2],
    ring: [usize; 2],
    ring_max: f64,
    /// Rounding of the ring's torque against the pins', relative.
    rounding: f64,
}

fn compare(mechanism: &Mechanism, golden: &Golden) {
    let position = at(mechanism, 0.3);
    let found = solved(mechanism, &position, 585.0);
    let motion = found.motion;
    let unknowns = [
        motion.flange,
        motion.discs[0][0],
        motion.discs[0][1],
        motion.discs[0][2],
        motion.discs[1][0],
        motion.discs[1][1],
        motion.discs[1][2],
    ];
    for (unknown, expected) in unknowns.iter().zip(golden.unknowns) {
        if !expected.is_nan() {
            assert!((unknown * 1e3 - expected).abs() < 1e-9, "{unknowns:?}");
        }
    }
    let loaded = Loaded::full(mechanism, &position);
    let mut ring_max = 0.0_f64;
    for disc in 0..2 {
        let mut pins = Vec::new();
        loaded.pin_forces(disc, &motion, &mut pins);
        pins.retain(|force| *force > 0.0);
        assert_eq!(pins.len(), golden.pins[disc].len(), "{pins:?}");
        for expected in golden.pins[disc] {
            assert!(
                pins.iter()
                    .any(|force| (force / expected - 1.0).abs() < 1e-6),
                "{pins:?} {expected}"
            );
        }
        let mut ring = Vec::new();
        loaded.ring_forces(disc, &motion, &mut ring);
        ring.retain(|force| *force > 0.0);
        assert_eq!(ring.len(), golden.ring[disc]);
        ring_max = ring.iter().fold(ring_max, |a, b| a.max(*b));
        // Whatever the sharing, the ring's tangential force is the disc's torque over e N.
        let shift = loaded.pitch_shift(motion.discs[disc]);
        let ring = position.rings[disc].force(&PowerLaws::of(mechanism), disc, shift);
        let [turn, x, y] = motion.discs[disc];
        let pins = position.pins[disc].force(
            &PowerLaws::of(mechanism),
            disc,
            mechanism.eccentricity,
            [turn - motion.flange, x, y],
        );
        let torque = -pins.gradient[0] * mechanism.pin_circle_radius;
        assert_relative_eq!(
            ring.gradient[1] * mechanism.ring_lever(),
            torque,
            max_relative = golden.rounding
        );
    }
    assert_relative_eq!(ring_max, golden.ring_max, max_relative = 1e-6);
}

#[test]
fn without_clearance() {
    compare(
        &drive(),
        &Golden {
            unknowns: [
                0.029_089_436_8,
                0.008_281_711_4,
                -0.001_690_602_1,
                -0.013_377_702_2,
                0.002_980_933_8,
                -0.000_665_263_9,
                -0.004_786_223_3,
            ],
            pins: [
                &[2073.908, 4697.802, 4259.173, 1064.912],
                &[472.964, 769.090, 1597.381, 1474.799],
            ],
            ring: [68, 68],
            ring_max: 336.9843,
            rounding: 1e-10,
        },
    );
}

#[test]
fn with_clearance_at_ring_and_holes() {
    compare(
        &with_clearance(),
        &Golden {
            unknowns: [
                0.107_942_127_3,
                0.017_805_370_4,
                -0.014_058_906_9,
                -0.013_209_099_4,
                0.014_466_145_0,
                -0.007_534_865_8,
                -0.005_152_891_0,
            ],
            pins: [&[5902.888, 4118.582], &[2125.252, 1711.182]],
            ring: [23, 15],
            ring_max: 467.6715,
            rounding: 1e-10,
        },
    );
}

#[test]
fn with_a_rigid_bearing() {
    let rigid = Mechanism {
        bearing_stiffness: 1e15,
        ..with_clearance()
    };
    compare(
        &rigid,
        &Golden {
            unknowns: [
                0.090_390_180_0,
                0.013_452_240_2,
                f64::NAN,
                f64::NAN,
                0.012_325_930_7,
                f64::NAN,
                f64::NAN,
            ],
            pins: [&[6152.067, 4821.384], &[1626.796, 1298.257]],
            ring: [15, 10],
            ring_max: 615.3406,
            // The bearing's spring of 1e15 N/m rounds its own force to 1e-6 N.
            rounding: 1e-7,
        },
    );
}

#[test]
fn twists_and_tangents_at_three_loads() {
    let mechanism = drive();
    let position = at(&mechanism, 0.3);
    for (torque, twist, tangent) in [
        (585.0, 2.222_27, 280.07),
        (292.5, 1.154_40, 267.07),
        (17.55, 0.079_03, 232.95),
    ] {
        let found = solved(&mechanism, &position, torque);
        let radius = mechanism.pin_circle_radius;
        let arcmin = found.motion.flange / radius / ARCMIN;
        assert!((arcmin - twist).abs() < 6e-6, "{arcmin}");
        let stiffness = found.stiffness * radius * radius * ARCMIN;
        assert_relative_eq!(stiffness, tangent, max_relative = 1e-4);
        let (less, more) = (torque * (1.0 - 1e-5), torque * (1.0 + 1e-5));
        let ends = [less, more].map(|torque| solved(&mechanism, &position, torque).motion.flange);
        let secant = (more - less) / (ends[1] - ends[0]) * radius * ARCMIN;
        assert_relative_eq!(stiffness, secant, max_relative = 1e-6);
        let back = solved(&mechanism, &at(&mechanism, -0.3), -torque);
        assert_relative_eq!(
            back.motion.flange,
            -found.motion.flange,
            max_relative = 1e-10
        );
    }
    let clear = with_clearance();
    let found = solved(&clear, &at(&clear, 0.3), 585.0);
    let arcmin = found.motion.flange / 0.045 / ARCMIN;
    assert!((arcmin - 8.246_17).abs() < 6e-6, "{arcmin}");
}
