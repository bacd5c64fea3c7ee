"""Effects of a user's own: registering one is all it takes to have it found and predicted with."""

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation import effects
from cyclosweep.simulation.effects import Effect, History, Parameter, Shape
from cyclosweep.simulation.effects.slip import FrictionEffect
from cyclosweep.simulation.effects.slip_elements import Elements
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import Floats

COMPLIANCE = 19.8 / 7.2575


class LipSeal(FrictionEffect):
    """A lip that rolls before it slides: two presliding distances, and a limit that grows."""

    name = "lip_seal"
    physics = "The lip of a seal rolls before it slides. Pressure from the load adds to its grip."
    source = "made up for a test"
    tell_tale = "two corners after each reversal"
    shape_parameters = (Parameter("rolling_deg", "deg", "distance of rolling", 1e-3, 10.0, True),)
    forms = ()

    def shapes(self, history: History) -> Sequence[Shape]:
        """Distances of rolling from a hundredth of the twist on."""
        twist = history.largest_twist_deg
        return [{"rolling_deg": share * twist} for share in (0.003, 0.01, 0.03)]

    def slip_elements(self, shape: Shape) -> Elements:
        """Half the lip slides after rolling, half thirty times later."""
        rolling = float(shape["rolling_deg"])
        return Elements(np.array([rolling, 30.0 * rolling]), np.array([0.5, 0.5]))

    def friction_limits(self, shape: Shape) -> tuple[float, float]:
        """A twentieth more a newton metre."""
        return 1.0, 0.05

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Torque without load."""
        return (Parameter("lip_torque_nm", "N m", "friction of the lip without load", 0.0),)


class SpringWasher(Effect):
    """Washers that give way between two loads, where they are neither seated nor flat."""

    name = "spring_washer"
    physics = "Spring washers give way once their preload is passed. They are flat at twice that."
    source = "made up for a test"
    tell_tale = "soft between two loads"
    family = "smooth odd curve"
    elastic = True
    shape_parameters = (Parameter("preload_nm", "N m", "load that unseats the washers", 0.0, 1e3),)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Preloads up to half of the largest load."""
        return [{"preload_nm": s * history.largest_torque_nm} for s in (0.1, 0.2, 0.3, 0.4, 0.5)]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist between the preload and twice that, for a unit of compliance [deg]."""
        preload = float(shape["preload_nm"])
        return (history.side * np.clip(history.load_nm - preload, 0.0, preload))[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Compliance of the washers."""
        return (Parameter("washer_compliance", "deg/(N m)", "compliance of the washers", 0.0),)


class FiveTeeth(Effect):
    """An encoder belt of five teeth a turn, which reads ahead and late as each tooth passes."""

    name = "five_teeth"
    physics = "A belt with five teeth a turn drives the encoder. Each tooth leads and lags."
    source = "made up for a test"
    tell_tale = "offset with five periods a turn of the crank"
    family = "run offsets"
    needs = ("crank_deg",)

    def shapes(self, history: History) -> Sequence[Shape]:
        """One shape."""
        return [{}]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Offset for unit amplitudes [deg]."""
        assert history.crank_deg is not None
        angle = 5.0 * np.radians(history.crank_deg)
        return np.column_stack([np.cos(angle), np.sin(angle)])

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Both waves."""
        return (
            Parameter("leads_deg", "deg", "in phase with the crank"),
            Parameter("lags_deg", "deg", "a quarter of a period late"),
        )


OWN = (
    EffectValue("lip_seal", {"rolling_deg": 0.6}, (0.3,)),
    EffectValue("spring_washer", {"preload_nm": 7.0}, (0.15,)),
    EffectValue("five_teeth", {}, (0.5, -0.3)),
)


@pytest.fixture(autouse=True)
def registered() -> Iterator[None]:
    """Register the three for one test."""
    for effect in (LipSeal(), SpringWasher(), FiveTeeth()):
        effects.register(effect)
    yield
    for value in OWN:
        effects._REGISTERED.pop(value.name)


def model(value: EffectValue) -> cs.Model:
    """Drive with one effect."""
    return cs.Model(COMPLIANCE, 28.0, effects=(value,))


