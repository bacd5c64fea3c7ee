"""The file of a model: what is written is read, whatever the order, and nothing else is."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.model import EffectValue

COMPLIANCE = 19.8 / 7.2575


def model() -> cs.Model:
    """Model with a shape of every kind of form: by name, numbered, and open in its amplitudes."""
    slip = {"slip_deg": 1.0, "scatter": 0.6, "skew": 0.1, "slack": 0.0}
    return cs.Model(
        compliance_deg_per_nm=COMPLIANCE,
        free_play_deg=28.0,
        effects=(
            EffectValue("friction_hysteresis", slip, (0.5,)),
            EffectValue("transmission_error", {"order_1": 1.0, "order_2": 2.0}, (0.3, -0.2, 0, 1)),
            EffectValue("creep", {"tau_1_s": 5.0, "tau_2_s": 60.0}, (0.05, 0.01)),
            EffectValue("datum_drift", {"free": 1.0}, (0.1, -0.2)),
        ),
        drive="reference-87",
        notes=("One note.",),
    )


def content() -> dict[str, Any]:
    """Decoded file of that model."""
    found: dict[str, Any] = json.loads(model().to_json())
    return found


def read(tmp_path: Path, text: str) -> cs.Model:
    """Read a model from a text."""
    path = tmp_path / "model.json"
    path.write_text(text)
    return cs.Model.from_json(path)


def reverse(value: Any) -> Any:
    """Decoded JSON with the keys of every object in reverse."""
    if isinstance(value, dict):
        return {key: reverse(value[key]) for key in reversed(value)}
    return [reverse(each) for each in value] if isinstance(value, list) else value


def programme() -> cs.Recording:
    """Three runs at three positions with a clock."""
    torque = np.tile(np.r_[np.linspace(0.5, 20, 30), np.linspace(20, -20, 60)], 3)
    return cs.Recording.from_arrays(
        torque,
        time_s=np.arange(270.0),
        run=np.repeat([1, 2, 3], 90),
        crank_deg=np.repeat([0.0, 70.0, 190.0], 90),
    )


@pytest.mark.parametrize("order", ["as written", "sorted", "reversed"])
def test_order_of_keys_does_not_matter(tmp_path: Path, order: str) -> None:
    text = model().to_json()
    if order != "as written":
        text = json.dumps(content(), sort_keys=True) if order == "sorted" else ""
        text = text or json.dumps(reverse(content()))
    again = read(tmp_path, text)
    assert again == model()
    np.testing.assert_array_equal(
        cs.simulate(again, programme()).angle_deg, cs.simulate(model(), programme()).angle_deg
    )


def test_least_file_is_read(tmp_path: Path) -> None:
    base = {"compliance_deg_per_nm": 2, "free_play_deg": 0}
    least = {"schema": "cyclosweep.model/1", "baseline": base}
    assert read(tmp_path, json.dumps(least)) == cs.Model(2.0, 0.0)


def changed(*places: str | int, value: Any) -> str:
    """File of the model with one value changed, or one key added."""
    found: Any = content()
    part = found
    for place in places[:-1]:
        part = part[place]
    part[places[-1]] = value
    return json.dumps(found)


def without(*places: str | int) -> str:
    """File of the model without one key."""
    found: Any = content()
    part = found
    for place in places[:-1]:
        part = part[place]
    del part[places[-1]]
    return json.dumps(found)


REFUSED = {
    "unknown effect": (changed("effects", 1, "name", value="witchcraft"), "witchcraft"),
    "unknown shape parameter": (changed("effects", 0, "shape", "extra", value=1.0), "extra"),
    "missing shape parameter": (without("effects", 0, "shape", "scatter"), "scatter"),
    "gap in a numbered shape": (without("effects", 1, "shape", "order_1"), "order_2"),
    "half of a growth": (changed("effects", 0, "shape", "growth", value=1.0), "reference_nm"),
    "unknown amplitude": (changed("effects", 1, "amplitudes", "sine_1", value=1.0), "sine_1"),
    "missing amplitude": (without("effects", 1, "amplitudes", "sin_2"), "sin_2"),
    "gap in free offsets": (without("effects", 3, "amplitudes", "shift_1_deg"), "shift_1_deg"),
    "no amplitudes": (without("effects", 2, "amplitudes"), "amplitudes"),
    "amplitudes as a list": (changed("effects", 0, "amplitudes", value=[0.5]), "amplitudes"),
    "amplitude as text": (changed("effects", 1, "amplitudes", "cos_1", value="0.5"), "cos_1"),
    "amplitude as truth": (changed("effects", 1, "amplitudes", "cos_1", value=True), "cos_1"),
    "order of a half": (changed("effects", 1, "shape", "order_1", value=1.5), "order_1"),
    "an order twice": (changed("effects", 1, "shape", "order_2", value=1.0), "1 1"),
    "order of nothing": (changed("effects", 1, "shape", "order_2", value=0.0), "order_2"),
    "shape as text": (changed("effects", 1, "shape", "order_1", value="1"), "order_1"),
    "effects as an object": (changed("effects", value={}), "effects"),
    "effect as text": (changed("effects", 0, value="friction_hysteresis"), "effect 1"),
    "no baseline": (without("baseline"), "baseline"),
    "no compliance": (without("baseline", "compliance_deg_per_nm"), "compliance_deg_per_nm"),
    "compliance of zero": (changed("baseline", "compliance_deg_per_nm", value=0), "compliance"),
    "unknown side": (changed("side", value="middle"), "middle"),
    "half a pin": (changed("output_pin_count", value=7.5), "output_pin_count"),
    "a number for a note": (changed("notes", value=[1]), "note"),
    "too large a number": (model().to_json().replace("28.0", "1e999"), "free_play_deg"),
    "not a number": (model().to_json().replace("28.0", "NaN"), "NaN"),
    "a key twice": (model().to_json().replace('"sin_1"', '"cos_1"'), "cos_1"),
    "a list": ("[]", "schema"),
    "another schema": (changed("schema", value="cyclosweep.model/9"), "schema"),
    "no JSON": ("{", "cannot be read"),
}


@pytest.mark.parametrize(
    ("name", "shape", "what"),
    [
        ("clearance_takeup", {"middle_nm": 5.0, "spread": 0.0}, "spread: found 0"),
        ("contact_stiffening", {"knee_nm": -1.0, "decay": 1.5}, "knee_nm: found -1"),
        ("contact_stiffening", {"stop_nm": 3.0}, "stop_nm"),
    ],
)
def test_a_shape_that_has_no_twist_is_refused(
    name: str, shape: dict[str, float], what: str
) -> None:
    with pytest.raises(cs.InputError, match=what):
        EffectValue.from_dict({"name": name, "shape": shape, "amplitudes": {}})


@pytest.mark.parametrize("kind", REFUSED)
def test_what_is_not_known_is_refused_in_one_line(tmp_path: Path, kind: str) -> None:
    text, what = REFUSED[kind]
    with pytest.raises(cs.InputError) as error:
        read(tmp_path, text)
    assert what in str(error.value)
    assert "model.json" in str(error.value)
    assert "\n" not in str(error.value)
