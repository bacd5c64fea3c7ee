"""What a diagnosis returns: verdict, tables, repaired model, and their files."""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.recording import Recording
from cyclosweep.report import HeldOut, Hypothesis, ReportData, write_report
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.simulate import Model

SCHEMA = "cyclosweep.diagnosis/1"


@dataclass(frozen=True, eq=False, kw_only=True)
class Diagnosis:
    """Result of `cyclosweep.diagnose`.

    Attributes
    ----------
    recording : Recording
        What was diagnosed.
    content : dict
        Content of ``diagnosis.json``.
    model : Model or None
        Calibrated baseline and accepted effects; `cyclosweep.simulation.simulate` takes it.
    before_deg, after_deg : ndarray or None
        Twist by the calibrated published model and by the repaired one, a value a sample [deg].
    """

    recording: Recording
    content: dict[str, Any]
    model: Model | None = None
    before_deg: Floats | None = None
    after_deg: Floats | None = None
    hypotheses: tuple[Hypothesis, ...] = ()
    held_out: tuple[HeldOut, ...] = ()
    rated_torque_nm: float | None = None
    ratio: float | None = None
    provenance: dict[str, str] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        """One of the six verdicts."""
        return str(self.content["verdict"])

    @property
    def statement(self) -> str:
        """One paragraph an engineer can act on."""
        return str(self.content["statement"])

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Accepted effects with size, interval and evidence."""
        return list(self.content["effects"])

    @property
    def mismatch(self) -> dict[str, Any]:
        """Global test and regions where recording and simulation differ."""
        return dict(self.content["mismatch"])

    def to_json(self) -> str:
        """Return the content of ``diagnosis.json``."""
        return json.dumps(plain(self.content), indent=1, ensure_ascii=False, allow_nan=False)

    def report_data(self) -> ReportData:
        """Everything the report shows."""
        return ReportData(
            recording=self.recording,
            result=plain(self.content),
            before_deg=self.before_deg,
            after_deg=self.after_deg,
            rated_torque_nm=self.rated_torque_nm,
            ratio=self.ratio,
            compliance_deg_per_nm=None if self.model is None else self.model.compliance_deg_per_nm,
            hypotheses=self.hypotheses,
            held_out=self.held_out,
            provenance=self.provenance,
        )

    def report(self, path: str | Path) -> Path:
        """Write the report in the form that the name asks for.

        Parameters
        ----------
        path : path
            ``*.html``: one page, readable offline; ``*.png``: its main picture; a name without an
            ending: a folder of all pictures.

        Returns
        -------
        Path
            What was written.

        Raises
        ------
        InputError
            The name has another ending.
        """
        return write_report(self.report_data(), path)

    def write(self, folder: str | Path) -> Path:
        """Write ``diagnosis.json``, ``model.json`` and ``report.html`` into a folder."""
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        (target / "diagnosis.json").write_text(self.to_json(), encoding="utf-8")
        if self.model is not None:
            (target / "model.json").write_text(self.model.to_json(), encoding="utf-8")
        self.report(target / "report.html")
        return target


def plain(value: Any) -> Any:
    """Turn numpy values, tuples and non-finite numbers into what JSON has."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        number = float(value)
        return number if math.isfinite(number) else None
    return value
