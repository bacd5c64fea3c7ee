"""A datum that moves from run to run, by a law or erratically, and what is no such drift."""

import itertools
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import cyclosweep as cs
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.datum_laws import DatumLaw
from cyclosweep.simulation.effects.history import History
from cyclosweep.simulation.model import EffectValue
from cyclosweep.simulation.simulate import history_of
from tests.support.arrays import Floats

PAPER = np.array([0.0, -0.6, 0.3, 0.9])
"""Offsets that move one way and then the other, as in Fig. 3 of the paper [deg]."""
SAMPLES = 120
"""Samples of a run."""


def loops(tops: Sequence[float] | Floats, **known: npt.ArrayLike) -> cs.Recording:
    """One loop a run to so many newton metres; further columns have one value a run."""
    runs = [
        np.concatenate([np.linspace(a, b, 40) for a, b in itertools.pairwise((0.4, t, -t, 0.4))])
        for t in tops
    ]
    columns: dict[str, Any] = {
        name: np.repeat(np.asarray(values, dtype=float), SAMPLES) for name, values in known.items()
    }
    run = np.repeat(np.arange(1, len(runs) + 1), SAMPLES)
    return cs.Recording.from_arrays(np.concatenate(runs), run=run, **columns)


def recorded(
    offsets: npt.ArrayLike, load: cs.Recording, seed: int = 0, noise_deg: float = 0.3
) -> cs.Recording:
    """What a rig with a datum at these offsets reads."""
    rng = np.random.default_rng(seed)
    angle = cs.simulate(cs.Drive.reference_87(), load).angle_deg
    assert angle is not None
    noise = noise_deg * rng.standard_normal(len(load))
    return load.with_angle(angle + np.asarray(offsets)[load.run - 1] + noise)


def diagnose(recording: cs.Recording, *, full: bool = False) -> cs.Diagnosis:
    """Diagnose against the reference drive."""
    return cs.diagnose(recording, cs.Drive.reference_87(), full=full)


def names(found: cs.Diagnosis) -> list[str]:
    """Effects that were named for certain."""
    return [effect["name"] for effect in found.effects] if found.verdict == "IDENTIFIED" else []


def physics(found: cs.Diagnosis) -> str:
    """Words about the one effect."""
    (effect,) = found.effects
    return str(effect["physics"])


def to_and_fro(seed: int) -> cs.Recording:
    """Offsets of the paper in other sizes, or longer, on loops that are alike or differ."""
    rng = np.random.default_rng(seed)
    offsets = PAPER if seed < 6 else np.r_[PAPER, -0.4, 0.5]
    tops = np.full(len(offsets), 20.0) if seed % 2 else rng.uniform(12.0, 24.0, len(offsets))
    size = rng.uniform(0.6, 2.0) * rng.choice([-1.0, 1.0])
    return recorded(size * offsets, loops(tops), seed)


def test_datum_that_goes_to_and_fro_is_named() -> None:
    found = [diagnose(to_and_fro(seed)) for seed in range(12)]
    assert [[e["name"] for e in each.effects] for each in found] == [["datum_drift"]] * 12
    # Number 11 was said to leave a wave along the travel of the mesh while that wave was looked
    # for along the measured angle, whose noise it then explained.
    assert [names(each) for each in found] == [["datum_drift"]] * 12


@pytest.mark.parametrize("seed", range(4))
def test_datum_that_keeps_its_way_is_still_named(seed: int) -> None:
    rng = np.random.default_rng(seed)
    memory, runs = rng.uniform(0.4, 1.0), 6
    offsets = 0.5 * np.cumsum(np.r_[0.0, memory ** np.arange(runs - 1)])
    tops = np.full(runs, 20.0) if seed % 2 else rng.uniform(16.0, 24.0, runs)
    found = diagnose(recorded(offsets, loops(tops), seed))
    assert names(found) == ["datum_drift"]
    assert "moves the datum" in physics(found)


def wandering(seed: int, runs: int = 12) -> Floats:
    """Offsets that keep a part of the one before and get a new one of no known cause [deg]."""
    rng = np.random.default_rng(seed)
    offset, found = 0.0, []
    for push in rng.choice([-1.0, 1.0], runs) * rng.uniform(0.4, 1.4, runs):
        offset = 0.6 * offset + push
        found.append(offset)
    return 4.0 * np.array(found)


@pytest.mark.parametrize("seed", [2, 3])
def test_datum_that_comes_back_slowly_is_erratic(seed: int) -> None:
    # No law of the runs before explains it, and it goes to and fro too seldom for a few runs.
    tops = np.random.default_rng(9).uniform(12.0, 24.0, 12)
    assert names(diagnose(recorded(wandering(seed), loops(tops), seed))) == ["datum_drift"]


