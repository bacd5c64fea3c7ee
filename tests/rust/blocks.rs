//! Blocks of variants in vector instructions give the bits of variants computed one by one.

use cyclosweep::Output;
use cyclosweep::model::active_pins::Criterion;
use cyclosweep::model::design::{Design, ShaftSegment};
use cyclosweep::model::error::Status;
use cyclosweep::model::inputs::{Input, SCALARS, SEGMENT_FIELDS};
use cyclosweep::model::shaft::SegmentKind;
use cyclosweep::sampling::{Axis, Layout, Rows, Space, Values};
use cyclosweep::{Limit, Limited, Study};
use proptest::prelude::*;

use drive::{LOADS, SHAFT, base};

mod drive;

/// Rows of a table, and points of a sampled space.
const ROWS: usize = 700;

/// A value of an input: mostly near the base's, at times anything.
fn value(input: usize) -> impl Strategy<Value = f64> {
    let base = base().value(input);
    let usual = if base.is_nan() { 50.0 } else { base };
    prop_oneof![
        20 => (0.7..1.3_f64).prop_map(move |share| usual * share),
        10 => Just(base),
        10 => (-3..70_i32).prop_map(f64::from),
        1 => -3e3..3e3_f64,
        1 => prop::num::f64::ANY,
    ]
}

fn values(input: usize, layout: Layout) -> BoxedStrategy<Values> {
    let list = |sizes| prop::collection::vec(value(input), sizes).prop_map(Values::List);
    let linspace = (value(input), value(input), 1..9_u64).prop_filter_map(
        "finite ends",
        |(from, to, steps)| {
            (from.is_finite() && to.is_finite()).then_some(Values::Linspace { from, to, steps })
        },
    );
    let interval = (value(input), value(input)).prop_filter_map("finite ends", |(a, b)| {
        let (low, high) = (a.min(b), a.max(b));
        (low.is_finite() && (high - low).is_finite()).then_some(Values::Interval { low, high })
    });
    let whole = (0..20_u32, 0..50_u32).prop_map(|(low, width)| Values::Whole {
        low: f64::from(low),
        high: f64::from(low + width),
    });
    match layout {
        Layout::Table => list(ROWS..=ROWS).boxed(),
        Layout::Grid => prop_oneof![list(1..=6), linspace].boxed(),
        _ => prop_oneof![list(1..=6), linspace, interval, whole].boxed(),
    }
}

fn limit() -> impl Strategy<Value = Limit> {
    let column = prop_oneof![
        Just(Limited::Output(Output::HoleWeb)),
        Just(Limited::Output(Output::ActivePinsMean)),
        Just(Limited::Input(Input::Eccentricity as usize)),
    ];
    (column, 0.0..10.0_f64).prop_map(|(column, min)| Limit {
        column,
        min,
        max: f64::INFINITY,
    })
}

prop_compose! {
    /// Any study: every input may vary in every way, over a base that may be anything too.
    fn study()(
        layout in prop_oneof![
            Just(Layout::Grid), Just(Layout::Sobol), Just(Layout::LatinHypercube),
            Just(Layout::Random), Just(Layout::Table),
        ],
        has_shaft in prop::bool::weighted(0.8),
        inputs in prop::sample::subsequence(
            (0..SCALARS + SHAFT.len() * SEGMENT_FIELDS.len()).collect::<Vec<_>>(), 0..6
        ),
        criterion in prop::sample::select(Criterion::ALL.to_vec()),
        discs in 1..=4_u8,
        turns in prop_oneof![Just(0.0), -2.0..2.0_f64],
        stiffness in prop::option::of(0.5..5.0_f64),
        kinds in Just(SHAFT.map(|segment| segment.kind()).to_vec()).prop_shuffle(),
        limits in prop::collection::vec(limit(), 0..2),
        seed in any::<u64>(),
    )(
        axes in inputs
            .into_iter()
            .filter(|input| has_shaft || *input < SCALARS)
            .map(|input| values(input, layout).prop_map(move |values| Axis { input, values }))
            .collect::<Vec<_>>(),
        layout in Just(layout), has_shaft in Just(has_shaft), criterion in Just(criterion),
        discs in Just(discs), turns in Just(turns), stiffness in Just(stiffness),
        kinds in Just(kinds), limits in Just(limits), seed in Just(seed),
    ) -> Study {
        // Every kind everywhere: each has a diameter that suits its place.
        let segment = |(place, kind): (usize, SegmentKind)| {
            let [diameter, _, length, _] = SHAFT[place].fields();
            ShaftSegment::of(kind, [diameter, 52.0 + 3.0 * place as f64, length, 5.0])
        };
        let shaft = kinds.into_iter().enumerate().map(segment).collect();
        let design = Design {
            criterion,
            disc_count: f64::from(discs),
            hole_clocking_deg: base().hole_clocking_deg + 360.0 * turns,
            output_stiffness_nm_per_arcmin: stiffness,
            shaft: if has_shaft { shaft } else { Vec::new() },
            ..base()
        };
        let space = Space::new(axes, layout, ROWS as u64, seed).expect("a space that can be");
        Study::new(space, &design, LOADS.to_vec(), limits).expect("a study that can be")
    }
}