def programme(seed: int) -> cs.Recording:
    """Nested loops at twelve positions of the mesh."""
    rng = np.random.default_rng(seed)
    parts = []
    for top in rng.permutation(np.repeat([8.0, 16.0, 24.0], 4)):
        ends = (0.4, top, -top, 0.5 * top, -0.3 * top, 0.8 * top, 0.4)
        parts.append(np.concatenate([np.linspace(a, b, 40) for a, b in itertools.pairwise(ends)]))
    torque = np.concatenate(parts)
    count = len(parts[0])
    run = np.repeat(np.arange(1, 13), count)
    crank = np.repeat(rng.uniform(0.0, 360.0, 12), count)
    return cs.Recording.from_arrays(
        torque, run=run, crank_deg=crank, time_s=np.arange(len(torque)) * 1.0
    )


@pytest.mark.parametrize("value", OWN, ids=lambda value: value.name)
def test_effect_of_a_user_is_found(value: EffectValue, tmp_path: Path) -> None:
    load = programme(3)
    truth = cs.simulate(model(value), load)
    assert truth.angle_deg is not None
    noise = 0.5 * np.random.default_rng(4).standard_normal(len(load))
    found = cs.diagnose(load.with_angle(truth.angle_deg + noise), cs.Drive.reference_87())
    assert found.verdict == "IDENTIFIED"
    assert [effect["name"] for effect in found.effects] == [value.name]
    assert found.model is not None

    path = tmp_path / "model.json"
    path.write_text(found.model.to_json())
    again = cs.Model.from_json(path)
    assert again == found.model
    other = programme(9)
    predicted, expected = cs.simulate(again, other), cs.simulate(model(value), other)
    assert predicted.angle_deg is not None
    assert expected.angle_deg is not None
    plain = cs.simulate(cs.Model(COMPLIANCE, 28.0), other).angle_deg
    assert plain is not None
    clear = np.abs(other.torque_nm) > 2.0
    error = np.std((predicted.angle_deg - expected.angle_deg)[clear])
    assert error < 0.1 * np.std((plain - expected.angle_deg)[clear])


def test_torque_of_a_users_friction_is_the_inverse_of_its_twist() -> None:
    load = programme(3)
    there = cs.simulate(model(OWN[0]), load)
    back = cs.simulate(model(OWN[0]), there, predict="torque")
    clear = np.abs(load.torque_nm) > 2.0
    assert np.quantile(np.abs(back.torque_nm - load.torque_nm)[clear], 0.95) < 0.05


def test_friction_of_a_user_widens_the_loop_by_its_own_limit() -> None:
    ends = (0.0, 24.0, -24.0, 24.0)
    torque = np.concatenate([np.linspace(a, b, 200) for a, b in itertools.pairwise(ends)])
    seal = EffectValue("lip_seal", {"rolling_deg": 0.1}, (0.8,))
    angle = cs.simulate(model(seal), cs.Recording.from_arrays(torque)).angle_deg
    assert angle is not None
    up = float(np.interp(10.0, torque[400:], angle[400:]))
    down = float(np.interp(-10.0, -torque[200:400], angle[200:400]))
    # The elastic torque T_e of either branch holds T = T_e +- Y (1 + 0.05 T_e).
    y = 0.8
    expected = COMPLIANCE * ((10 + y) / (1 - 0.05 * y) - (10 - y) / (1 + 0.05 * y))
    assert down - up == pytest.approx(expected, rel=1e-2)


def test_old_path_registers_too() -> None:
    class Another(FiveTeeth):
        name = "another_of_a_test"

    with pytest.warns(DeprecationWarning, match="cyclosweep.simulation.effects"):
        from cyclosweep.effects import find, register
    try:
        register(cast("Any", Another()))
        assert cast("Any", find("another_of_a_test")) in effects.effects()
    finally:
        effects._REGISTERED.pop("another_of_a_test", None)


def test_methods_by_their_former_names_still_work() -> None:
    with pytest.warns(DeprecationWarning, match="caution is now penalty"):

        class Old(FiveTeeth):
            name = "old_names_of_a_test"

            def caution(self, shape: Shape) -> float:
                return 3.0

    assert Old().penalty({}) == 3.0
    with pytest.warns(DeprecationWarning, match="settled is now consistent"):
        settled = getattr(effects.find("creep"), "settled")  # noqa: B009
    assert settled == effects.find("creep").consistent
