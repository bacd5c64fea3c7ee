"""A staircase tied to the position of a travelling mesh is named, with order and phase."""

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.travelling_mesh import recording

ORDER, SIZE, CREST = 7.0, 1.5, 20.0
NOISE = 0.05
TRAINED = [
    (0.5, 30, -30, 0.5, 18, -18, 0.5),
    (0.5, 24, -24, 0.5),
    (0.5, 30, 5, 30, -30, -5, -30, 0.5),
]
OTHER = [(0.5, 27, -27, 20, -12, 0.5)]


@pytest.fixture(scope="module")
def found() -> cs.Diagnosis:
    """Diagnosis of a staircase beside friction."""
    measured = recording(TRAINED, [(ORDER, SIZE, CREST)], 1.0, noise_deg=NOISE)
    return cs.diagnose(measured, cs.Drive.reference_87(), full=False)


def test_staircase_and_friction_are_named(found: cs.Diagnosis) -> None:
    assert found.verdict == "IDENTIFIED"
    assert {e["name"] for e in found.effects} == {"friction_hysteresis", "transmission_error"}


def test_order_and_phase_are_right(found: cs.Diagnosis) -> None:
    assert found.model is not None
    value = next(v for v in found.model.effects if v.name == "transmission_error")
    assert value.shape["travel_ratio"] == 1.0
    assert value.shape["travel_order_1"] == pytest.approx(ORDER, abs=0.02)
    cosine, sine = value.amplitudes[:2]
    assert np.hypot(cosine, sine) == pytest.approx(SIZE, rel=0.02)
    crest = np.degrees(np.arctan2(sine, cosine)) / ORDER % (360.0 / ORDER)
    assert crest == pytest.approx(CREST, abs=0.3)


def test_effect_says_that_it_goes_with_the_position(found: cs.Diagnosis) -> None:
    named = next(e for e in found.effects if e["name"] == "transmission_error")
    assert "position of mesh and motor" in named["physics"]
    assert "order 7 " in named["physics"]


def test_another_programme_is_forecast_to_the_noise(found: cs.Diagnosis) -> None:
    assert found.model is not None
    other = recording(OTHER, [(ORDER, SIZE, CREST)], 1.0, noise_deg=0.0)
    assert other.angle_deg is not None
    left = np.asarray(cs.simulate(found.model, other).angle_deg) - other.angle_deg
    # Readings at which friction may hold the shaft in its play are left out.
    loaded = np.abs(other.torque_nm) > 2.0
    assert np.sqrt(np.mean(left[loaded] ** 2)) < NOISE


def test_friction_alone_has_no_staircase() -> None:
    measured = recording(TRAINED, [], 1.0, noise_deg=NOISE)
    alone = cs.diagnose(measured, cs.Drive.reference_87(), full=False)
    assert [e["name"] for e in alone.effects] == ["friction_hysteresis"]


def test_a_low_order_is_found_on_a_mesh_that_travels_from_several_positions() -> None:
    """Each run is locked elsewhere, so that its crest stands elsewhere along the twist."""
    order, size, crest = 1.0, 0.4, 20.0
    positions = [0.0, 70.0, 160.0, 250.0]
    runs = [
        recording(TRAINED[:1], [(order, size, crest - at)], 0.0, noise_deg=NOISE, seed=k)
        for k, at in enumerate(positions)
    ]
    torque = [np.asarray(each.torque_nm) for each in runs]
    measured = cs.Recording.from_arrays(
        np.concatenate(torque),
        np.concatenate([np.asarray(each.angle_deg) for each in runs]),
        run=np.repeat(np.arange(len(runs)), [len(each) for each in torque]),
        crank_deg=np.repeat(positions, [len(each) for each in torque]),
    )
    found = cs.diagnose(measured, cs.Drive.reference_87(), full=False)
    assert found.verdict == "IDENTIFIED"
    assert [effect["name"] for effect in found.effects] == ["transmission_error"]
    assert "how far it has travelled since" in found.effects[0]["physics"]
    assert found.model is not None
    value = found.model.effects[0]
    assert value.shape == {"travel_ratio": 1.0, "order_1": order}
    cosine, sine = value.amplitudes
    assert np.hypot(cosine, sine) == pytest.approx(size, rel=0.05)
    assert np.degrees(np.arctan2(sine, cosine)) == pytest.approx(crest, abs=4.0)
