"""What the statement of a diagnosis says, and what stands at the head of its report."""

from dataclasses import replace

import cyclosweep as cs
from cyclosweep.diagnosis.hypotheses import behaviour_classes
from cyclosweep.report import ReportData
from cyclosweep.report.look_at import LOOK_AT, LOOK_AT_SHAPE
from cyclosweep.report.sentences import effect_cards
from cyclosweep.report.summary import do_now, summary_of
from cyclosweep.report.tables import play_table
from cyclosweep.report.wording import verdict_words
from cyclosweep.result import (
    Answer,
    Baseline,
    BehaviourClass,
    Bound,
    CalibratedParameter,
    Explained,
    Explanation,
    FoundEffect,
    HeldOutBlock,
    Mismatch,
    NextExperiment,
    NoiseEstimate,
    PlayAndStiffness,
    Reading,
    Remainder,
    Repair,
    RunToRunDrift,
    Size,
    Thinning,
)
from cyclosweep.result.shape_words import PHRASES
from cyclosweep.result.statement import statement_of
from cyclosweep.simulation.effects import VOCABULARY

CREEP = FoundEffect(name="creep", size_deg=Size(estimate=0.5, ci95=(0.4, 0.6)))
CALIBRATED = {
    "compliance_scale": CalibratedParameter(nominal=1.0, estimate=1.04),
    "free_play_deg": CalibratedParameter(nominal=28.0, estimate=27.5, std_error=0.02, unit="deg"),
    "datum_deg": CalibratedParameter(nominal=0.0, estimate=-0.3, unit="deg"),
}
ONE = (Explanation(effects=("creep",), probability=1.0),)
TWO = (
    Explanation(effects=("creep",), probability=0.6),
    Explanation(effects=("viscous_drag",), probability=0.38),
)
IDENTIFIED = Answer(
    verdict="IDENTIFIED",
    tolerance_deg=0.3,
    noise=NoiseEstimate(sigma_deg=0.2),
    baseline=Baseline(rmse_deg=0.35, holdout_rmse_deg=0.0),
    repaired=Repair(parameters=CALIBRATED, rmse_deg=0.2, holdout_rmse_deg=0.0),
    effects=(CREEP,),
    explanation_set=ONE,
)


def test_what_is_not_ruled_out_stands_beside_the_name() -> None:
    assert "Missing physics: creep. Size" in statement_of(IDENTIFIED)
    text = statement_of(replace(IDENTIFIED, explanation_set=TWO))
    assert "creep, with a probability of 60 %; not ruled out: viscous drag (38 %)" in text


def test_an_estimate_lies_within_its_interval_as_it_is_written() -> None:
    for size, words in (
        (Size(estimate=1.6538, ci95=(1.6502, 1.6573)), "creep 1.654 deg (95 %: 1.65 to 1.657)"),
        (Size(estimate=0.682, ci95=(0.66, 0.705)), "0.682 deg (41 arcmin) (95 %: 0.66 to 0.705)"),
    ):
        effect = FoundEffect(name="creep", size_deg=size)
        assert words in statement_of(replace(IDENTIFIED, effects=(effect,)))


def test_a_verdict_with_rivals_is_headed_by_its_probability() -> None:
    assert verdict_words(IDENTIFIED)[1] == "Cause identified"
    rivals = replace(IDENTIFIED, explanation_set=TWO)
    assert verdict_words(rivals)[1] == "Most probable cause (60 %)"


def test_error_on_data_not_used_is_said_only_where_it_was_computed() -> None:
    assert "data not used" not in statement_of(IDENTIFIED)
    computed = replace(
        IDENTIFIED,
        baseline=replace(IDENTIFIED.baseline, holdout_rmse_deg=0.3),
        repaired=replace(IDENTIFIED.repaired, holdout_rmse_deg=0.21),
    )
    assert "data not used from 0.3 deg (18 arcmin) to 0.21 deg" in statement_of(computed)


def test_calibration_stands_beside_every_verdict_that_has_one() -> None:
    text = statement_of(IDENTIFIED)
    assert "compliance +4.0 % against nominal" in text
    assert "free play 27.5 deg each side (nominal 28)" in text
    one_sided = CALIBRATED | {"free_play_deg": replace(CALIBRATED["free_play_deg"], std_error=None)}
    unknown = replace(IDENTIFIED, repaired=replace(IDENTIFIED.repaired, parameters=one_sided))
    assert "free play" not in statement_of(unknown)


def test_play_and_stiffness_are_those_of_the_loop() -> None:
    read = PlayAndStiffness(
        free_play_deg=Reading(estimate=3.07, ci95=(2.78, 3.35)),
        stiffness_at_output_nm_per_arcmin=Reading(estimate=0.2),
    )
    text = statement_of(replace(IDENTIFIED, play_and_stiffness=read))
    assert "free play from flank to flank 3.07 deg (95 %: 2.78 to 3.35)" in text
    assert "stiffness at the output 0.2 N m/arcmin. Calibration:" in text


