"""Free play and stiffness by straight lines: what was put into a loop comes out of it."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.report import ReportData
from cyclosweep.report.play_and_stiffness import play_and_stiffness
from cyclosweep.report.tables import play_table
from cyclosweep.result import (
    Answer,
    CalibratedParameter,
    EffectParameter,
    Explanation,
    FoundEffect,
    PlayAndStiffness,
    Reading,
    Remainder,
    Size,
)
from cyclosweep.result.calibration_words import calibration_words, play_words
from tests.support.dry_friction import twist_with_friction

FITTED = {
    "free_play_deg": CalibratedParameter(nominal=1.0, estimate=1.4, std_error=0.05, unit="deg"),
    "compliance_deg_per_nm": CalibratedParameter(estimate=0.1, std_error=0.002),
}


def loop(side: str = "output", runs: int = 3, friction_nm: float = 2.0) -> cs.Recording:
    """Loops with a play of 3 deg in all, 0.1 deg/(N m), and friction; each run a little softer."""
    branch = np.r_[0:24:300j, 24:-24:600j, -24:0:300j]
    elastic = branch - friction_nm * np.sign(np.gradient(branch))
    torque, angle, run = [], [], []
    for k in range(runs):
        torque.append(branch)
        angle.append(1.5 * np.sign(elastic) + (0.1 + 0.001 * (k - 1)) * elastic)
        run.append(np.full(len(branch), k))
    return cs.Recording.from_arrays(
        np.concatenate(torque), np.concatenate(angle), run=np.concatenate(run), side=side
    )


def test_what_was_put_in_comes_out_with_an_interval() -> None:
    read = play_and_stiffness(loop(), FITTED, 13.0)
    assert read.runs == 3
    assert read.free_play_deg is not None
    assert read.free_play_deg.estimate == pytest.approx(3.0, abs=0.05)
    stiffness = read.stiffness_at_output_nm_per_arcmin
    assert stiffness is not None
    assert stiffness.estimate == pytest.approx(1 / (60 * 0.1), rel=0.01)
    assert stiffness.ci95 is not None
    assert stiffness.ci95[0] < stiffness.estimate < stiffness.ci95[1]
    assert read.friction_nm is not None
    assert read.friction_nm.estimate == pytest.approx(2.0, abs=0.1)


def test_a_loop_at_the_input_is_given_at_the_output_too() -> None:
    read = play_and_stiffness(loop("input"), FITTED, 13.0)
    at_output = play_and_stiffness(loop(), FITTED, 13.0)
    assert read.free_play_deg == at_output.free_play_deg
    assert read.free_play_at_output_deg is not None
    assert read.free_play_at_output_deg.estimate == pytest.approx(3.0 / 13.0, rel=0.02)
    stiff, other = (each.stiffness_at_output_nm_per_arcmin for each in (read, at_output))
    assert stiff is not None
    assert other is not None
    assert stiff.estimate == pytest.approx(169 * other.estimate)


def test_readings_by_hand_take_the_fitted_lines() -> None:
    torque = np.r_[1:5:5j, -1:-5:5j]
    read = play_and_stiffness(cs.Recording.from_arrays(torque, torque), FITTED, 13.0)
    assert read.runs == 0
    assert "published model" in read.definition
    assert read.free_play_deg is not None
    assert read.free_play_deg.estimate == pytest.approx(2.8)
    assert read.free_play_deg.ci95 == pytest.approx((2.604, 2.996))


@pytest.mark.parametrize("seed", range(4))
def test_readings_by_hand_with_friction_take_the_repaired_lines(seed: int) -> None:
    """Without the friction the line is too stiff, by five to ten of its standard errors."""
    torque = np.r_[0:6.1, 5:-6.1:-1, -5:6.1, 5:-6.1:-1, -5:0.1]
    noise = 0.2 * np.random.default_rng(seed).standard_normal(len(torque))
    angle = np.round(twist_with_friction(torque, 0.4, 2.726) + noise, 1)
    recording = cs.Recording.from_arrays(torque, angle, side="input")
    answer = cs.diagnose(recording, cs.Drive.reference_87(), full=False).answer
    assert [effect.name for effect in answer.effects] == ["friction_hysteresis"]
    read = answer.play_and_stiffness
    assert read is not None
    assert read.runs == 0
    assert "what was found to be missing" in read.definition
    for value, true in ((read.compliance_deg_per_nm, 2.726), (read.free_play_deg, 56.0)):
        assert value is not None
        assert value.ci95 is not None
        half = 0.5 * (value.ci95[1] - value.ci95[0])
        assert abs(value.estimate - true) < 1.5 * half  # 1.0 at 95 %, 1.5 at 99.7 %


def test_one_run_has_no_interval_and_a_missing_value_has_a_reason() -> None:
    one = play_and_stiffness(loop(runs=1), FITTED, 13.0)
    assert one.free_play_deg is not None
    assert one.free_play_deg.ci95 is None
    hidden = play_and_stiffness(loop(), FITTED, 13.0, hidden="too small a load")
    assert hidden.free_play_deg is None
    assert hidden.stiffness_at_output_nm_per_arcmin is None
    assert hidden.reason == "friction hides play and stiffness: too small a load"
    unsteady = play_and_stiffness(loop(), FITTED, 13.0, unsteady=True)
    assert unsteady.free_play_deg is not None
    assert unsteady.compliance_deg_per_nm is None
    assert "drift" in (unsteady.reason or "")
    one_flank = {"free_play_deg": CalibratedParameter(estimate=1.0)}
    torque = np.arange(1.0, 9.0)
    alone = play_and_stiffness(cs.Recording.from_arrays(torque, torque), one_flank, 13.0)
    assert alone.free_play_deg is None
    assert "only one flank" in (alone.reason or "")


def test_the_friction_of_short_runs_is_read_from_all_of_them() -> None:
    branch = np.r_[0.2:6:30j, 6:0.2:30j, -0.2:-6:30j, -6:-0.2:30j]
    torque = np.tile(branch, 2)
    elastic = torque - 0.3 * np.sign(np.gradient(torque))
    angle = 28.0 * np.sign(torque) + 2.7 * elastic
    run = np.repeat([1, 2], len(branch))
    one = play_and_stiffness(cs.Recording.from_arrays(torque, angle), FITTED, 87.0)
    two = play_and_stiffness(cs.Recording.from_arrays(torque, angle, run=run), FITTED, 87.0)
    assert one.friction_nm is not None
    assert two.friction_nm == one.friction_nm
    assert one.friction_nm.estimate == pytest.approx(0.3, abs=0.03)
    assert two.runs == 0
    assert two.definition.endswith("all runs together")
    assert two.reason is None


def test_a_friction_that_cannot_be_read_is_said_to_be_none_read() -> None:
    torque = np.r_[1:5:5j, -1:-5:5j]
    read = play_and_stiffness(cs.Recording.from_arrays(torque, torque), FITTED, 13.0)
    assert read.friction_nm is None
    assert "friction takes rising and falling branches" in (read.reason or "")
    assert shown(read)["friction at the input, half the loop's width"] == ("not read", "–")


def shown(
    read: PlayAndStiffness, named: tuple[str, ...] = (), possible: tuple[str, ...] = ()
) -> dict[str, tuple[str, str]]:
    """Rows of the table of play and stiffness, by their labels, beside named effects."""
    recording = loop("input")
    answer = Answer(
        verdict="IDENTIFIED" if named else "NOTHING_MISSING",
        effects=tuple(
            FoundEffect(name=name, size_deg=Size(estimate=1.0, ci95=(0.9, 1.1))) for name in named
        ),
        explanation_set=tuple(Explanation(effects=(name,), probability=0.3) for name in possible),
        play_and_stiffness=read,
    )
    table = play_table(ReportData(recording=recording, result=answer))
    assert table is not None
    return {label: (value, ends) for label, value, ends in table.rows}


def test_a_loop_without_friction_is_said_to_have_none() -> None:
    torque = np.tile(np.r_[1:12:40j, 12:1:40j, -1:-12:40j, -12:-1:40j], 2)
    run = np.repeat([1, 2], len(torque) // 2)
    angle = 3.0 * np.sign(torque) + 0.3 * torque
    read = play_and_stiffness(cs.Recording.from_arrays(torque, angle, run=run), FITTED, 13.0)
    assert read.friction_nm is not None
    assert read.friction_nm.estimate == 0.0
    label = "friction at the input, half the loop's width"
    assert shown(read)[label] == ("none found", "–")
    for estimate, ends, words in (
        (-0.005, (-0.04, 0.03), ("none found", "at most 0.03 N m")),
        (0.5, (0.48, 0.52), ("0.5 N m", "0.48 … 0.52")),
        (-0.5, (-0.52, -0.48), ("−0.5 N m", "−0.52 … −0.48")),
        (0.25, None, ("0.25 N m", "–")),
        (-0.02, None, ("none found", "–")),
        (-0.5, None, ("−0.5 N m", "–")),
    ):
        found = replace(read, friction_nm=Reading(estimate=estimate, ci95=ends))
        assert shown(found)[label] == words


def test_the_width_of_a_loop_is_said_to_be_of_all_that_opens_it() -> None:
    read = PlayAndStiffness(runs=2, friction_nm=Reading(estimate=0.9, ci95=(0.8, 1.0)))
    friction = "friction at the input, half the loop's width"
    width = "half the loop's width at the input, of"
    for named, possible, label in (
        ((), (), friction),
        (("creep",), (), f"{width} creep, not of friction"),
        (("creep", "load_dependent_friction"), (), f"{width} friction and creep"),
        (
            ("viscous_drag", "creep", "friction_hysteresis"),
            (),
            f"{width} friction, creep and viscous drag",
        ),
        (
            ("creep",),
            ("creep", "friction_hysteresis"),
            f"{width} creep, perhaps with friction",
        ),
        (("contact_stiffening",), (), friction),
        (("friction_hysteresis",), (), friction),
    ):
        assert list(shown(read, named, possible)) == [label]


def test_a_width_beside_what_has_no_name_is_not_called_friction() -> None:
    read = PlayAndStiffness(runs=2, friction_nm=Reading(estimate=0.9, ci95=(0.8, 1.0)))
    answer = Answer(
        verdict="UNKNOWN_PHYSICS",
        unknown=Remainder(shape="loop by rate", size_deg=0.1),
        play_and_stiffness=read,
    )
    table = play_table(ReportData(recording=loop(), result=answer))
    assert table is not None
    label = "half the loop's width at the output, of friction or of what has no name"
    assert table.rows[0][0] == label


def test_the_fitted_friction_torque_stands_below_the_width_of_the_loop() -> None:
    """A loop of 54 N m, half creep, was the only friction that a terminal showed; it was 30."""
    torque = EffectParameter(
        estimate=30.05, std_error=0.15, unit="N m", meaning="Coulomb friction torque"
    )
    distance = EffectParameter(estimate=0.3, std_error=0.1, unit="deg")
    effect = FoundEffect(
        name="friction_hysteresis",
        parameters={"friction_torque_nm": torque, "slip_deg": distance},
        size_deg=Size(estimate=1.0, ci95=(0.9, 1.1)),
    )
    read = PlayAndStiffness(runs=2, friction_nm=Reading(estimate=54.0, ci95=(53.0, 55.0)))
    answer = Answer(verdict="IDENTIFIED", effects=(effect,), play_and_stiffness=read)
    table = play_table(ReportData(recording=loop(), result=answer))
    assert table is not None
    assert table.rows[-1] == (
        "Coulomb friction torque at the output, fitted",
        "30.1 N m",
        "29.8 … 30.3",
    )


def test_an_interval_has_the_digits_that_tell_its_ends_apart() -> None:
    ends = Reading(estimate=55.506, ci95=(55.502, 55.51))
    read = PlayAndStiffness(runs=3, free_play_deg=ends)
    value, interval = shown(read)["free play at the input, from flank to flank"]
    assert (value.split()[0], interval) == ("55.506", "55.502 … 55.51")
    assert play_words(read) == (
        "Read from the loop: free play from flank to flank 55.506 deg (95 %: 55.502 to 55.51). "
    )


def test_a_play_below_zero_is_said_to_be_none() -> None:
    below = Reading(estimate=-0.05, ci95=(-0.13, 0.02))
    assert play_words(PlayAndStiffness(runs=3, free_play_deg=below)) == (
        "Read from the loop: free play from flank to flank -0.05 deg (95 %: -0.13 to 0.02), that "
        "is none, as the straight lines along the flanks overlap. "
    )


def test_no_table_shows_a_play_below_zero() -> None:
    label = "free play at the input, from flank to flank"
    below = Reading(estimate=-0.05, ci95=(-0.13, 0.02))
    assert shown(PlayAndStiffness(runs=3, free_play_deg=below))[label] == (
        "none, the lines overlap by 0.05 deg (3 arcmin)",
        "0 … 0.02",
    )
    about_zero = Reading(estimate=0.01, ci95=(-0.13, 0.15))
    value, interval = shown(PlayAndStiffness(runs=3, free_play_deg=about_zero))[label]
    assert (value, interval) == ("0.01 deg (0.6 arcmin)", "0 … 0.15")
    assert play_words(PlayAndStiffness(runs=3, free_play_deg=about_zero)) == (
        "Read from the loop: free play from flank to flank 0.01 deg (95 %: 0 to 0.15). "
    )


def test_a_width_that_was_not_read_is_not_said_to_be_of_anything() -> None:
    read = PlayAndStiffness(runs=0, reason="too few branches")
    width = "half the loop's width at the output"
    unknown = Remainder(shape="loop by rate", size_deg=0.1)
    for rest, named in ((unknown, None), (None, "creep"), (None, "viscous_drag")):
        found = FoundEffect(name=named or "", size_deg=Size(estimate=1.0, ci95=(0.9, 1.1)))
        answer = Answer(
            verdict="UNKNOWN_PHYSICS",
            effects=(found,) if named else (),
            unknown=rest,
            play_and_stiffness=read,
        )
        table = play_table(ReportData(recording=loop(), result=answer))
        assert table is not None
        assert table.rows[0][:2] == (width, "not read")


def test_a_compliance_beside_friction_is_said_to_be_of_the_elastic_parts() -> None:
    """A loop 28 % softer than nominal stood beside a compliance of +105.8 %, of other parts."""
    known = FITTED | {
        "compliance_scale": CalibratedParameter(nominal=1.0, estimate=2.058),
        "compliance_deg_per_nm": CalibratedParameter(estimate=0.2058, nominal=0.1),
        "datum_deg": CalibratedParameter(estimate=0.0, unit="deg"),
    }
    read = PlayAndStiffness(compliance_deg_per_nm=Reading(estimate=0.128))
    said = "compliance +105.8 % against nominal"
    parts = "of the elastic parts, without those that friction holds"
    assert f"{said}, free play" in calibration_words(known, read=read)
    assert f"{said} ({parts}), free play" in calibration_words(known, rubs=True)
    both = f"{said} ({parts}; of the loop as read +28.0 %), free play"
    assert both in calibration_words(known, rubs=True, read=read)
    same = PlayAndStiffness(compliance_deg_per_nm=Reading(estimate=0.2058))
    assert f"{said} ({parts}), free play" in calibration_words(known, rubs=True, read=same)
