//! Active pins in closed form against their rule on a theta grid, and against anything at all.

use std::f64::consts::TAU;

use cyclosweep::model::active_pins::{Criterion, PinMap};
use cyclosweep::model::error::DesignError;
use cyclosweep::model::hypotrochoid::hole_centre;
use proptest::prelude::*;

const POINTS: u32 = 7_200;

fn map() -> impl Strategy<Value = PinMap> {
    (
        3..=300_u32,
        1..=4_u32,
        3..=64_u32,
        0.0001..0.24_f64,
        -3.0..3.0_f64,
    )
        .prop_map(|(ratio, discs, pins, delta, clocking)| {
            PinMap::new(f64::from(ratio), discs, pins, delta, clocking).expect("an arrangement")
        })
}

/// Any arrangement whatever its angles, or the reason why it is none.
fn absurd() -> impl Strategy<Value = Result<PinMap, DesignError>> {
    let angle = || prop_oneof![prop::num::f64::ANY, 0.0..0.3_f64];
    (3..=300_u32, 1..=4_u32, 3..=64_u32, angle(), angle()).prop_map(
        |(ratio, discs, pins, delta, clocking)| {
            PinMap::new(f64::from(ratio), discs, pins, delta, clocking)
        },
    )
}

/// Active contacts at one position of the mesh zone, hole by hole.
fn counted(map: &PinMap, criterion: Criterion, theta: f64) -> u32 {
    let radius = 1.0;
    let e = 2.0 * radius * (map.delta() * TAU).sin();
    let holes: Vec<f64> = (0..map.pins())
        .map(|j| map.clocking() + (f64::from(j) + 0.5) / f64::from(map.pins()))
        .collect();
    // The disc with the eccentricity at `phase` from the mesh zone, in turns.
    let inside = |hole: f64, theta: f64, phase: f64| {
        // Turning the eccentricity by a phase is turning the hole back by it.
        let c = hole_centre(e, radius, map.ratio(), (hole - phase) * TAU, theta * TAU);
        c.norm() < radius
    };
    let discs = (0..map.discs()).map(|d| f64::from(d) / f64::from(map.discs()));
    match criterion {
        Criterion::Inside => discs
            .flat_map(|phase| holes.iter().map(move |hole| (*hole, phase)))
            .filter(|(hole, phase)| inside(*hole, theta, *phase))
            .count() as u32,
        Criterion::Statics => discs
            .flat_map(|phase| holes.iter().map(move |hole| (*hole, phase)))
            .filter(|(hole, phase)| {
                let psi = theta * (1.0 + 1.0 / map.ratio()) + phase - hole;
                (psi * TAU).sin() > 0.0
            })
            .count() as u32,
        Criterion::PublishedMap => {
            // In (-1/2, 1/2]; zero and below is the left half.
            let reduced = holes.iter().map(|hole| 0.5 - (0.5 - hole).rem_euclid(1.0));
            let (left, right): (Vec<f64>, Vec<f64>) = reduced.partition(|phi| *phi <= 0.0);
            let right: Vec<f64> = right.into_iter().map(|phi| -phi).collect();
            let half = |holes: &[f64], theta: f64| {
                let nearest = holes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                holes
                    .iter()
                    .filter(|phi| inside(**phi, theta, 0.0) && (theta < 0.5 || **phi == nearest))
                    .count() as u32
            };
            (half(&left, theta) + half(&right, 1.0 - theta)) * map.discs()
        }
    }
}

