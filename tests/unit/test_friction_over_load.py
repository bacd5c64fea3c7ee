"""Friction whose limit is no line of the load: recognised as friction that grows with the load."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.bent_friction import bent_instead_of_others
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.effects.slip import friction_limit_nm
from cyclosweep.simulation.model import EffectValue
from tests.support.searches import search_of_recording

TOP = 20.0
SLIDE = {"slip_deg": 0.4, "scatter": 0.8, "slack": 0.0}


def loops() -> cs.Recording:
    """Four loops to falling loads in each direction."""
    tops = TOP * np.array([1.0, 0.75, 0.5, 0.3])
    one = np.concatenate([np.linspace(0, 1, 40), np.linspace(1, -1, 80), np.linspace(-1, 0, 40)])
    torque = np.concatenate([top * one for top in tops])
    run = np.repeat(np.arange(len(tops)), len(one))
    return cs.Recording.from_arrays(
        torque, run=run, time_s=0.5 * np.arange(len(torque)), side="input"
    )


def recorded(law: Floats, noise_deg: float = 0.02) -> cs.Recording:
    """Loops of a drive whose friction over the load is a table of points at equal loads."""
    load = loops()
    torque, run = load.torque_nm, load.run
    elastic = np.linspace(0.0, TOP * 1.5, len(law))
    rng = np.random.default_rng(4)
    angle = np.zeros(len(torque))
    for each in np.unique(run):
        rows = np.flatnonzero(run == each)
        anchor = 0.0
        for i in rows:
            # One element of a contact that sticks over 0.4 deg, by bisection in the elastic twist.
            low, high = -120.0, 120.0
            for _ in range(60):
                at = 0.5 * (low + high)
                held = at / 2.7
                state = np.clip((at - anchor) / 0.4, -1.0, 1.0)
                friction = state * np.interp(abs(held), elastic, law)
                low, high = (at, high) if held + friction < torque[i] else (low, at)
            anchor = np.clip(anchor, at - 0.4, at + 0.4)
            angle[i] = at
    angle += 28.0 * np.sign(torque)
    return load.with_angle(angle + noise_deg * rng.normal(size=len(torque)))


def test_limit_over_the_load() -> None:
    shape = {**SLIDE, "reference_nm": 8.0}
    load = np.array([0.0, 8.0, 32.0, 320.0])
    line = friction_limit_nm(shape, (0.5, 0.1), load)
    np.testing.assert_allclose(line, [0.5, 1.3, 3.7, 32.5])
    saturates = friction_limit_nm({**shape, "load_power": -1.0}, (0.0, 0.1), load)
    np.testing.assert_allclose(saturates, [0.0, 0.8, 1.28, 12.8])
    grows = friction_limit_nm({**shape, "load_power": 1.0}, (0.0, 0.1), load)
    np.testing.assert_allclose(grows, [0.0, 0.8, 8.0, 80.0])


def test_a_power_needs_a_load_at_which_the_share_holds(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    for shape in ({"reference_nm": 8.0}, {}):
        value = EffectValue(
            "load_dependent_friction", {**SLIDE, "load_power": 1.2, **shape}, (0.1,)
        )
        path.write_text(
            cs.Model(compliance_deg_per_nm=2.7, free_play_deg=0.0, effects=(value,)).to_json()
        )
        if shape:
            assert cs.Model.from_json(path).effects == (value,)
        else:
            with pytest.raises(cs.InputError, match="reference_nm"):
                cs.Model.from_json(path)


@pytest.mark.parametrize("law", ["saturates", "joins"])
def test_friction_bent_over_the_load_is_one_effect(law: str) -> None:
    """In proportion to the load it left 9 % of the mean square, and no more than 0.1 % now."""
    load = np.linspace(0.0, 1.5, 400)
    limit = 1.6 * (1.0 - np.exp(-load / 0.3)) if law == "saturates" else 2.2 * load**1.8
    found = cs.diagnose(recorded(limit), cs.Drive.reference_87(), full=False)
    assert [effect["name"] for effect in found.effects] == ["load_dependent_friction"]
    assert found.model is not None
    power = found.model.effects[0].shape["load_power"]
    assert (power < -0.3) if law == "saturates" else (power > 0.3)
    assert found.content["explained"]["share"] > 0.99


def test_a_bent_limit_is_tried_against_the_noise_alone() -> None:
    """What a limit in proportion to the load misses is no take-up beside it."""
    load = np.linspace(0.0, 1.5, 400)
    search = search_of_recording(recorded(0.9 * load**1.6, noise_deg=0.3))
    found = search.extend(search.baseline, "load_dependent_friction")
    assert found is not None
    assert found.fit.terms[0].shape["load_power"] > 0.2
    assert search.suffices(found)
    straight = search_of_recording(recorded(0.9 * load, noise_deg=0.3))
    plain = straight.extend(straight.baseline, "load_dependent_friction")
    assert plain is not None
    assert straight.suffices(plain)
    assert "load_power" not in plain.fit.terms[0].shape


def test_further_effects_are_tried_before_a_bent_limit() -> None:
    """A bent limit could hold a part of a take-up, and a take-up a part of a bent limit."""
    load = np.linspace(0.0, 1.5, 400)
    search = search_of_recording(recorded(1.6 * (1.0 - np.exp(-load / 0.3))))
    friction = Term(find("load_dependent_friction"), SLIDE, None, 0.1)
    fitted = fit(search.problem, search.noise, (friction,), search.baseline.fit, rounds=20)
    stage = Search(search.problem, search.noise, search.library, 0, fitted)
    bent = bent_instead_of_others(stage, stage.start)
    assert bent is not None
    assert bent.fit.terms[0].shape["load_power"] < -0.3
    assert bent.fit.rmse_deg < 0.3 * fitted.rmse_deg
    likelier = replace(stage.start, gain=bent.score + 1.0)
    assert bent_instead_of_others(stage, likelier) is None
    # What is bent already is left as it is.
    again = Search(search.problem, search.noise, search.library, 0, bent.fit)
    assert bent_instead_of_others(again, again.start) is None
