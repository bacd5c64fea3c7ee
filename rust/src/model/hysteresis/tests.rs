//! Loops, ramps and refusals of the operators.

use super::*;
use proptest::prelude::*;

fn single(limit: f64, slip: &[f64]) -> SlipElements<'_> {
    SlipElements {
        slip_angle: slip,
        share: &[1.0],
        limit,
        load_factor: 0.0,
        load_power: 0.0,
        growth: 0.0,
        reference_torque: 1.0,
        forgetting: 0.0,
    }
}

#[test]
fn loop_width_is_twice_friction_times_compliance() {
    let up: Vec<f64> = (0..=100).map(|k| k as f64 * 0.1).collect();
    let torque: Vec<f64> = up.iter().chain(up.iter().rev()).copied().collect();
    let n = torque.len();
    let (mut angle, mut friction) = (vec![0.0; n], vec![0.0; n]);
    let spring = Spring {
        free_play: 0.0,
        compliance: 2.0,
        law_torque: &[],
        law_twist: &[],
    };
    solve_slip(
        &torque,
        &vec![0.0; n],
        &vec![false; n],
        &vec![0.0; n],
        spring,
        &single(0.5, &[0.01]),
        &mut angle,
        &mut friction,
    )
    .expect("numbers");
    let width = angle[151] - angle[50];
    assert!((width - 2.0 * 0.5 * 2.0).abs() < 1e-9, "{width}");
}

#[test]
fn runs_are_solved_as_if_each_were_alone() {
    // Runs of unlike lengths, so that one goes on alone when the other has ended.
    let lengths = [7, 130, 31];
    let n: usize = lengths.iter().sum();
    let torque: Vec<f64> = (0..u32::try_from(n).expect("few"))
        .map(|k| 20.0 * (f64::from(k) * 0.37).sin() + 0.1 * f64::from(k))
        .collect();
    let offset: Vec<f64> = torque.iter().map(|t| 0.01 * (3.0 * t).cos()).collect();
    let mut restart = vec![false; n];
    let starts: Vec<usize> = lengths
        .iter()
        .scan(0, |at, len| Some(std::mem::replace(at, *at + len)))
        .collect();
    for &at in &starts {
        restart[at] = true;
    }
    let start_angle: Vec<f64> = (0..n)
        .map(|k| if k % 2 == 0 { 0.5 } else { -0.5 })
        .collect();
    let spring = Spring {
        free_play: 0.3,
        compliance: 0.05,
        law_torque: &[],
        law_twist: &[],
    };
    let elements = SlipElements {
        forgetting: 0.4,
        ..single(1.5, &[0.05])
    };
    let solve = |rows: std::ops::Range<usize>| {
        let (mut angle, mut friction) = (vec![0.0; rows.len()], vec![0.0; rows.len()]);
        let restart = &restart[rows.clone()];
        solve_slip(
            &torque[rows.clone()],
            &offset[rows.clone()],
            restart,
            &start_angle[rows],
            spring,
            &elements,
            &mut angle,
            &mut friction,
        )
        .expect("numbers");
        (angle, friction)
    };
    let (angle, friction) = solve(0..n);
    for (&at, len) in starts.iter().zip(lengths) {
        let (alone, force) = solve(at..at + len);
        // The largest torque of all runs bounds the search for the angle: the last bits differ.
        for (together, alone) in [
            (&angle[at..at + len], &alone),
            (&friction[at..at + len], &force),
        ] {
            let pairs = together.iter().zip(alone);
            assert!(pairs.into_iter().all(|(x, y)| (x - y).abs() < 1e-10));
        }
    }
}

#[test]
fn creep_reaches_the_load_and_a_ramp_lags_by_the_time_constant() {
    let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.1).collect();
    let mut out = vec![0.0; time.len()];
    let mut restart = vec![false; time.len()];
    restart[0] = true;
    creep_state(&time, &time, &restart, 5.0, &mut out).expect("lengths");
    assert!((time[1999] - out[1999] - 5.0).abs() < 1e-9);
}

