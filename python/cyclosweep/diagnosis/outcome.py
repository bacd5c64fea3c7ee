"""What `cyclosweep.diagnose` returns: the answer, the repaired model, and their files."""

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cyclosweep.atomic import write_text
from cyclosweep.design.json_files import JsonSource, json_object, name_of
from cyclosweep.errors import InputError
from cyclosweep.notebook import html_table
from cyclosweep.recording import Recording
from cyclosweep.report import HeldOut, ReportData, write_report
from cyclosweep.result import Answer, Hypothesis, Size, Verdict, answer_of, content_of, json_text
from cyclosweep.result.content import EffectContent, MismatchContent
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.model import Model

_NOT_READ = "recording not read"
"""Name of the empty recording of a diagnosis that was read without one."""


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
        Twist by the calibrated published model and by the repaired one [deg]. Where whole loops
        were not simulated, each reading of the former lies on the flank that the recording shows;
        `cyclosweep.simulate` has to find the flank, and may cross the play elsewhere.
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
    def verdict(self) -> Verdict:
        """What the diagnosis concludes, one of `cyclosweep.result.Verdict`."""
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
    def effects(self) -> list[EffectContent]:
        """Accepted effects with size, interval and evidence; `answer.effects` has attributes."""
        return list(self.content["effects"])

    @property
    def mismatch(self) -> MismatchContent:
        """Global test and regions where recording and simulation differ."""
        found: MismatchContent = self.content["mismatch"]
        return found

    @property
    def held_out(self) -> tuple[HeldOut, ...]:
        """Errors on data that were not used, block by block."""
        return self.report_data().held_out_rows

    def to_json(self) -> str:
        """Return the text of ``diagnosis.json``."""
        return json_text(self.answer)

    @classmethod
    def from_json(
        cls,
        source: JsonSource,
        recording: Recording | None = None,
        model: Model | None = None,
    ) -> "Diagnosis":
        """Read ``diagnosis.json``, or what :meth:`to_json` returned.

        Parameters
        ----------
        source : str, Path or mapping
            The file, its text, or its decoded content.
        recording : Recording, optional
            What was diagnosed; without it there is no report.
        model : Model, optional
            The repaired model, by default ``model.json`` where the file names it and it lies
            beside.

        Returns
        -------
        Diagnosis
            With its answer; the hypotheses and the simulated twists are not in the file.

        Raises
        ------
        InputError
            It is no answer of a diagnosis; one line says which key.
        """
        try:
            answer = answer_of(json_object(source))
        except InputError as error:
            raise InputError(f"{name_of(source)}: {error}") from error
        if model is None and answer.model is not None and name_of(source) == str(source):
            beside = Path(str(source)).parent / answer.model
            model = Model.from_json(beside) if beside.exists() else None
        if recording is None:
            recording = Recording.from_arrays([], name=_NOT_READ)
        return cls(recording=recording, answer=answer, model=model)

    def __repr__(self) -> str:
        found = ", ".join(f"{e.name} {_sized(e.size_deg)}" for e in self.answer.effects)
        error = _before_and_after(self.answer)
        parts = "; ".join(part for part in (found, error and f"error {error}") if part)
        return f"<Diagnosis of {self.recording.name}: {self.verdict}{parts and f', {parts}'}>"

    def _repr_html_(self) -> str:
        sigma = self.answer.noise.sigma_deg
        rows: dict[str, object] = {"recording": self.recording.name}
        rows |= {effect.name: _sized(effect.size_deg) for effect in self.answer.effects}
        rows |= {
            "error, published to repaired model": _before_and_after(self.answer),
            "noise": None if sigma is None else f"{sigma:.3g} deg",
            "not testable": ", ".join(each.name for each in self.answer.not_testable),
        }
        return html_table(f"Diagnosis: {self.verdict}", rows, self.statement)

    def report_data(self) -> ReportData:
        """Everything the report shows."""
        return ReportData(
            recording=self.recording,
            result=self.answer,
            before_deg=self.before_deg,
            after_deg=self.after_deg,
            rated_torque_nm=self.rated_torque_nm,
            ratio=self.ratio,
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
            The name has another ending, or the diagnosis was read without its recording.
        """
        if self.recording.name == _NOT_READ:
            raise InputError(
                "report: no recording, expected Diagnosis.from_json(file, recording=...)"
            )
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
        pictures = list(target.glob("pictures/*.png"))
        for old in [target / "report.html", target / "model.json", *pictures]:
            old.unlink(missing_ok=True)
        if pictures:
            with suppress(OSError):  # other files may stand there
                (target / "pictures").rmdir()
        if self.model is not None:
            write_text(target / "model.json", self.model.to_json())
        if report:
            self.report(target / "report.html")
        return target


def _sized(size: Size) -> str:
    """Size of an effect with its interval, in words."""
    low, high = size.ci95
    return f"{size.estimate:.3g} deg [{low:.3g}, {high:.3g}]"


def _before_and_after(answer: Answer) -> str:
    """Errors of the published and the repaired model, in words; empty where there is none."""
    before, after = answer.baseline.rmse_deg, answer.repaired.rmse_deg
    if before is None:
        return ""
    return f"{before:.3g} deg" if after is None else f"{before:.3g} to {after:.3g} deg"
