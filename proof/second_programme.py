"""Errors on a second programme of the same specimen, with and without the effect that was named.

    python proof/second_programme.py

makes recordings with the independent generator of the challenge, diagnoses each, predicts the
second programme with `cyclosweep simulate`, and prints the table of docs/proof.md. "Without" is
the calibrated model of a diagnosis that was not allowed the effects.
"""

import tempfile
from pathlib import Path

import numpy as np
import polars as pl

import cyclosweep as cs
from cyclosweep.cli import app
from cyclosweep.recording import Recording
from cyclosweep.simulation.effects import effects as known_effects
from cyclosweep_challenge import make_case

CASES: tuple[tuple[str, ...], ...] = (
    ("friction_hysteresis",),
    ("load_dependent_friction",),
    ("overload_softening",),
    ("contact_stiffening",),
    ("creep",),
    ("viscous_drag",),
    ("transmission_error",),
    ("contact_stiffening", "friction_hysteresis"),
)
EVERY = [effect.name for effect in known_effects()]
SEED = 2000
DETECTABILITY = 40.0


def predicted(folder: Path, model: str) -> np.ndarray:
    """Twist of the second programme by a model, through the command line [deg]."""
    out = folder / "prediction.csv"
    words = ["simulate", str(folder / model), str(folder / "program.csv"), "--out", str(out)]
    app(words, standalone_mode=False)
    return pl.read_csv(out)["angle_deg"].to_numpy()


def row(seed: int, effects: tuple[str, ...]) -> str:
    """Line of the table for one specimen."""
    case = make_case(seed, effects, DETECTABILITY)
    with tempfile.TemporaryDirectory() as scratch:
        folder = case.write(scratch)
        recording = Recording.read(folder / "recording.csv")
        found = cs.diagnose(recording, full=False)
        bare = cs.diagnose(recording, full=False, without=EVERY)
        assert found.model is not None
        assert bare.model is not None
        (folder / "with.json").write_text(found.model.to_json())
        (folder / "without.json").write_text(bare.model.to_json())
        read = case.held_out_read_deg
        errors = [
            float(np.sqrt(np.mean((read - predicted(folder, name)) ** 2)))
            for name in ("with.json", "without.json")
        ]
    floor = float(np.sqrt(np.mean((read - case.held_out_clean_deg) ** 2)))
    named = " + ".join(e["name"].replace("_", " ") for e in found.effects) or "nothing"
    true = " + ".join(name.replace("_", " ") for name in effects)
    return f"| {true} | {named} | {errors[1]:.3f} | {errors[0]:.3f} | {floor:.3f} |"


if __name__ == "__main__":
    print("| in the specimen | named | without (deg) | with (deg) | noise floor (deg) |")
    print("|---|---|---|---|---|")
    for place, effects in enumerate(CASES):
        print(row(SEED + place, effects), flush=True)
