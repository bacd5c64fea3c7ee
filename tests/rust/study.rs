//! Studies: anything may be put in, nothing panics, and a variant does not depend on its company.

use cyclosweep::columns::{Limit, Limited, Study};
use cyclosweep::error::Status;
use cyclosweep::inputs::{Input, SCALARS};
use cyclosweep::outputs::Output;
use cyclosweep::sampling::{Permutation, SobolAxis, key, random, unit_interval};
use cyclosweep::space::{Axis, Layout, Rows, Space, Values};
use proptest::prelude::*;

use drive::{KINDS, LOADS, base, core_units};

mod drive;

fn study(axes: Vec<Axis>, layout: Layout, count: u64, seed: u64, limits: Vec<Limit>) -> Study {
    let space = Space::new(axes, layout, count, seed).expect("a space that can be");
    Study::new(
        space,
        core_units(&base()),
        KINDS.to_vec(),
        LOADS.to_vec(),
        limits,
    )
    .expect("a study that can be")
}

fn bits(columns: &[Vec<f64>], row: usize) -> Vec<u64> {
    columns.iter().map(|column| column[row].to_bits()).collect()
}

/// Axes that make feasible and infeasible variants.
fn axes() -> Vec<Axis> {
    let list = |input: Input, values: &[f64]| Axis {
        input: input as usize,
        values: Values::List(values.to_vec()),
    };
    let steps = |input: Input, from: f64, to: f64, steps: u64| Axis {
        input: input as usize,
        values: Values::Linspace { from, to, steps },
    };
    vec![
        steps(Input::Eccentricity, 0.3, 0.95, 7),
        list(Input::OutputPinCount, &[3.0, 6.0, 7.5, 9.0]),
        list(Input::Criterion, &[0.0, 1.0, 2.0]),
        steps(Input::OutputPinDiameter, 10.0, 30.0, 5),
        steps(Input::YoungsModulus, -1.0, 210.0, 3),
        steps(Input::InputSpeed, 500.0, 1500.0, 2),
        Axis {
            input: SCALARS,
            values: Values::List(vec![45.0, 50.0, 56.0]),
        },
    ]
}

#[test]
fn the_base_is_a_drive_that_can_be_built() {
    let whole = study(Vec::new(), Layout::Grid, 0, 0, Vec::new());
    assert!(whole.explain(0).is_none());
    let columns = whole.evaluate(Rows::From(0), 1, &Output::all(&LOADS));
    assert_eq!(columns.status, [0]);
    assert!(!columns.any_refused);
}