#[test]
fn drag_delays_a_ramp_by_its_lag() {
    let ramp: Vec<f64> = (1..=400).map(|k| f64::from(k) * 0.1).collect();
    let mut out = vec![0.0; ramp.len()];
    let mut let_through = |dashpot| {
        dragged(&ramp, &vec![0.1; 400], &vec![false; 400], dashpot, &mut out).expect("lengths");
        ramp[399] - out[399]
    };
    let newtonian = |lag| Dashpot {
        lag,
        power: 1.0,
        thinning_rate: None,
        reference_rate: 4.0,
        by_sample: false,
    };
    assert!((let_through(newtonian(2.0)) - 2.0).abs() < 1e-6);
    assert!(let_through(newtonian(0.0)).abs() < 1e-9);
    // At a rate of 1, a drag of 2 at the rate of 4 that grows with the root of the rate is 1.
    let thinning = Dashpot {
        lag: 0.5,
        power: 0.5,
        thinning_rate: None,
        reference_rate: 4.0,
        by_sample: false,
    };
    assert!((let_through(thinning) - 1.0).abs() < 1e-6);
}

#[test]
fn a_dashpot_by_sample_holds_the_balance_of_torques() {
    let input: Vec<f64> = (0..300).map(|k| (f64::from(k) * 0.1).sin() * 7.0).collect();
    let (lag, rate, lapse) = (0.8, 2.5, 0.2);
    for power in [1.0, 0.6] {
        let dashpot = Dashpot {
            lag,
            power,
            thinning_rate: None,
            reference_rate: rate,
            by_sample: true,
        };
        let mut out = vec![0.0; 300];
        let flags = vec![false; 300];
        dragged(&input, &vec![lapse; 300], &flags, dashpot, &mut out).expect("lengths");
        for i in 1..input.len() {
            let speed = (out[i] - out[i - 1]) / lapse;
            let drag = speed.signum() * lag * rate * (speed.abs() / rate).powf(power);
            assert!((input[i] - out[i] - drag).abs() < 1e-8, "row {i}");
        }
    }
}

#[test]
fn drag_that_thins_above_a_rate_holds_the_balance_of_torques() {
    let input: Vec<f64> = (0..300).map(|k| (f64::from(k) * 0.1).sin() * 7.0).collect();
    let (lag, rate, lapse, power) = (0.8, 2.5, 0.2, 0.3);
    for thinning in [0.05_f64, 1.0, 40.0] {
        let dashpot = Dashpot {
            lag,
            power,
            thinning_rate: Some(thinning),
            reference_rate: rate,
            by_sample: true,
        };
        let law = |speed: f64| speed * (1.0 + (speed / thinning).powi(2)).powf(0.5 * (power - 1.0));
        let mut out = vec![0.0; 300];
        let flags = vec![false; 300];
        dragged(&input, &vec![lapse; 300], &flags, dashpot, &mut out).expect("lengths");
        for i in 1..input.len() {
            let speed = (out[i] - out[i - 1]) / lapse;
            let drag = lag * rate * law(speed) / law(rate);
            assert!((input[i] - out[i] - drag).abs() < 1e-7, "row {i}");
        }
    }
}

#[test]
fn a_rate_of_thinning_has_to_be_positive() {
    let dashpot = Dashpot {
        lag: 1.0,
        power: 0.5,
        thinning_rate: Some(0.0),
        reference_rate: 1.0,
        by_sample: false,
    };
    assert!(dragged(&[1.0], &[1.0], &[true], dashpot, &mut [0.0]).is_err());
}

/// Largest difference of a dashpot from itself on a grid forty times as fine.
fn against_fine_grid(dashpot: Dashpot, lapse: f64) -> f64 {
    let (rows, fine) = (120, 40);
    let corner = |k: f64| (k * 0.7).sin().asin() * 5.0;
    let coarse: Vec<f64> = (1..=rows).map(|k| corner(f64::from(k))).collect();
    let mut before = 0.0;
    let mut between = vec![];
    for &value in &coarse {
        between.extend((1..=fine).map(|k| before + (value - before) * f64::from(k) / 40.0));
        before = value;
    }
    let run = |input: &[f64], lapse: f64| {
        let (mut out, flags) = (vec![0.0; input.len()], vec![false; input.len()]);
        dragged(input, &vec![lapse; input.len()], &flags, dashpot, &mut out).expect("lengths");
        out
    };
    let (few, many) = (run(&coarse, lapse), run(&between, lapse / 40.0));
    let far = |i: usize| (few[i] - many[(i + 1) * 40 - 1]).abs();
    (0..coarse.len()).map(far).fold(0.0, f64::max)
}