def test_where_the_temperature_moves_the_compliance_each_value_says_when_it_holds() -> None:
    read = PlayAndStiffness(
        runs=3,
        free_play_deg=Reading(estimate=56.0),
        stiffness_at_output_nm_per_arcmin=Reading(estimate=43.5),
    )
    drifting = replace(
        IDENTIFIED, effects=(replace(CREEP, name="thermal_drift"),), play_and_stiffness=read
    )
    text = statement_of(drifting)
    assert "Read from the loop (means over the recording, whose temperature changed): free" in text
    assert "Calibration at 20 degC: compliance +4.0 % against nominal" in text
    steady = statement_of(replace(IDENTIFIED, play_and_stiffness=read))
    assert "Read from the loop: free play" in steady
    assert "Calibration: compliance" in steady
    notes = []
    for answer in (drifting, replace(IDENTIFIED, play_and_stiffness=read)):
        recording = cs.Recording.from_arrays([], name="none")
        table = play_table(ReportData(recording=recording, result=answer))
        assert table is not None
        notes.append("holds at 20 degC" in table.note)
    assert notes == [True, False]


def test_the_tolerance_decides_what_is_open() -> None:
    nothing = replace(
        IDENTIFIED,
        verdict="NOTHING_MISSING",
        effects=(),
        ruled_out=(Bound(name="creep", upper95_deg=0.05), Bound(name="orders", upper95_deg=0.11)),
    )
    assert "is below 0.11 deg (6.6 arcmin) (tolerance 0.3 deg" in statement_of(nothing)
    poor = replace(
        nothing,
        verdict="INSUFFICIENT_DATA",
        undecided=(
            Bound(name="viscous_drag", upper95_deg=0.4),
            Bound(name="thermal_drift", upper95_deg=1.5),
        ),
    )
    assert "thermal drift and viscous drag could be as large as 1.5 deg" in statement_of(poor)


def test_an_effect_below_the_tolerance_is_called_so() -> None:
    assert "does not matter" not in statement_of(IDENTIFIED) + summary_of(IDENTIFIED)
    small = replace(IDENTIFIED, tolerance_deg=0.8)
    said = " Creep is below the tolerance of 0.8 deg (48 arcmin), the size below which an effect"
    for verdict in ("IDENTIFIED", "MOSTLY_EXPLAINED", "UNKNOWN_PHYSICS"):
        told = replace(small, verdict=verdict, mismatch=Mismatch(p_value=0.001))
        assert said in statement_of(told)
        assert said in summary_of(told)
    near = replace(IDENTIFIED, tolerance_deg=0.55)  # within the interval of the size
    assert "Creep is probably below the tolerance of 0.55 deg" in statement_of(near)
    data = ReportData(recording=cs.Recording.from_arrays([], name="none"), result=small)
    assert effect_cards(data)[0][1].endswith("; below the tolerance of 0.8 deg (48 arcmin)")


def test_what_remains_is_described_and_a_drift_takes_the_place_of_a_calibration() -> None:
    unknown = replace(
        IDENTIFIED,
        verdict="UNKNOWN_PHYSICS",
        unknown=Remainder(shape="step", place="from run 7", size_deg=0.16),
    )
    text = statement_of(unknown)
    assert text.startswith("Unknown physics: Beside creep (creep 0.5 deg")
    assert "remains: a step of 0.16 deg, from run 7." in text
    assert "Calibration: compliance" in text
    drifting = statement_of(replace(unknown, drift=RunToRunDrift(own_deg=0.1, other_deg=1.2)))
    assert "misses others by 1.2 deg against 0.1 deg" in drifting
    assert "Calibration" not in drifting


def test_a_repair_that_helps_is_said_where_its_law_may_not_be_named() -> None:
    stood_in = replace(
        IDENTIFIED.repaired, rmse_deg=0.48, stand_ins=("friction_hysteresis", "contact_stiffening")
    )
    unknown = replace(
        IDENTIFIED,
        verdict="UNKNOWN_PHYSICS",
        effects=(),
        baseline=Baseline(rmse_deg=4.0, holdout_rmse_deg=0.0),
        repaired=stood_in,
    )
    text = statement_of(unknown)
    assert "behaves like friction hysteresis and contact stiffening, whose law is not" in text
    assert "removes 98.6 % of the mismatch (4 deg to 0.48 deg" in text
    left_out = replace(
        unknown,
        baseline=Baseline(rmse_deg=4.0, holdout_rmse_deg=2.0),
        repaired=replace(stood_in, holdout_rmse_deg=1.9),
    )
    assert "behaves like" not in statement_of(left_out)
    assert "behaves like" not in statement_of(replace(unknown, repaired=IDENTIFIED.repaired))