@pytest.mark.parametrize("seed", [4, 5])
def test_loud_datum_is_not_shared_with_a_transmission_error(seed: int) -> None:
    # Three orders made nearly all offsets of a few positions: a transmission error was named.
    places = [10.0, 130.0, 250.0, 10.0, 70.0, 130.0, 190.0, 310.0, 250.0]
    load = loops(np.random.default_rng(seed).uniform(12.0, 24.0, 9), crank_deg=places)
    found = diagnose(recorded(0.5 * wandering(seed, 9), load, seed, noise_deg=0.01))
    assert names(found) == ["datum_drift"]


def test_datum_that_drifts_one_way_and_back_is_not_erratic() -> None:
    slow = 4.0 * np.sin(np.linspace(0.0, 2.0 * np.pi, 12))
    tops = np.random.default_rng(9).uniform(12.0, 24.0, 12)
    assert "datum_drift" not in names(diagnose(recorded(slow, loops(tops))))


def test_datum_of_a_rig_that_is_reset_is_not_named() -> None:
    load = replace(loops(np.full(4, 20.0)), reset_between_runs=True)
    found = diagnose(recorded(PAPER, load))
    assert names(found) == []
    assert "datum_drift" in {row["name"] for row in found.content["not_testable"]}


def test_erratic_datum_is_said_to_be_and_not_predicted(tmp_path: Path) -> None:
    found = diagnose(recorded(PAPER, loops(np.full(4, 20.0))), full=True)
    assert names(found) == ["datum_drift"]
    assert "erratic" in physics(found)
    assert f"by {np.std(PAPER, ddof=1):.1f}" in physics(found)
    assert any("erratic" in note for note in found.content["notes"])

    assert found.model is not None
    path = tmp_path / "model.json"
    path.write_text(found.model.to_json())
    model = cs.Model.from_json(path)
    assert any("erratic" in note for note in model.notes)
    (value,) = model.effects
    assert value.amplitudes[0] == pytest.approx(np.std(PAPER, ddof=1), abs=0.1)
    load = loops(np.full(7, 15.0))
    angle = cs.simulate(model, load).angle_deg
    assert angle is not None
    by_run = angle.reshape(7, SAMPLES)
    np.testing.assert_array_equal(by_run, np.tile(by_run[0], (7, 1)))
    assert model.datum_deg == pytest.approx(PAPER.mean(), abs=0.1)


def test_erratic_datum_forecasts_no_worse_than_no_effect() -> None:
    # A run that was left out has no offset of its own; the first one had that of all others.
    offsets = [0.3, 0.95, -0.6, 1.1, -0.45, 1.0, -0.75, 0.9, -0.45, 0.75]
    tops = [12.0, 24.0, 20.0, 16.0, 24.0, 12.0, 20.0, 16.0, 24.0, 12.0]
    found = diagnose(recorded(offsets, loops(tops)), full=True)
    assert names(found) == ["datum_drift"]
    assert "erratic" in physics(found)
    repaired, before = found.content["repaired"], found.content["baseline"]
    assert repaired["holdout_rmse_deg"] <= 1.01 * before["holdout_rmse_deg"]


def test_datum_that_turns_back_has_a_negative_memory() -> None:
    found = diagnose(recorded([0.0, 0.8, 0.16, 0.67, 0.26, 0.59], loops(np.full(6, 20.0))))
    assert names(found) == ["datum_drift"]
    assert "turns back" in physics(found)
    assert found.effects[0]["parameters"]["memory"]["estimate"] == pytest.approx(-0.8, abs=0.1)


def test_run_at_full_load_that_resets_is_found() -> None:
    tops = np.array([10.0, 14.0, 24.0, 12.0, 9.0, 24.0, 11.0, 13.0])
    datum, offsets = 0.0, []
    for top in tops:
        offsets.append(datum)
        # What is kept is lost at full load; the run itself pushes on.
        datum = (0.0 if top == 24.0 else datum) + 0.03 * top
    found = diagnose(recorded(offsets, loops(tops)))
    assert names(found) == ["datum_drift"]
    assert "resets" in physics(found)


def test_last_excursion_alone_may_set_the_datum() -> None:
    last = np.array([1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0])
    rng = np.random.default_rng(3)
    tops = rng.uniform(12.0, 24.0, 8)
    ends = [(0.4, t, -t, 0.4, s * 0.5 * t, 0.0) for t, s in zip(tops, last, strict=True)]
    torque = [
        np.concatenate([np.linspace(a, b, 24) for a, b in itertools.pairwise(e)]) for e in ends
    ]
    load = cs.Recording.from_arrays(np.concatenate(torque), run=np.repeat(np.arange(1, 9), SAMPLES))
    found = diagnose(recorded(0.5 * np.r_[0.0, last[:-1]], load))
    assert names(found) == ["datum_drift"]
    assert "the direction of a run's last excursion" in physics(found)


