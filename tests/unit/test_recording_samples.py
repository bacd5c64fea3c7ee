"""Samples: plain arrays, checked for shape, read-only, the part that checks and structure need."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import cyclosweep as cs
from cyclosweep.recording.checks import find_faults
from cyclosweep.recording.samples import Samples
from cyclosweep.recording.structure import find_structure

TORQUE = np.r_[np.linspace(0.5, 20, 40), np.linspace(20, 0.5, 40)]


def loop() -> Samples:
    return Samples(torque_nm=TORQUE, angle_deg=28 + 2.73 * TORQUE, run=np.ones(80, dtype=np.int64))


def test_structure_and_faults_need_no_more_than_samples() -> None:
    samples = loop()
    assert [branch.direction for branch in find_structure(samples).branches] == [
        "loading",
        "unloading",
    ]
    assert find_faults(samples) == ()
    absent = find_faults(samples, holdout_runs=(7,))
    assert [(fault.kind, fault.verdict) for fault in absent] == [("run_absent", None)]
    assert "holdout_runs names run 7" in absent[0].reason


def test_arrays_are_copied_and_read_only() -> None:
    torque = TORQUE.copy()
    samples = Samples(torque_nm=torque, run=np.ones(80, dtype=np.int64))
    torque[0] = 99.0
    assert samples.torque_nm[0] == 0.5
    with pytest.raises(ValueError, match="read-only"):
        samples.torque_nm[0] = 1.0


@pytest.mark.parametrize("run", [np.ones(79, dtype=np.int64), np.ones((80, 1), dtype=np.int64)])
def test_a_column_of_another_shape_is_refused(run: npt.NDArray[np.int64]) -> None:
    with pytest.raises(ValueError, match=r"run: found shape .*, expected \(80,\)"):
        Samples(torque_nm=TORQUE, run=run)


def test_the_frame_holds_what_was_recorded() -> None:
    assert loop().to_frame().columns == ["torque_nm", "angle_deg", "run"]


@pytest.mark.parametrize("name", ["torque_nm", "angle_deg", "time_s", "run"])
def test_complex_numbers_are_refused(name: str) -> None:
    arrays: dict[str, Any] = {
        key: np.arange(9.0) for key in ("torque_nm", "angle_deg", "time_s", "run")
    }
    for wrong in (arrays[name] + 1j, list(arrays[name] + 0j)):
        with pytest.raises(cs.InputError, match=f"{name}: found complex numbers, expected real"):
            cs.Recording.from_arrays(**{**arrays, name: wrong})
        with pytest.raises(cs.InputError, match=f"{name}: found complex numbers, expected real"):
            cs.Recording(name="r", **{**arrays, name: np.asarray(wrong)})
