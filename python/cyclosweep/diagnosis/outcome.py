"""What `cyclosweep.diagnose` returns: the answer, the repaired model, and their files."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cyclosweep.atomic import write_text
from cyclosweep.recording import Recording
from cyclosweep.report import HeldOut, Hypothesis, ReportData, write_report
from cyclosweep.result import Answer, content_of, json_text
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.model import Model


@dataclass(frozen=True, eq=False, kw_only=True)
class Diagnosis:
    """Result of `cyclosweep.diagnose`.

    Attributes
    ----------
    recording : Recording
        What was diagnosed.
    answer : Answer
        Verdict, statement and everything behind them, as one typed value.
    model : Model or None
        Calibrated baseline and accepted effects; `cyclosweep.simulate` takes it.
    before_deg, after_deg : ndarray of float, shape (samples,), or None
        Twist by the calibrated published model and by the repaired one [deg].
    hypotheses : tuple of Hypothesis
        Every effect of the library, accepted or not.
    rated_torque_nm : float or None
        Rated torque at the measured shaft [N m].
    ratio : float or None
        Reduction of the drive.
    provenance : dict of str to str
        Version, seed, drive and the recording's hash.
    """

    recording: Recording
    answer: Answer
    model: Model | None = None
    before_deg: Floats | None = None
    after_deg: Floats | None = None
    hypotheses: tuple[Hypothesis, ...] = ()
    rated_torque_nm: float | None = None
    ratio: float | None = None
    provenance: dict[str, str] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        """One of the six verdicts."""
        return self.answer.verdict

    @property
    def statement(self) -> str:
        """One paragraph an engineer can act on."""
        return self.answer.statement

    @property
    def content(self) -> dict[str, Any]:
        """Content of ``diagnosis.json`` as plain dictionaries and lists."""
        return content_of(self.answer)

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Accepted effects with size, interval and evidence."""
        return list(self.content["effects"])

    @property
    def mismatch(self) -> dict[str, Any]:
        """Global test and regions where recording and simulation differ."""
        return dict(self.content["mismatch"])

    @property
    def held_out(self) -> tuple[HeldOut, ...]:
        """Errors on data that were not used, block by block."""
        return self.report_data().held_out_rows

    def to_json(self) -> str:
        """Return the text of ``diagnosis.json``."""
        return json_text(self.answer)

    def report_data(self) -> ReportData:
        """Everything the report shows."""
        return ReportData(
            recording=self.recording,
            result=self.answer,
            before_deg=self.before_deg,
            after_deg=self.after_deg,
            rated_torque_nm=self.rated_torque_nm,
            ratio=self.ratio,
            compliance_deg_per_nm=None if self.model is None else self.model.compliance_deg_per_nm,
            hypotheses=self.hypotheses,
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

    def write(self, folder: str | Path, *, report: bool = True) -> Path:
        """Write ``diagnosis.json``, ``model.json`` and ``report.html``, each whole or not at all.

        What an earlier diagnosis left in the folder and this one does not write is removed.

        Parameters
        ----------
        folder : path
            Where; made if absent.
        report : bool
            Whether to write the page, too.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        OSError
            A file cannot be written.
        """
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        write_text(target / "diagnosis.json", self.to_json())
        # Not before: where nothing can be written, the earlier answer stays whole.
        for old in [target / "report.html", target / "model.json", *target.glob("pictures/*.png")]:
            old.unlink(missing_ok=True)
        if self.model is not None:
            write_text(target / "model.json", self.model.to_json())
        if report:
            self.report(target / "report.html")
        return target
