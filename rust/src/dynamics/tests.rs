//! Trains with answers in closed form or in print.

use approx::assert_relative_eq;

use crate::dynamics::branch::static_twist;
use crate::dynamics::modes::Modes;
use crate::dynamics::train::{SlipElement, Spring, Train};
use crate::dynamics::transient::{Loads, Record, Start, transient};

fn chain(inertias: &[f64], stiffnesses: &[f64], gaps: &[f64]) -> Train {
    let springs = stiffnesses.iter().zip(gaps).enumerate();
    let springs = springs
        .map(|(k, (&stiffness, &gap))| {
            let to = (k + 1 < inertias.len()).then_some(k + 1);
            Spring::with_gap(k, to, stiffness, gap)
        })
        .collect();
    Train::new(inertias.to_vec(), springs, 0.0).expect("a train")
}

fn frequencies(train: &Train) -> Vec<f64> {
    let stiffnesses: Vec<f64> = train
        .springs()
        .iter()
        .map(|s| *s.slopes.last().expect("a slope"))
        .collect();
    Modes::of(train, &stiffnesses).frequencies_hz()
}

/// From rest under the first torques (in balance) to the second ones at time zero.
fn stepped(train: &Train, before: &[f64], after: &[f64], duration: f64) -> Record {
    let mut carried = 0.0;
    let mut twists = Vec::new();
    for (spring, torque) in train.springs().iter().zip(before) {
        carried += torque;
        twists.push(static_twist(spring, carried));
    }
    let mut angles = vec![0.0; train.inertias().len()];
    let start = if train.springs().len() == angles.len() {
        angles.len()
    } else {
        angles.len() - 1
    };
    for node in (0..start).rev() {
        let next = angles.get(node + 1).copied().unwrap_or(0.0);
        angles[node] = next + twists[node].0;
    }
    let speeds = vec![0.0; angles.len()];
    let start = Start {
        angles: &angles,
        speeds: &speeds,
        anchors: twists.into_iter().map(|(_, anchors)| anchors).collect(),
    };
    let torques: Vec<f64> = after.iter().chain(after).copied().collect();
    let loads = Loads {
        times: &[0.0, duration],
        torques: &torques,
    };
    transient(train, &start, loads, &[]).expect("a transient")
}

#[test]
fn frequencies_of_the_textbooks() {
    let thomson = frequencies(&chain(&[5.0, 11.0, 22.0], &[1e5, 2e5], &[0.0, 0.0]));
    assert_eq!(thomson[0], 0.0);
    assert_relative_eq!(
        thomson[1] * std::f64::consts::TAU,
        123.66580,
        max_relative = 1e-7
    );
    assert_relative_eq!(
        thomson[2] * std::f64::consts::TAU,
        202.65835,
        max_relative = 1e-7
    );
    let two = frequencies(&chain(&[0.0035, 0.0026], &[21.0], &[0.0]));
    assert_relative_eq!(
        two[1] * std::f64::consts::TAU,
        118.64621,
        max_relative = 1e-7
    );
}

#[test]
fn a_reversal_through_play_follows_the_closed_form() {
    let gap = 28.0_f64.to_radians();
    let (stiffness, torque) = (21.0, 7.2575);
    let expected = 1.0 + 2.0 * f64::sqrt(1.0 + stiffness * gap / torque);
    let locked = chain(&[0.0035], &[stiffness], &[gap]);
    let run = stepped(&locked, &[torque], &[-torque], 0.6);
    assert_relative_eq!(
        run.peaks[0].torque.abs() / torque,
        expected,
        max_relative = 1e-10
    );
    let free = chain(&[0.0035, 0.0026], &[stiffness], &[gap]);
    let run = stepped(&free, &[torque, -torque], &[-torque, torque], 0.6);
    assert_relative_eq!(
        run.peaks[0].torque.abs() / torque,
        expected,
        max_relative = 1e-10
    );
}

#[test]
fn five_inertias_with_play() {
    let gap = 28.0_f64.to_radians();
    let load = 5.0 / (87.0 * 87.0);
    let train = chain(
        &[0.0035, 4e-4, 2.1e-6, 1.6e-6, load],
        &[2e4, 84.0, 28.0, 132.0],
        &[0.0, gap, 0.0, 0.0],
    );
    let found = frequencies(&train);
    for (got, expected) in found[1..]
        .iter()
        .zip([28.471089, 1102.075993, 1199.088620, 1628.626210])
    {
        assert_relative_eq!(*got, expected, max_relative = 1e-7);
    }
    let nominal = 7.2575;
    let ends = [nominal, 0.0, 0.0, 0.0, -nominal];
    let back = ends.map(|t| -t);
    let run = stepped(&train, &ends, &back, 0.1);
    assert_eq!(run.events.len(), 9);
    // Sampled every 20 microseconds the same motion shows 30.4575 at the most.
    assert_relative_eq!(run.peaks[1].torque, -30.458_117_9, max_relative = 1e-8);
    let end = [
        0.7472377735,
        0.7471891356,
        0.8369558652,
        0.8339017317,
        0.8369273420,
    ];
    for (got, expected) in run.end.0.iter().zip(end) {
        assert_relative_eq!(*got, expected, epsilon = 1e-10);
    }
}

#[test]
fn energy_stays_over_a_thousand_impacts() {
    let train = chain(&[0.0035, 4e-4, 0.0026], &[900.0, 21.0], &[0.0, 0.2]);
    let start = Start {
        angles: &[0.0, 0.0, 0.0],
        speeds: &[3.0, 3.0, -4.0],
        anchors: vec![Vec::new(), Vec::new()],
    };
    let loads = Loads {
        times: &[0.0, 200.0],
        torques: &[0.0; 6],
    };
    let run = transient(&train, &start, loads, &[0.0, 200.0]).expect("a transient");
    assert!(run.events.len() > 1000, "{}", run.events.len());
    let energy = |k: usize| run.kinetic[k] + run.potential[k];
    assert_relative_eq!(energy(0), energy(1), max_relative = 1e-10);
}

#[test]
fn friction_takes_what_the_motion_loses() {
    let mut spring = Spring::with_gap(0, None, 21.0, 0.05);
    for stiffness in [40.0, 90.0] {
        spring.elements.push(SlipElement {
            stiffness,
            limit: 0.4,
            load_factor: 0.1,
        });
    }
    let train = Train::new(vec![0.0035], vec![spring], 0.0).expect("a train");
    let start = Start {
        angles: &[0.0],
        speeds: &[60.0],
        anchors: vec![vec![0.0, 0.0]],
    };
    let loads = Loads {
        times: &[0.0, 5.0],
        torques: &[0.0; 2],
    };
    let samples: Vec<f64> = (0..=500).map(|k| f64::from(k) * 0.01).collect();
    let run = transient(&train, &start, loads, &samples).expect("a transient");
    assert!(run.events.len() > 20);
    let first = run.kinetic[0] + run.potential[0];
    for k in 0..samples.len() {
        let total = run.kinetic[k] + run.potential[k] + run.lost[k];
        assert_relative_eq!(total, first, max_relative = 1e-12);
    }
    assert!(run.lost[500] > 0.9 * first);
}