fn closed(map: &PinMap, criterion: Criterion) -> (f64, u32, u32) {
    let count = match criterion {
        Criterion::PublishedMap => map.published_map(),
        Criterion::Inside => map.inside(),
        Criterion::Statics => map.statics(),
    };
    (count.mean, count.min, count.max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn closed_form_is_the_rule_on_a_grid(map in map()) {
        for criterion in Criterion::ALL {
            let (mean, min, max) = closed(&map, criterion);
            let (mut sum, mut low, mut high) = (0_u64, u32::MAX, 0);
            for k in 0..POINTS {
                let theta = (f64::from(k) + 0.500_123) / f64::from(POINTS);
                let active = counted(&map, criterion, theta);
                sum += u64::from(active);
                low = low.min(active);
                high = high.max(active);
            }
            let grid = sum as f64 / f64::from(POINTS);
            let windows = f64::from(map.pins() + 2) * f64::from(map.discs());
            let resolution = 1.01 * windows / f64::from(POINTS);
            prop_assert!((mean - grid).abs() <= resolution, "{criterion:?} {mean} {grid}");
            prop_assert!(min <= low && high <= max, "{criterion:?} {min}..{max} {low}..{high}");
            let lasts = |extreme: u32| map
                .sectors(criterion)
                .iter()
                .filter(|sector| sector.active == extreme)
                .map(|sector| sector.end - sector.start)
                .fold(0.0, f64::max);
            let step = 1.01 / f64::from(POINTS);
            prop_assert!(min == low || lasts(min) < step);
            prop_assert!(max == high || lasts(max) < step);
        }
    }
}

proptest! {
    #[test]
    fn sectors_tile_the_turn_and_average_to_the_mean(map in map()) {
        for criterion in Criterion::ALL {
            let sectors = map.sectors(criterion);
            let (mean, min, max) = closed(&map, criterion);
            let mut at = 0.0;
            let mut sum = 0.0;
            for sector in &sectors {
                prop_assert_eq!(sector.start, at);
                prop_assert!(sector.end > sector.start);
                sum += (sector.end - sector.start) * f64::from(sector.active);
                at = sector.end;
            }
            prop_assert!((at - 1.0).abs() < 1e-11);
            prop_assert!((sum - mean).abs() < 1e-8 * f64::from(map.pins()));
            prop_assert_eq!(sectors.iter().map(|s| s.active).min(), Some(min));
            prop_assert_eq!(sectors.iter().map(|s| s.active).max(), Some(max));
        }
    }

    #[test]
    fn efficiency_stays_at_or_below_one_where_windows_are_half_turns(map in map()) {
        for criterion in [Criterion::Inside, Criterion::PublishedMap] {
            let (mean, min, max) = closed(&map, criterion);
            prop_assert!(f64::from(min) <= mean + 1e-9 && mean <= f64::from(max) + 1e-9);
            prop_assert!(map.efficiency(mean) <= 1.0 + 1.0 / map.ratio() + 1e-9);
        }
    }

    #[test]
    fn clocking_by_a_pitch_changes_nothing(map in map(), pitches in -50..50_i32) {
        let moved = PinMap::new(map.ratio(), map.discs(), map.pins(), map.delta(), map.clocking() + f64::from(pitches) / f64::from(map.pins()))
            .expect("an arrangement");
        for criterion in Criterion::ALL {
            let (here, there) = (closed(&map, criterion), closed(&moved, criterion));
            prop_assert!((here.0 - there.0).abs() < 1e-10 * f64::from(map.pins()), "{criterion:?}");
        }
        prop_assert!((map.participation().mean - moved.participation().mean).abs() < 1e-11);
    }

    #[test]
    fn the_published_map_is_the_same_in_a_mirror(map in map()) {
        // Mirrored about ring pin 0, left and right halves change places.
        let mirrored = PinMap::new(map.ratio(), map.discs(), map.pins(), map.delta(), -map.clocking())
            .expect("an arrangement");
        let (here, there) = (map.published_map(), mirrored.published_map());
        prop_assert!((here.mean - there.mean).abs() < 1e-10 * f64::from(map.pins()));
        prop_assert_eq!((here.min, here.max), (there.min, there.max));
    }

    #[test]
    fn participation_is_the_direct_sum(map in map()) {
        let p = map.participation();
        let steps = 4_000;
        let mut sum = 0.0;
        for k in 0..steps {
            let theta = (f64::from(k) + 0.5) / f64::from(steps);
            let mut total = 0.0;
            for d in 0..map.discs() {
                for j in 0..map.pins() {
                    let hole = map.clocking() + (f64::from(j) + 0.5) / f64::from(map.pins());
                    let psi = theta * (1.0 + 1.0 / map.ratio())
                        + f64::from(d) / f64::from(map.discs()) - hole;
                    total += (psi * TAU).sin().max(0.0).powi(2);
                }
            }
            let share = total / f64::from(map.pins());
            prop_assert!(p.min - 1e-9 <= share && share <= p.max + 1e-9);
            sum += share;
        }
        prop_assert!((p.mean - sum / f64::from(steps)).abs() < 2e-6, "{} {}", p.mean, sum);
    }

    #[test]
    fn no_angle_makes_it_panic_or_hang(map in absurd()) {
        let Ok(map) = map else { return Ok(()); };
        for criterion in Criterion::ALL {
            let _ = closed(&map, criterion);
            prop_assert!(map.sectors(criterion).len() <= 3 * 64 * 4 + 3);
        }
        let _ = map.participation();
        let _ = map.first_hole_window();
    }
}