def test_forecasts_have_a_sentence_of_their_own() -> None:
    block = HeldOutBlock(block="run 3", before_deg=1.5, after_deg=0.25)
    assert "forecast" not in statement_of(replace(IDENTIFIED, repaired=with_block(block)))
    forecast = replace(block, told_before_deg=1.1, told_after_deg=0.15, floor_deg=0.125)
    text = statement_of(replace(IDENTIFIED, repaired=with_block(forecast)))
    assert "errs by 0.25 deg (15 arcmin), before the repair by 1.5 deg" in text
    assert "Another run as the prediction leaves 0.125 deg" in text
    first, second = (
        replace(forecast, samples=n, before_deg=b, floor_deg=f)
        for n, b, f in ((300, 1.0, None), (100, 3.0, 0.2))
    )
    whole = replace(IDENTIFIED.repaired, blocks=(first, block, second))
    text = statement_of(replace(IDENTIFIED, repaired=whole))
    assert "before the repair by 1.73 deg" in text  # the root of (300 + 100 * 9) / 400
    assert "Another run as the prediction leaves 0.2 deg" in text


def with_block(block: HeldOutBlock) -> Repair:
    return replace(IDENTIFIED.repaired, blocks=(block,))


def test_thinning_of_a_long_recording_is_said_with_every_verdict() -> None:
    assert "thinned" not in statement_of(IDENTIFIED)
    thinning = Thinning(samples=600_000, rows=6_012, averaged=50, every=2)
    for verdict in ("IDENTIFIED", "NOTHING_MISSING", "UNKNOWN_PHYSICS"):
        text = statement_of(replace(IDENTIFIED, verdict=verdict, thinning=thinning))
        assert "600,000 samples were thinned to 6,012 rows" in text
        assert "about 50 neighbours averaged in each, one in 2 taken" in text
    unmixed = replace(thinning, averaged=1)
    assert "averaged" not in statement_of(replace(IDENTIFIED, thinning=unmixed))


def test_what_is_left_is_said_to_be_above_the_noise_only_where_it_is() -> None:
    mostly = replace(IDENTIFIED, verdict="MOSTLY_EXPLAINED")
    loud = replace(mostly, repaired=replace(mostly.repaired, rmse_deg=0.21))
    assert "what is left is above the noise and has no name" in statement_of(loud)
    within = statement_of(mostly)
    assert "above the noise" not in within
    assert (
        "is on average no larger than the noise of 0.2 deg (12 arcmin), but has a shape, and has"
        in within
    )


def test_classes_are_said_apart_and_once() -> None:
    """What a named law misses inside its class belongs to that law."""
    drift, loop = "slow change with time", "loop of constant width"
    of_two = replace(
        IDENTIFIED,
        effects=(),
        verdict="UNKNOWN_PHYSICS",
        classes=(
            BehaviourClass(
                behaviour=drift, stand_ins=("friction_hysteresis",), candidates=("creep",)
            ),
            BehaviourClass(behaviour=loop, candidates=("friction_hysteresis",)),
        ),
    )
    assert (
        "Its classes of behaviour are clear, its law is not: a slow change with time (listed "
        "effects of this class: creep; friction hysteresis only stands in for it), and a loop of "
        "constant width (listed effects of this class: friction hysteresis)."
    ) in statement_of(of_two)
    named = BehaviourClass(behaviour=drift, laws=("creep",), missed_share=0.035)
    left = Remainder(shape="creep", place="all along", size_deg=0.0003)
    of_one = replace(
        IDENTIFIED,
        verdict="MOSTLY_EXPLAINED",
        classes=(named, BehaviourClass(behaviour=drift)),
        unknown=left,
    )
    said = statement_of(of_one)
    assert "the law of creep misses 3.5 %" in said
    assert "what the law of creep misses, 0.0003 deg" in said
    assert "behaviour is clear" not in said


def test_every_effect_says_what_to_look_at() -> None:
    assert set(LOOK_AT) == {effect.name for effect in VOCABULARY}
    classes = {value for value in vars(behaviour_classes).values() if isinstance(value, str)}
    assert set(LOOK_AT_SHAPE) <= set(PHRASES) | classes


def test_the_advice_is_about_what_makes_up_most_of_the_mismatch() -> None:
    """Friction that explained a fifth beside a drift of the zero sent the user to the bearings."""
    friction = FoundEffect(
        name="friction_hysteresis", size_deg=Size(estimate=0.008, ci95=(0.006, 0.01))
    )
    plan = NextExperiment(program="two loops")
    drift = Remainder(shape="slow drift", size_deg=0.011)
    play = BehaviourClass(behaviour="play that changes from run to run")
    misfit = Remainder(shape="misfit of the model", size_deg=0.075)
    for share, effects, rest, classes, begins in (
        (0.19, (friction,), drift, (), "Look at what moves the zero"),
        (0.8, (friction,), drift, (), "Look at bearings"),
        (0.19, (friction,), misfit, (), "Record next: two loops"),
        (0.0, (), misfit, (play,), "Look at parts that seat, wear or loosen"),
        (0.0, (), Remainder(shape="loop by rate", size_deg=0.005), (), "Look at the torque signal"),
        (1.0, (friction,), None, (), "Look at bearings"),
    ):
        answer = Answer(
            verdict="UNKNOWN_PHYSICS" if rest else "IDENTIFIED",
            effects=effects,
            explained=Explained(share=share),
            unknown=rest,
            classes=classes,
            next_experiment=plan,
        )
        assert do_now(answer).startswith(begins)
