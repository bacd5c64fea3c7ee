//! The published map, the shares by statics, and sectors against counts.

use super::*;
use approx::{assert_abs_diff_eq, assert_relative_eq};

/// e -> 0, no spin, symmetric clocking.
const IDEAL: PinMap = PinMap {
    ratio: 1e30,
    discs: 2,
    pins: 8,
    delta: 0.0,
    clocking: 0.0,
};

#[test]
fn what_is_no_arrangement_is_refused() {
    assert!(PinMap::new(87.0, 2, 8, 0.002, -0.003).is_ok());
    for (ratio, discs, pins, delta, clocking) in [
        (2.9, 2, 8, 0.002, 0.0),
        (f64::NAN, 2, 8, 0.002, 0.0),
        (87.0, 0, 8, 0.002, 0.0),
        (87.0, 5, 8, 0.002, 0.0),
        (87.0, 2, 2, 0.002, 0.0),
        (87.0, 2, 65, 0.002, 0.0),
        (87.0, 2, 8, -0.002, 0.0),
        (87.0, 2, 8, 0.25, 0.0),
        (87.0, 2, 8, f64::NAN, 0.0),
        (87.0, 2, 8, 0.002, f64::INFINITY),
    ] {
        assert!(PinMap::new(ratio, discs, pins, delta, clocking).is_err());
    }
}

#[test]
fn the_ideal_map_is_the_published_one_exactly() {
    let count = IDEAL.published_map();
    assert_eq!(
        count,
        ActiveCount {
            mean: 6.75,
            min: 4,
            max: 8
        }
    );
    assert_eq!(IDEAL.efficiency(count.mean), 0.84375);
    let at = |turn: f64| {
        let turn = turn.rem_euclid(1.0);
        let inside = |s: &&Sector| s.start <= turn && turn < s.end;
        IDEAL
            .sectors(Criterion::PublishedMap)
            .iter()
            .find(inside)
            .map(|s| s.active)
    };
    let centres: Vec<_> = (0..8).map(|k| at(f64::from(k) / 8.0 + 1e-6)).collect();
    assert_eq!(centres, [4, 6, 8, 8, 6, 8, 8, 6].map(Some));
}

#[test]
fn with_its_own_spin_and_clocking_the_mean_falls_by_a_percent() {
    let delta = (0.0125_f64 / 2.0).asin() / std::f64::consts::TAU;
    let clocking = 66.0 / 360.0 * 88.0 / 87.0 - 0.1875 - delta;
    let map = PinMap {
        ratio: 87.0,
        delta,
        clocking,
        ..IDEAL
    };
    assert_relative_eq!(
        map.first_hole_window().0 * 360.0,
        66.0,
        max_relative = 1e-12
    );
    assert_abs_diff_eq!(map.published_map().mean, 6.676, epsilon = 5e-4);
}

#[test]
fn statics_shares_agree_with_a_direct_sum() {
    for (pins, discs) in [(3, 1), (5, 3), (7, 1), (8, 1), (9, 2), (9, 3), (64, 4)] {
        let map = PinMap {
            ratio: 11.0,
            discs,
            pins,
            delta: 0.01,
            clocking: 0.013,
        };
        let steps = 200_000;
        let (mut sum, mut low, mut high) = (0.0, f64::INFINITY, 0.0_f64);
        for k in 0..steps {
            let x = (f64::from(k) + 0.5) / f64::from(steps) * (1.0 + 1.0 / map.ratio);
            let mut total = 0.0;
            for d in 0..discs {
                for j in 0..pins {
                    let phi = map.clocking + (f64::from(j) + 0.5) / f64::from(pins);
                    let psi = x + f64::from(d) / f64::from(discs) - phi;
                    total += (psi * std::f64::consts::TAU).sin().max(0.0).powi(2);
                }
            }
            let p = total / f64::from(pins);
            sum += p;
            low = low.min(p);
            high = high.max(p);
        }
        let p = map.participation();
        assert_abs_diff_eq!(p.mean, sum / f64::from(steps), epsilon = 1e-7);
        assert_abs_diff_eq!(p.min, low, epsilon = 1e-7);
        assert_abs_diff_eq!(p.max, high, epsilon = 1e-7);
    }
}

#[test]
fn sectors_cover_the_turn_and_average_to_the_mean() {
    for criterion in Criterion::ALL {
        for (pins, discs, ratio) in [(8, 2, 87.0), (9, 2, 3.0), (3, 4, 5.0), (64, 3, 299.0)] {
            let map = PinMap {
                ratio,
                discs,
                pins,
                delta: 0.004,
                clocking: -0.003,
            };
            let sectors = map.sectors(criterion);
            let mut at = 0.0;
            let mut mean = 0.0;
            for s in &sectors {
                assert_abs_diff_eq!(s.start, at, epsilon = 1e-11);
                mean += (s.end - s.start) * f64::from(s.active);
                at = s.end;
            }
            assert_abs_diff_eq!(at, 1.0, epsilon = 1e-11);
            let count = match criterion {
                Criterion::PublishedMap => map.published_map(),
                Criterion::Inside => map.inside(),
                Criterion::Statics => map.statics(),
            };
            assert_abs_diff_eq!(mean, count.mean, epsilon = 1e-9);
            assert_eq!(sectors.iter().map(|s| s.active).min(), Some(count.min));
            assert_eq!(sectors.iter().map(|s| s.active).max(), Some(count.max));
        }
    }
}
