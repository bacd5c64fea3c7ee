"""Folder of a run on measured loops: recordings written, diagnosed, predicted and scored."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray
from rich.console import Console

from cyclosweep_challenge.measured.loops import write_loops
from cyclosweep_challenge.measured.variants import Variant
from cyclosweep_challenge.runner.diagnosing import diagnose_batch, predict_batch, read_diagnosis
from cyclosweep_challenge.runner.work import Options, program_of, work

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """One measured recording, its diagnosis, and whether that is right.

    Attributes
    ----------
    file, kind, detail, size_deg
        As of `Variant`.
    verdict : str
        Verdict of the diagnosis.
    named : tuple of str
        Effects it accepted.
    good : bool or None
        Whether that is right, as far as one can know: for repeated loops, nothing said to be
        missing; for a term removed, that term named; for an injected effect, it named where the
        file as measured does not show it; for several causes confounded, no cause named that
        the recording cannot show, and no verdict that leaves no doubt. None where nobody knows.
    rmse_deg : float
        Error of the repaired model on the readings it was fitted to [deg].
    numbers : dict
        Further figures of this row.
    """

    file: str
    kind: str
    detail: str
    size_deg: float
    verdict: str
    named: tuple[str, ...]
    good: bool | None
    rmse_deg: float
    numbers: dict[str, float] = field(default_factory=dict)


class Bench:
    """Folder of a run on measured loops: writes recordings, diagnoses them and predicts."""

    def __init__(self, out: Path, drive: Path, options: Options, console: Console) -> None:
        self.out, self.drive, self.options, self.console = out, drive, options, console
        self.recordings, self.results = out / "recordings", out / "diagnoses"

    def diagnose(self, variants: Sequence[Variant]) -> None:
        """Write recordings and let the diagnosis see them; what is done is not done again."""
        jobs = []
        for v in variants:
            write_loops(
                v.loops, self.recordings / v.key, self.drive.name, v.conditioning, v.holdout
            )
            if (self.results / v.key / "diagnosis.json").exists():
                continue
            removal = (self.options.removal_flag, v.without) if v.without else ()
            flags = (*self.options.diagnose_flags, *removal)
            some = {v.key: self.recordings / v.key}
            arguments = (some, self.results, flags, self.options.limit_s)
            jobs.append((diagnose_batch, (*arguments, program_of(self.options), self.drive)))
        work(
            "measured loops",
            self.options.workers,
            jobs,
            self.console,
            until=self.options.until,
            processes=False,
        )

    def diagnosis(self, variant: Variant) -> dict[str, Any]:
        """Diagnosis of a variant."""
        return read_diagnosis(self.results, variant.key)

    def named(self, variant: Variant) -> tuple[str, ...]:
        """Effects accepted in a variant."""
        return tuple(str(e.get("name")) for e in self.diagnosis(variant).get("effects") or [])

    def model(self, variant: Variant, only: Sequence[str] | None = None) -> dict[str, Any] | None:
        """Repaired model of a variant, with some of its effects only; None where there is none."""
        file = self.results / variant.key / "model.json"
        if not file.exists():
            return None
        content: dict[str, Any] = json.loads(file.read_text())
        if only is not None:
            content["effects"] = [e for e in content.get("effects", []) if e["name"] in only]
        return content

    def calibrated(self, variant: Variant) -> dict[str, Any] | None:
        """Return the published model with the calibration that the diagnosis began from."""
        content = self.model(variant, ())
        parameters = (self.diagnosis(variant).get("baseline") or {}).get("parameters") or {}
        if content is None or not isinstance(content.get("baseline"), dict):
            return None
        for name in content["baseline"]:
            if name in parameters:
                content["baseline"][name] = parameters[name]["estimate"]
        return content

    def predict(self, asked: Sequence[tuple[str, dict[str, Any] | None, Variant]]) -> list[Array]:
        """Angles by models on the programmes of variants, all in few processes [deg]."""
        folder = self.out / "predictions"
        folder.mkdir(parents=True, exist_ok=True)
        waiting = []
        for name, content, variant in asked:
            if content is not None:
                model = folder / f"{name}.json"
                model.write_text(json.dumps(content))
                programme = self.recordings / variant.key / "program.csv"
                waiting.append((model, programme, folder / f"{name}.csv"))
        predict_batch(waiting, self.options.limit_s, self.options.program)
        angles = []
        for name, _, variant in asked:
            file = folder / f"{name}.csv"
            count = variant.loops.torque_nm.size
            angle = np.full(count, np.nan)
            if file.exists():
                read = pl.read_csv(file)["angle_deg"].cast(pl.Float64).to_numpy()
                angle = read if read.size == count else angle
            angles.append(angle)
        return angles

    def row(self, variant: Variant, good: bool | None, **numbers: float) -> Row:
        """Row of the result table for one variant."""
        diagnosis = self.diagnosis(variant)
        rmse = (diagnosis.get("repaired") or {}).get("rmse_deg")
        return Row(
            variant.file,
            variant.kind,
            variant.detail,
            variant.size_deg,
            str(diagnosis.get("verdict", "FAILURE")),
            self.named(variant),
            good,
            float(rmse) if isinstance(rmse, (int, float)) else math.nan,
            numbers,
        )