def test_offsets_that_follow_the_temperature_are_no_drift() -> None:
    warm = np.array([20.0, 26.0, 22.0, 29.0, 21.0, 25.0])
    load = loops(np.full(6, 20.0), temperature_c=warm)
    assert names(diagnose(recorded(0.12 * (warm - 20.0), load))) == ["thermal_drift"]
    assert names(diagnose_without(recorded(0.12 * (warm - 20.0), load), "thermal_drift")) == []


def test_offsets_that_return_with_the_position_are_no_drift() -> None:
    crank = np.array([0.0, 50.0, 130.0, 50.0, 200.0, 0.0, 130.0, 290.0, 200.0, 290.0])
    offsets = 0.6 * np.cos(np.radians(crank)) - 0.4 * np.sin(np.radians(crank))
    load = loops(np.full(10, 20.0), crank_deg=crank)
    assert names(diagnose(recorded(offsets, load))) == ["transmission_error"]
    assert names(diagnose_without(recorded(offsets, load), "transmission_error")) == []


def test_offsets_at_positions_that_never_return_may_be_either() -> None:
    crank = np.array([0.0, 50.0, 130.0, 200.0, 290.0, 330.0])
    load = loops(np.full(6, 20.0), crank_deg=crank)
    found = diagnose_without(recorded([0.0, -0.6, 0.3, 0.9, -0.4, 0.5], load), "transmission_error")
    assert names(found) == []


def test_a_transmission_error_that_fits_any_offsets_is_not_named() -> None:
    """Three orders have as many amplitudes as seven runs have offsets: it was named for certain."""
    crank = np.array([154.0, 122.0, 267.0, 104.0, 293.0, 164.0, 135.0])
    turn = np.radians(crank)
    offsets = 0.9 * np.cos(turn) - 0.6 * np.sin(2.0 * turn) + 0.3 * np.cos(3.0 * turn)
    found = diagnose(recorded(offsets, loops(np.full(7, 20.0), crank_deg=crank), 0, 0.02))
    assert found.verdict == "UNKNOWN_PHYSICS"
    assert not found.effects
    assert "offset that goes with the position" in found.statement


def diagnose_without(recording: cs.Recording, effect: str) -> cs.Diagnosis:
    """Verdict of a library that lacks an effect."""
    return cs.diagnose(recording, cs.Drive.reference_87(), full=False, without=(effect,))


def history(tops: Sequence[float]) -> History:
    """Load history of one loop a run."""
    return history_of(loops(tops), cs.Model(2.7, 28.0))


def test_shifts_of_each_law() -> None:
    of = history([10.0, 24.0, 12.0, 8.0])
    np.testing.assert_allclose(DatumLaw(1, 1.0).shifts_deg(of), [0, 1.0, 3.4, 4.6])
    np.testing.assert_allclose(DatumLaw(1, -0.5).shifts_deg(of), [0, 1.0, 1.9, 0.25])
    np.testing.assert_allclose(DatumLaw(1, 1.0, resets=True).shifts_deg(of), [0, 1.0, 2.4, 3.6])
    # The last excursion of every run goes down to -t and comes back.
    np.testing.assert_allclose(DatumLaw(6, 0.0).shifts_deg(of), [0, -1.0, -1.0, -1.0])


@pytest.mark.parametrize("runs", [4, 6])
def test_random_offsets_of_few_runs_are_seldom_put_down_to_a_law(runs: int) -> None:
    rng = np.random.default_rng(runs)
    of, datum = history(list(rng.uniform(8.0, 24.0, runs))), find("datum_drift")
    turns = (-1.0) ** np.arange(runs)
    drawn = [turns * rng.uniform(0.1, 1.0, runs) for _ in range(60)]
    amplitudes = [(each - each.mean())[1:] for each in drawn]
    shape = {"each_run": 1.0}
    named = [each for each in amplitudes if datum.is_recognised(of, shape, each)]
    laws = [datum.portable(of, shape, each)[0] for each in named]
    assert len(named) == 60
    assert sum("push" in law for law in laws) < 0.1 * len(laws)


def test_offsets_written_before_are_still_counted_from_the_first_run() -> None:
    model = cs.Model(2.7, 28.0, effects=(EffectValue("datum_drift", {"free": 1.0}, (0.5, -0.2)),))
    load = loops(np.full(3, 20.0))
    moved, still = cs.simulate(model, load), cs.simulate(cs.Model(2.7, 28.0), load)
    assert moved.angle_deg is not None
    assert still.angle_deg is not None
    np.testing.assert_allclose(
        moved.angle_deg - still.angle_deg, np.repeat([0.0, 0.5, -0.2], SAMPLES), atol=1e-9
    )