#[test]
fn a_grid_with_tables_gives_the_bits_of_variants_one_by_one() {
    let outputs = Output::all(&LOADS);
    let grid = study(axes(), Layout::Grid, 0, 0, Vec::new());
    let len = grid.space().len() as usize;
    let whole = grid.evaluate(Rows::From(0), len, &outputs);
    // The same values as the rows of a table, for which no stage is computed beforehand.
    let listed: Vec<Axis> = (0..axes().len())
        .map(|k| Axis {
            input: axes()[k].input,
            values: Values::List(grid.axis_values(k, Rows::From(0), len)),
        })
        .collect();
    let table = study(listed, Layout::Table, 0, 0, Vec::new());
    let rows = table.evaluate(Rows::From(0), len, &outputs);
    assert_eq!(whole.status, rows.status);
    for (row, status) in whole.status.iter().enumerate() {
        if *status == Status::Ok as u8 {
            assert_eq!(
                bits(&whole.values, row),
                bits(&rows.values, row),
                "variant {row}"
            );
        } else {
            assert!(whole.values.iter().all(|column| column[row].is_nan()));
        }
        let explained = table
            .explain(row as u64)
            .map_or(Status::Ok, |error| error.status());
        assert_eq!(explained as u8, *status, "variant {row}");
    }
    assert!(
        whole
            .status
            .iter()
            .collect::<std::collections::HashSet<_>>()
            .len()
            > 4
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn any_cut_gives_the_same_bits(
        cuts in prop::collection::vec(0..7560_u64, 0..9),
        layout in prop_oneof![
            Just(Layout::Grid), Just(Layout::Sobol), Just(Layout::LatinHypercube), Just(Layout::Random)
        ],
        seed in any::<u64>(),
    ) {
        let outputs = Output::all(&LOADS);
        let limit = Limit { column: Limited::Output(Output::HoleWeb), min: 2.0, max: f64::INFINITY };
        let whole = study(axes(), layout, 7560, seed, vec![limit]);
        let len = whole.space().len();
        let all = whole.evaluate(Rows::From(0), len as usize, &outputs);
        let mut edges = cuts;
        edges.extend([0, len]);
        edges.sort_unstable();
        for pair in edges.windows(2) {
            let (from, to) = (pair[0] as usize, pair[1] as usize);
            let fresh = study(axes(), layout, 7560, seed, vec![limit]);
            let some = fresh.evaluate(Rows::From(pair[0]), to - from, &outputs);
            prop_assert_eq!(&some.status[..], &all.status[from..to]);
            for (part, column) in some.values.iter().zip(&all.values) {
                let same = part.iter().zip(&column[from..to]).all(|(a, b)| a.to_bits() == b.to_bits());
                prop_assert!(same);
            }
        }
    }

    #[test]
    fn picked_variants_have_the_bits_of_the_whole(
        picked in prop::collection::vec(0..7560_u64, 1..600),
        layout in prop_oneof![
            Just(Layout::Grid), Just(Layout::Sobol), Just(Layout::LatinHypercube), Just(Layout::Random)
        ],
        few in prop::sample::subsequence(Output::all(&LOADS), 1..5),
    ) {
        let whole = study(axes(), layout, 7560, 3, Vec::new());
        let all = whole.evaluate(Rows::From(0), 7560, &few);
        let some = whole.evaluate(Rows::At(&picked), picked.len(), &few);
        for (row, variant) in picked.iter().enumerate() {
            prop_assert_eq!(some.status[row], all.status[*variant as usize]);
            prop_assert_eq!(bits(&some.values, row), bits(&all.values, *variant as usize));
        }
    }

    #[test]
    fn a_column_does_not_depend_on_what_else_is_asked(
        chosen in prop::sample::subsequence(Output::all(&LOADS), 1..6)
    ) {
        let all_outputs = Output::all(&LOADS);
        let grid = study(axes(), Layout::Random, 2000, 1, Vec::new());
        let all = grid.evaluate(Rows::From(0), 2000, &all_outputs);
        let some = grid.evaluate(Rows::From(0), 2000, &chosen);
        prop_assert_eq!(&some.status, &all.status);
        for (output, column) in chosen.iter().zip(&some.values) {
            let place = all_outputs.iter().position(|o| o == output).expect("known");
            for (a, b) in column.iter().zip(&all.values[place]) {
                prop_assert_eq!(a.to_bits(), b.to_bits(), "{:?}", output);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn nothing_that_can_be_put_in_panics(
        changes in prop::collection::vec((0..SCALARS + 12, prop::num::f64::ANY), 1..8)
    ) {
        let mut inputs = base();
        for (input, value) in &changes {
            inputs[*input] = *value;
        }
        let space = Space::new(Vec::new(), Layout::Grid, 0, 0).expect("one variant");
        let one = Study::new(space, core_units(&inputs), KINDS.to_vec(), LOADS.to_vec(), Vec::new()).expect("a study that can be");
        let columns = one.evaluate(Rows::From(0), 1, &Output::all(&LOADS));
        let refused = one.explain(0);
        prop_assert_eq!(columns.status[0], refused.map_or(Status::Ok, |error| error.status()) as u8);
        if let Some(error) = refused {
            prop_assert!(!error.to_string().contains('\n'));
            prop_assert!(columns.values.iter().all(|column| column[0].is_nan()));
        }
    }
}

proptest! {
    #[test]
    fn a_run_of_sobol_points_is_the_points(
        axis in 0..128_usize, scramble in any::<Option<u64>>(), start in 0..(1_u64 << 63) - 400,
        len in 0..400_usize,
    ) {
        let axis = SobolAxis::new(axis, scramble);
        let mut run = vec![0.0; len];
        axis.fill_units(start, &mut run);
        for (unit, index) in run.iter().zip(start..) {
            prop_assert_eq!(*unit, unit_interval(axis.bits(index)));
        }
    }

    #[test]
    fn a_permutation_is_a_bijection(count in 1..3000_u64, key in any::<u64>()) {
        let permutation = Permutation::new(count, key);
        let mut hit = vec![false; count as usize];
        for index in 0..count {
            let image = permutation.at(index) as usize;
            prop_assert!(!hit[image]);
            hit[image] = true;
        }
    }

    #[test]
    fn points_lie_in_the_unit_interval(count in 1..=1_u64 << 63, key_of in any::<u64>(), at in any::<u64>()) {
        let index = at % count;
        for u in [
            Permutation::new(count, key_of).stratified(index),
            random(key(key_of, 3), index),
            unit_interval(at),
        ] {
            prop_assert!((0.0..1.0).contains(&u));
        }
    }

    #[test]
    fn whole_numbers_stay_in_their_range(low in 0..50_u32, width in 0..500_u32, u in 0.0..1.0_f64) {
        let (low, high) = (f64::from(low), f64::from(low + width));
        let value = Values::Whole { low, high }.at(u);
        prop_assert!(value >= low && value <= high && value.fract() == 0.0);
        prop_assert_eq!(Values::Whole { low, high }.at(0.0), low);
        prop_assert_eq!(Values::Whole { low, high }.at(1.0 - f64::EPSILON / 2.0), high);
    }
}
