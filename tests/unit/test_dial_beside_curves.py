"""An eccentric dial beside a large curve of the torque keeps its name, and so does a side load."""

import numpy as np
import pytest
from numpy.typing import NDArray

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.law_in_class import size_of_class
from cyclosweep.simulation.effects import effects

Reals = NDArray[np.float64]
TOP_NM, PLAY_DEG, COMPLIANCE = 12.5, 27.6, 2.7
NOISE_DEG = 0.05


def recorded(extra: Reals, torque: Reals, run: Reals, seed: int) -> cs.Recording:
    """Recording at the input of the reference drive, with an angle added to that of the line."""
    clean = np.sign(torque) * PLAY_DEG + COMPLIANCE * torque + extra
    angle = clean + np.random.default_rng(seed).normal(0.0, NOISE_DEG, torque.size)
    return cs.Recording.from_arrays(
        torque, angle, run=run.astype(int), side="input", drive="reference-87"
    )


def programme() -> tuple[Reals, Reals]:
    """Torque and run of eight loops up to different loads."""
    tops = TOP_NM * np.array([1.0, 0.6, 0.9, 0.5, 1.0, 0.7, 0.8, 1.0])
    loops = [top * np.sin(np.linspace(0.005, 2 * np.pi - 0.005, 300)) for top in tops]
    return np.concatenate(loops), np.repeat(np.arange(len(tops)), 300)


def dial(angle: Reals, eccentric_deg: float, phase: float) -> Reals:
    """Error of a dial off centre [deg]."""
    return np.asarray(eccentric_deg * np.sin(np.radians(angle) - phase))


def softening(torque: Reals, slope: float) -> Reals:
    """Twist of a joint that lets go above a load, with a rounded corner [deg]."""
    beyond = np.abs(torque) - 0.55 * TOP_NM
    return np.asarray(np.sign(torque) * slope * 0.5 * (beyond + np.hypot(beyond, 0.3)))


def names(found: cs.Diagnosis) -> set[str]:
    return {str(effect["name"]) for effect in found.effects}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_small_dial_beside_a_loud_softening_is_no_side_load(seed: int) -> None:
    torque, run = programme()
    curve = softening(torque, 3.0)
    angle = np.sign(torque) * PLAY_DEG + COMPLIANCE * torque + curve
    found = cs.diagnose(recorded(curve + dial(angle, 0.5, 0.93), torque, run, seed), full=False)
    assert names(found) == {"overload_softening", "dial_eccentricity"}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_side_load_beside_a_loud_softening_is_no_dial(seed: int) -> None:
    torque, run = programme()
    extra = softening(torque, 3.0) + 0.3 * np.abs(torque / TOP_NM)
    found = cs.diagnose(recorded(extra, torque, run, seed), full=False)
    assert names(found) == {"overload_softening", "load_asymmetry"}


def test_the_error_of_an_odd_law_is_one_part_of_a_dial_alone() -> None:
    known = {effect.name: effect for effect in effects()}
    shape = {"order": 1.0}
    eccentric = Term(known["dial_eccentricity"], shape)
    odd = Term(known["contact_stiffening"], {"turn_nm": 2.0})
    even = Term(known["load_asymmetry"], {"power": 1.0})
    assert size_of_class(eccentric, [(5.0, odd)]) == 0.0
    assert size_of_class(eccentric, [(5.0, odd), (2.0, even)]) == 2.0
    assert size_of_class(odd, [(5.0, eccentric), (2.0, even)]) == 5.0
    assert size_of_class(odd, [(2.0, even)]) == 0.0