/// The first variant and column in which blocks and variants one by one differ.
fn difference(study: &Study, rows: Rows<'_>, len: usize, outputs: &[Output]) -> Option<String> {
    let blocks = study
        .evaluate(rows, len, outputs)
        .expect("rows of the study");
    let alone = study
        .evaluate_one_by_one(rows, len, outputs)
        .expect("rows of the study");
    if blocks.any_refused != alone.any_refused {
        return Some("any_refused".to_owned());
    }
    for row in 0..len {
        if blocks.status[row] != alone.status[row] {
            return Some(format!(
                "row {row}: status {} instead of {}",
                blocks.status[row], alone.status[row]
            ));
        }
        for (output, (a, b)) in outputs.iter().zip(blocks.values.iter().zip(&alone.values)) {
            let (a, b) = (a[row], b[row]);
            // The sign and payload of a NaN mean nothing.
            if a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan()) {
                return Some(format!("row {row}: {output:?} {a:e} instead of {b:e}"));
            }
        }
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn any_study_has_the_bits_of_its_variants_one_by_one(
        study in study(),
        outputs in prop_oneof![
            Just(Output::all(&LOADS)), prop::sample::subsequence(Output::all(&LOADS), 1..4)
        ],
        picked in prop::collection::vec(any::<u64>(), 1..300),
    ) {
        let len = study.space().len().min(3000) as usize;
        prop_assert_eq!(difference(&study, Rows::From(0), len, &outputs), None);
        let last = study.space().len();
        let picked: Vec<u64> = picked.into_iter().map(|k| k % last).collect();
        prop_assert_eq!(difference(&study, Rows::At(&picked), picked.len(), &outputs), None);
        for variant in picked.iter().take(20) {
            let alone = study.evaluate(Rows::From(*variant), 1, &[]).expect("rows of the study");
            let reason = study.explain(*variant).map_or(Status::Ok, |error| error.status()) as u8;
            let is_limit = usize::from(alone.status[0]) >= Status::ALL.len();
            prop_assert!(alone.status[0] == reason || (is_limit && reason == Status::Ok as u8));
        }
    }
}

/// A study of drives that can be built, of every number of pins and discs.
fn sound(criterion: Criterion) -> Study {
    let interval = |input: Input, low: f64, high: f64| Axis {
        input: input as usize,
        values: Values::Interval { low, high },
    };
    let axes = vec![
        interval(Input::Eccentricity, 0.2, 0.8),
        Axis {
            input: Input::OutputPinCount as usize,
            values: Values::Whole {
                low: 3.0,
                high: 14.0,
            },
        },
        Axis {
            input: Input::DiscCount as usize,
            values: Values::Whole {
                low: 1.0,
                high: 4.0,
            },
        },
        interval(Input::HoleClocking, -400.0, 400.0),
        interval(Input::OutputPinDiameter, 5.0, 14.0),
        interval(Input::YoungsModulus, 70.0, 210.0),
    ];
    let design = Design {
        criterion,
        ..base()
    };
    let space = Space::new(axes, Layout::Sobol, 1 << 20, 7).expect("a space that can be");
    Study::new(space, &design, LOADS.to_vec(), Vec::new()).expect("a study that can be")
}

#[test]
fn blocks_of_drives_that_can_be_built_have_the_bits_of_drives_one_by_one() {
    for criterion in Criterion::ALL {
        let study = sound(criterion);
        let outputs = Output::all(&LOADS);
        assert_eq!(difference(&study, Rows::From(77), 30_000, &outputs), None);
        let built = study
            .evaluate(Rows::From(77), 30_000, &outputs)
            .expect("rows of the study")
            .status;
        assert!(built.iter().filter(|status| **status == 0).count() > 20_000);
    }
}