#[test]
fn drag_does_not_depend_on_how_often_it_is_sampled() {
    for lag in [0.02, 0.3, 1.0, 4.0, 30.0] {
        let newtonian = Dashpot {
            lag,
            power: 1.0,
            thinning_rate: None,
            reference_rate: 4.0,
            by_sample: false,
        };
        assert!(against_fine_grid(newtonian, 1.0) < 1e-12, "lag {lag}");
        let thinning = Dashpot {
            power: 0.6,
            ..newtonian
        };
        // Of a signal that reaches 7.9, which one step backwards misses by up to 0.6.
        let missed = against_fine_grid(thinning, 1.0);
        assert!(missed < 0.05, "lag {lag}: {missed}");
    }
}

#[test]
fn remembered_datum_saturates() {
    let mut out = vec![0.0; 200];
    remembered_datum(&[1.0; 200], 0.5, &mut out);
    assert!(out[0] == 0.0 && (out[199] - 2.0).abs() < 1e-9);
}

#[test]
fn what_is_not_a_number_is_refused_and_does_not_panic() {
    let (mut out, mut force) = (vec![0.0; 2], vec![0.0; 2]);
    let (zero, fresh) = ([0.0; 2], [false; 2]);
    let bad = [0.0, f64::NAN];
    let elements = single(0.5, &[0.01]);
    let refused = |what| HistoryError::NotANumber { what, place: 1 };
    assert_eq!(
        slip_state(&bad, &fresh, &zero, &[1.0; 2], &elements, &mut out),
        Err(refused("angle"))
    );
    assert_eq!(
        slip_state(&zero, &fresh, &zero, &bad, &elements, &mut out),
        Err(refused("stretch"))
    );
    assert_eq!(
        play(&bad, 1.0, &fresh, &zero, &mut out),
        Err(refused("signal"))
    );
    assert_eq!(
        play(&zero, -1.0, &fresh, &zero, &mut out),
        Err(HistoryError::Negative {
            what: "half_width",
            value: -1.0
        })
    );
    let spring = Spring {
        free_play: 0.0,
        compliance: 2.0,
        law_torque: &[],
        law_twist: &[],
    };
    let mut solve = |torque: &[f64], slip: &[f64]| {
        let elements = single(0.5, slip);
        let (angle, friction) = (&mut out[..], &mut force[..]);
        solve_slip(
            torque, &zero, &fresh, &zero, spring, &elements, angle, friction,
        )
    };
    assert_eq!(solve(&bad, &[0.01]), Err(refused("torque")));
    assert_eq!(
        solve(&zero[..1], &[0.01]),
        Err(HistoryError::Length {
            expected: 1,
            found: 2
        })
    );
    assert!(solve(&zero, &[-0.01]).is_err());
    assert_eq!(
        solve(&[f64::INFINITY, 1.0], &[0.01]),
        Err(HistoryError::Infinite {
            what: "torque",
            place: 0
        })
    );
}

proptest! {
    #[test]
    fn balance_holds_and_friction_stays_within_its_limit(
        torque in prop::collection::vec(-30.0..30.0f64, 2..60),
        limit in 0.0..2.0f64, load in 0.0..0.3f64, growth in prop::sample::select(vec![0.0, 1.0]),
        power in prop::sample::select(vec![0.0, 0.0, -1.0, -0.4, 0.5, 1.0]),
        forgetting in 0.0..1.0f64, curved: bool,
    ) {
        let torques = [-60.0, -20.0, -2.0, 0.0, 2.0, 20.0, 60.0];
        let n = torque.len();
        let slip = [0.05, 0.4, 2.0];
        let elements = SlipElements {
            slip_angle: &slip, share: &[0.5, 0.3, 0.2], limit, load_factor: load,
            load_power: power, growth, reference_torque: 10.0, forgetting,
        };
        let bent = [-90.0, -60.0, -2.0, 0.0, 2.0, 60.0, 90.0];
        let spring = if curved {
            Spring { free_play: 3.0, compliance: 2.5, law_torque: &torques, law_twist: &bent }
        } else {
            Spring { free_play: 3.0, compliance: 2.5, law_torque: &[], law_twist: &[] }
        };
        let (mut angle, mut friction) = (vec![0.0; n], vec![0.0; n]);
        solve_slip(&torque, &vec![0.0; n], &vec![false; n], &vec![0.0; n], spring, &elements,
                   &mut angle, &mut friction).expect("numbers");
        for i in 0..n {
            let elastic = spring.torque(angle[i], &mut 0).0;
            prop_assert!(friction[i].abs() <= elements.load_limit(elastic) + 1e-9);
            prop_assert!((elastic + friction[i] - torque[i]).abs() < 1e-6);
        }
    }
}
