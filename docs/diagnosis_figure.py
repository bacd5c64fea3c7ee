"""Draw the picture of docs/diagnosis.md: what a fitted law leaves of loops, and the noise."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

import cyclosweep as cs
from cyclosweep.figures.style import save
from cyclosweep_challenge.scoreboard.made_rig import Friction
from cyclosweep_challenge.scoreboard.turned_rig import TurnedLoops, turned

mpl.use("Agg")
from matplotlib import pyplot as plt

FILE = Path(__file__).parent / "pictures" / "model-error.png"
DPI = 120
LOOPS, READINGS, TOP_NM = 3, 600, 30.0
"""Loops of the programme, readings of each, and the torque at their ends [N m]."""
NOISE_DEG = 0.001
FRICTION = Friction("bouc-wen", presliding_deg=8.0, constant_nm=2.0)


def main() -> None:
    """Diagnose the loops, and draw loop and remainder."""
    tops = (TOP_NM,) * LOOPS
    recording = turned(TurnedLoops(1, tops, READINGS, NOISE_DEG, friction=FRICTION))
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    print(found.verdict, [effect.name for effect in found.answer.effects], found.answer.explained)
    assert found.model is not None
    assert recording.angle_deg is not None
    predicted = cs.simulate(found.model, recording).angle_deg
    assert predicted is not None
    left = recording.angle_deg - predicted
    figure, (loop, rest) = plt.subplots(1, 2, figsize=(9.0, 3.4), layout="constrained")
    loop.plot(recording.torque_nm, recording.angle_deg, ".", markersize=2, label="measured")
    baseline = cs.Model.of_drive(cs.Drive.reference_87())
    torque = np.array([-TOP_NM, -1e-9, 1e-9, TOP_NM])
    line = np.sign(torque) * baseline.free_play_deg + baseline.compliance_deg_per_nm * torque
    loop.plot(torque, line, color="black", linewidth=0.8, label="line")
    loop.set(xlabel="torque [N m]", ylabel="twist [deg]")
    loop.legend()
    left[np.abs(recording.angle_deg) < found.model.free_play_deg + 1.0] = np.nan
    for number, part in enumerate(np.split(left, LOOPS), 1):
        rest.plot(np.arange(READINGS), part, ".", markersize=3, label=f"loop {number}")
    rest.axhspan(-2 * NOISE_DEG, 2 * NOISE_DEG, color="0.85", label="noise, 95 %")
    rest.set(xlabel="reading within the loop", ylabel="left by the fitted friction [deg]")
    rest.legend(ncols=2)
    save(figure, FILE, dpi=DPI)


if __name__ == "__main__":
    main()
