//! Studies: anything may be put in, nothing panics, and a variant does not depend on its company.

use cyclosweep::Output;
use cyclosweep::model::error::Status;
use cyclosweep::model::inputs::{Input, SCALARS};
use cyclosweep::sampling::{Axis, Layout, Rows, Space, Values};
use cyclosweep::{Limit, Limited, Study};
use proptest::prelude::*;

use drive::{LOADS, base};

mod drive;

fn study(axes: Vec<Axis>, layout: Layout, count: u64, seed: u64, limits: Vec<Limit>) -> Study {
    let space = Space::new(axes, layout, count, seed).expect("a space that can be");
    Study::new(space, &base(), LOADS.to_vec(), limits).expect("a study that can be")
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
    let columns = whole
        .evaluate(Rows::From(0), 1, &Output::all(&LOADS))
        .expect("rows of the study");
    assert_eq!(columns.status, [0]);
    assert!(!columns.any_refused);
}

#[test]
fn a_grid_with_tables_gives_the_bits_of_variants_one_by_one() {
    let outputs = Output::all(&LOADS);
    let grid = study(axes(), Layout::Grid, 0, 0, Vec::new());
    let len = grid.space().len() as usize;
    let whole = grid
        .evaluate(Rows::From(0), len, &outputs)
        .expect("rows of the study");
    // The same values as the rows of a table, for which no stage is computed beforehand.
    let listed: Vec<Axis> = (0..axes().len())
        .map(|k| Axis {
            input: axes()[k].input,
            values: Values::List(
                grid.axis_values(k, Rows::From(0), len)
                    .expect("rows of the study"),
            ),
        })
        .collect();
    let table = study(listed, Layout::Table, 0, 0, Vec::new());
    let rows = table
        .evaluate(Rows::From(0), len, &outputs)
        .expect("rows of the study");
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
        let all = whole.evaluate(Rows::From(0), len as usize, &outputs).expect("rows of the study");
        let mut edges = cuts;
        edges.extend([0, len]);
        edges.sort_unstable();
        for pair in edges.windows(2) {
            let (from, to) = (pair[0] as usize, pair[1] as usize);
            let fresh = study(axes(), layout, 7560, seed, vec![limit]);
            let some = fresh.evaluate(Rows::From(pair[0]), to - from, &outputs).expect("rows of the study");
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
        let all = whole.evaluate(Rows::From(0), 7560, &few).expect("rows of the study");
        let some = whole.evaluate(Rows::At(&picked), picked.len(), &few).expect("rows of the study");
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
        let all = grid.evaluate(Rows::From(0), 2000, &all_outputs).expect("rows of the study");
        let some = grid.evaluate(Rows::From(0), 2000, &chosen).expect("rows of the study");
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
        let axes = changes.into_iter().collect::<std::collections::BTreeMap<_, _>>();
        let axis = |(input, value)| Axis { input, values: Values::List(vec![value]) };
        let space = Space::new(axes.into_iter().map(axis).collect(), Layout::Table, 1, 0)
            .expect("one variant");
        let one = Study::new(space, &base(), LOADS.to_vec(), Vec::new()).expect("a study");
        let columns = one.evaluate(Rows::From(0), 1, &Output::all(&LOADS)).expect("rows of the study");
        let refused = one.explain(0);
        prop_assert_eq!(columns.status[0], refused.map_or(Status::Ok, |error| error.status()) as u8);
        if let Some(error) = refused {
            prop_assert!(!error.to_string().contains('\n'));
            prop_assert!(columns.values.iter().all(|column| column[0].is_nan()));
        }
    }
}
