"""A compliance that pulsates or warms up multiplies the twist of all elastic parts."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import present

C, PLAY, TOP = 2.7, 28.0, 20.0
PULSATION = EffectValue("phase_dependent_compliance", {"order_1": 1.0}, (0.15 * C, 0.0))
WARMS = EffectValue("thermal_drift", {"compliance": 1.0}, (0.01 * C,))
BENT = (
    EffectValue("overload_softening", {"onset_nm": 8.0, "power": 2.0}, (0.8,)),
    EffectValue("load_asymmetry", {"power": 1.0}, (3.0,)),
)


def loops(positions: int = 8) -> cs.Recording:
    """One loop at each of a few locking positions, warming up from one to the next."""
    one = TOP * np.concatenate(
        [np.linspace(0, 1, 40), np.linspace(1, -1, 80), np.linspace(-1, 0, 40)]
    )
    run = np.repeat(np.arange(positions), len(one))
    return cs.Recording.from_arrays(
        np.tile(one, positions),
        run=run,
        crank_deg=run * 360.0 / positions,
        temperature_c=20.0 + run,
        time_s=1.0 * np.arange(len(run)),
    )


def twist_of(*effects: EffectValue) -> Floats:
    model = cs.Model(compliance_deg_per_nm=C, free_play_deg=PLAY, effects=effects)
    recording = loops()
    angle = present(cs.simulate(model, recording).angle_deg)
    return np.asarray((angle - PLAY * np.sign(recording.torque_nm))[recording.torque_nm != 0])


def read_back(path: Path, value: EffectValue) -> cs.Model:
    """Model with one effect, written to a file and read again."""
    model = cs.Model(compliance_deg_per_nm=C, free_play_deg=PLAY, effects=(value,))
    path.write_text(model.to_json())
    return cs.Model.from_json(path)


@pytest.mark.parametrize("of_compliance", [PULSATION, WARMS], ids=lambda v: v.name)
def test_it_multiplies_softening_and_side_load(of_compliance: EffectValue) -> None:
    recording = loops()
    loaded = recording.torque_nm != 0
    position = np.radians(present(recording.crank_deg)[loaded])
    share = 0.15 * np.cos(position)
    if of_compliance is WARMS:
        share = 0.01 * (present(recording.temperature_c)[loaded] - 20.0)
    still = twist_of(*BENT)
    np.testing.assert_allclose(twist_of(*BENT, of_compliance), still * (1 + share), rtol=2e-3)
    # The line alone is multiplied exactly, and no effect is none.
    line = twist_of()
    np.testing.assert_allclose(twist_of(of_compliance), line * (1 + share), rtol=1e-12)


def test_torque_and_angle_are_inverse() -> None:
    model = cs.Model(compliance_deg_per_nm=C, free_play_deg=PLAY, effects=(*BENT, PULSATION, WARMS))
    there = cs.simulate(model, loops())
    back = cs.simulate(model, there, predict="torque")
    loaded = np.abs(there.torque_nm) > 0.1
    np.testing.assert_allclose(back.torque_nm[loaded], there.torque_nm[loaded], rtol=2e-3)


@pytest.mark.parametrize("share", [-0.9, 0.6, 0.9])
def test_the_torque_settles_where_nearly_all_compliance_pulsates(share: float) -> None:
    """It was off by two newton metres in fourteen."""
    pulsation = EffectValue("phase_dependent_compliance", {"order_1": 1.0}, (share * C, 0.0))
    model = cs.Model(compliance_deg_per_nm=C, free_play_deg=PLAY, effects=(pulsation,))
    there = cs.simulate(model, loops())
    back = cs.simulate(model, there, predict="torque")
    np.testing.assert_allclose(back.torque_nm, there.torque_nm, atol=1e-6 * TOP)


def test_what_pulsates_with_a_bent_law_is_not_split() -> None:
    """The twist of a stiffening and a soft flank pulsates, too: no error of the transmission."""
    load = loops()
    torque, crank = load.torque_nm, np.radians(present(load.crank_deg))
    share = np.abs(torque) / TOP
    elastic = C * torque + np.sign(torque) * 0.1 * C * TOP * np.log1p(share / 0.1) / np.log(11.0)
    elastic += np.where(torque > 0, 0.12 * C * torque, 0.0)
    pulsates = 1.0 + 0.12 * np.cos(crank + 0.8) + 0.05 * np.cos(2.0 * crank - 0.4)
    noise = 0.01 * np.random.default_rng(9).normal(size=len(torque))
    angle = PLAY * np.sign(torque) + elastic * pulsates + noise
    found = cs.diagnose(load.with_angle(angle), cs.Drive.reference_87(), full=False)
    names = {effect["name"] for effect in found.effects}
    assert names == {"phase_dependent_compliance", "contact_stiffening", "load_asymmetry"}


def test_contacts_that_pulsate_alone_grow_with_another_power() -> None:
    """A pulsation after Hertz is the power 2/3 of the load."""
    load = loops()
    torque, crank = load.torque_nm, np.radians(present(load.crank_deg))
    contacts = 0.2 * C * TOP * np.sign(torque) * np.abs(torque / TOP) ** (2 / 3)
    noise = 0.02 * np.random.default_rng(2).normal(size=len(torque))
    angle = PLAY * np.sign(torque) + C * torque + contacts * np.cos(crank - 1.0) + noise
    found = cs.diagnose(load.with_angle(angle), cs.Drive.reference_87(), full=False)
    assert found.model is not None
    (effect,) = found.effects
    assert effect["name"] == "phase_dependent_compliance"
    (value,) = found.model.effects
    assert value.shape["load_power"] == pytest.approx(2 / 3, abs=0.03)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_torque_of_a_twist_where_contacts_alone_pulsate(sign: float) -> None:
    """Near no load, too, where the slope of a bare power is infinite."""
    shape = {"load_power": 2 / 3, "reference_nm": TOP, "order_1": 1.0}
    value = EffectValue("phase_dependent_compliance", shape, (sign * 0.2 * C, 0.0))
    model = cs.Model(compliance_deg_per_nm=C, free_play_deg=PLAY, effects=(value,))
    torque = np.r_[-np.geomspace(20.0, 0.02, 40), np.geomspace(0.02, 20.0, 40)]
    load = cs.Recording.from_arrays(torque, crank_deg=np.zeros(80))
    there = cs.simulate(model, load)
    assert np.all(np.diff(present(there.angle_deg)) > 0.0)
    back = cs.simulate(model, there, predict="torque").torque_nm
    np.testing.assert_allclose(back, torque, rtol=1e-3, atol=1e-4)


def test_a_part_in_series_with_friction_is_left_out_with_and_without_it() -> None:
    """Friction that is next to nothing changed the twist by a twentieth."""
    series = EffectValue("load_asymmetry", {"power": 1.0}, (9.0,), in_series=True)
    slide = {"slip_deg": 0.2, "scatter": 0.3, "slack": 0.0}
    friction = EffectValue("friction_hysteresis", slide, (1e-6,))
    without, beside = twist_of(series, PULSATION), twist_of(series, PULSATION, friction)
    np.testing.assert_allclose(without, beside, atol=1e-3)


def test_a_delay_needs_a_clock() -> None:
    value = EffectValue("thermal_drift", {"gradient": 1.0, "delay_s": 5.0}, (0.01,))
    model = cs.Model(compliance_deg_per_nm=C, free_play_deg=PLAY, effects=(value,))
    load = cs.Recording.from_arrays([1.0, 2.0], temperature_c=[20.0, 21.0])
    with pytest.raises(cs.InputError, match="time_s"):
        cs.simulate(model, load)


@pytest.mark.parametrize("orders", [{"order": 0.0}, {"order": 2.0, "order_2": 2.0}])
def test_a_dial_errs_once_or_twice_a_turn(tmp_path: Path, orders: dict[str, float]) -> None:
    value = EffectValue("dial_eccentricity", orders, (0.1, 0.0, 0.1, 0.0)[: 2 * len(orders)])
    with pytest.raises(cs.InputError, match="expected 1, or 2, or 1 and 2"):
        read_back(tmp_path / "model.json", value)


@pytest.mark.parametrize(
    ("shape", "what"),
    [
        ({"load_power": 0.7}, "reference_nm"),
        ({"reference_nm": 5.0}, "load_power"),
        ({"load_power": 0.7, "reference_nm": 0.0}, "above zero"),
        ({"load_power": 0.7, "reference_nm": 1e-320}, "above zero"),
        ({"load_power": -1.0, "reference_nm": 5.0}, "expected 0.3 to 1"),
    ],
)
def test_a_power_needs_its_reference(tmp_path: Path, shape: dict[str, float], what: str) -> None:
    value = EffectValue("phase_dependent_compliance", {**shape, "order_1": 1.0}, (0.1, 0.0))
    with pytest.raises(cs.InputError, match=what):
        read_back(tmp_path / "model.json", value)


def test_datum_that_follows_a_difference_of_temperatures(tmp_path: Path) -> None:
    """A disc that has warmed up within a housing that has not: the datum goes and comes back."""
    load = loops(12)
    time = present(load.time_s)
    warm = 30.0 * (1.0 - np.exp(-time / 300.0)) * (1.0 + 0.3 * np.sin(time / 100.0))
    load = cs.Recording.from_arrays(
        load.torque_nm, run=load.run, time_s=time, temperature_c=20.0 + warm
    )
    late = np.zeros(len(time))
    for k in range(1, len(time)):
        late[k] = warm[k] + (late[k - 1] - warm[k]) * np.exp(-(time[k] - time[k - 1]) / 90.0)
    noise = 0.01 * np.random.default_rng(5).normal(size=len(time))
    angle = PLAY * np.sign(load.torque_nm) + C * load.torque_nm + 0.05 * (warm - late) + noise
    found = cs.diagnose(load.with_angle(angle), cs.Drive.reference_87(), full=False)
    assert found.model is not None
    assert [effect["name"] for effect in found.effects] == ["thermal_drift"]
    (value,) = found.model.effects
    assert value.shape["delay_s"] == pytest.approx(90.0, rel=0.1)
    assert value.amplitudes[-1] == pytest.approx(0.05, rel=0.1)
    assert read_back(tmp_path / "model.json", value).effects == (value,)
    names = [p.name for p in find("thermal_drift").amplitudes(value.shape)]
    assert names == ["gradient_per_k"]
