"""The report as one HTML page that needs nothing else: no network, no library, no other file."""

from collections.abc import Iterable
from html import escape
from importlib.resources import files
from pathlib import Path

from cyclosweep.atomic import write_text
from cyclosweep.page import bullets, definitions, document, paragraph, section, table_html
from cyclosweep.recording.unbroken_runs import ONE_HISTORY
from cyclosweep.report import sentences, tables
from cyclosweep.report.data import ReportData
from cyclosweep.report.figures import all_figures
from cyclosweep.report.summary import LEADS, do_now, summary_of
from cyclosweep.report.svg import figure_svg
from cyclosweep.report.wording import number, probability, verdict_words
from cyclosweep.result import NoiseEstimate, Thinning


def write_html(data: ReportData, path: str | Path) -> Path:
    """Write the report.

    Parameters
    ----------
    data : ReportData
        What to report.
    path : path
        File to write; it appears whole or not at all.

    Returns
    -------
    Path
        The file.
    """
    path = Path(path)
    write_text(path, page(data))
    return path


def page(data: ReportData) -> str:
    """Whole page."""
    figures = {figure.key: figure for figure in all_figures(data)}

    def picture(key: str) -> str:
        figure = figures.get(key)
        if figure is None:
            return ""
        caption = f"<figcaption>{escape(figure.caption)}</figcaption>"
        return f"<figure>{figure_svg(figure)}{caption}</figure>"

    body = "".join(
        [
            _top(data),
            _verdict(data),
            picture("loop"),
            _play(data),
            _effects(data),
            _beside(
                paragraph("What remains without a name", sentences.unknown(data)),
                paragraph("Next experiment", sentences.next_experiment(data)),
            ),
            _beside(
                bullets("What the loop shows", sentences.findings(data)),
                bullets("Where simulation and recording differ", sentences.regions(data)),
            ),
            _loop(data, picture("zoom")),
            section("Residuals", picture("profiles")),
            section("Residual map", picture("map")),
            section("Parameters", table_html(tables.parameter_table(data))),
            section("Every effect that was tried", table_html(tables.hypothesis_table(data))),
            _beside(
                bullets(sentences.explanations_heading(data), sentences.explanations(data)),
                bullets("Possible, with 95 % upper bounds", sentences.possible(data)),
                bullets("Not found, with 95 % upper bounds", sentences.bounds(data)),
                bullets("What this recording cannot show", sentences.untestable(data)),
            ),
            section("Errors on data not used", table_html(tables.held_out_table(data))),
            section("Self-check", table_html(tables.self_check_table(data))),
            paragraph("The answer in full", data.result.statement),
            _recording(data),
            _provenance(data),
        ]
    )
    script = files("cyclosweep.report").joinpath("script.js").read_text(encoding="utf-8")
    return document(f"{data.recording.name}: torque–twist diagnosis", body, script=script)


def _top(data: ReportData) -> str:
    """Name of the recording and what it is."""
    recording = data.recording
    drive = recording.drive or ""
    about = [
        Path(drive).name if drive else "",
        f"{recording.side} shaft",
        f"{len(recording):,} samples".replace(",", " "),
        f"{len(recording.runs)} run{'s' if len(recording.runs) != 1 else ''}",
    ]
    return (
        f'<header class="top"><h1>{escape(recording.name)}</h1>'
        f'<div class="meta">Torque–twist diagnosis<br>{escape(" · ".join(filter(None, about)))}'
        "</div></header>"
    )


def _verdict(data: ReportData) -> str:
    """Verdict line with its evidence."""
    code, words, tone = verdict_words(data.result)
    figures = "".join(
        f'<div class="figure-value"><b>{escape(value)}</b><span>{escape(label)}</span>'
        f"<span>{escape(remark)}</span></div>"
        for value, label, remark in sentences.headline(data)
    )
    evidence = []
    if data.result.mismatch.p_value is not None:
        p = probability(data.result.mismatch.p_value)
        evidence.append(f"mismatch of the calibrated model: p {p}")
    if data.result.sufficiency.p_value is not None:
        p = probability(data.result.sufficiency.p_value)
        left = "after the repair" if data.result.unknown is None else "beside what has no name"
        evidence.append(f"mismatch left {left}: p {p}")
    if data.result.tolerance_deg is not None:
        evidence.append(f"tolerance {number(data.result.tolerance_deg)} deg")
    said = do_now(data.result)
    lead = next((lead for lead in LEADS if said.startswith(lead)), "To do:" if said else "")
    text = said.removeprefix(lead).strip()
    now = f'<p class="now"><b>{escape(lead)}</b> {escape(text)}</p>' if said else ""
    return (
        f'<section class="verdict" style="--tone:{tone.page}"><div><div><span class="name">'
        f'{escape(words)}</span><span class="code">{escape(code)}</span></div>'
        f"<p>{escape(summary_of(data.result))}</p>{now}"
        f'<p class="soft">{escape("; ".join(evidence))}</p></div>'
        f'<div class="figures">{figures}</div></section>'
    )


def _play(data: ReportData) -> str:
    """The free play, the stiffness and the friction of the drive."""
    return section("Free play and stiffness", table_html(tables.play_table(data)))


def _beside(*sections: str) -> str:
    """Sections side by side where the page is wide, one below the other where it is not."""
    shown = [each for each in sections if each]
    return f'<div class="beside">{"".join(shown)}</div>' if shown else ""


def _effects(data: ReportData) -> str:
    """Card of every accepted effect."""
    cards = "".join(
        f'<div class="card"><h3>{escape(name[:1].upper() + name[1:])}</h3>'
        f'<p class="size">{escape(size)}</p><p>{escape(physics)}</p>'
        + (f"<p><b>Look at</b> {escape(where)}</p>" if where else "")
        + f'<p class="soft">{escape(evidence)}</p></div>'
        for name, size, evidence, physics, where in sentences.effect_cards(data)
    )
    return section(
        "What was left out of the model", f'<div class="cards">{cards}</div>' if cards else ""
    )


def _loop(data: ReportData, picture: str) -> str:
    """Figures of the loop; nothing of a faulty recording, whose figures would mislead."""
    if data.result.verdict == "DATA_FAULT":
        return ""
    return section("Loop", picture + table_html(tables.loop_table(data)))


def _thinning(thinning: Thinning | None) -> str:
    """How many rows were fitted, and how they were made of the samples."""
    if thinning is None:
        return "every sample"
    said = f"{thinning.rows}, about {thinning.averaged} samples averaged in each"
    if thinning.averaged == 1:
        said = f"{thinning.rows}, none averaged"
    return said + (f", one in {thinning.every} taken" if thinning.every > 1 else "")


def _recording(data: ReportData) -> str:
    """Forensics: what was read, recognised, changed and found wrong."""
    recording = data.recording
    noise = data.result.noise
    structure = recording.structure
    rows = [
        ("samples", f"{len(recording)} in {len(recording.runs)} runs"),
        ("rows of the diagnosis", _thinning(data.result.thinning)),
        ("branches, reversals, holds",
         f"{len(structure.branches)}, {len(structure.reversals)}, {len(structure.holds)}"),
        ("torque", _extent(recording.torque_nm, "N m")),
        ("twist", "–" if recording.angle_deg is None else _extent(recording.angle_deg, "deg")),
        ("resolution of the angle",
         f"{number(recording.angle_resolution_deg)} deg" if recording.angle_resolution_deg
         else "continuous"),
        ("noise", _noise(noise)),
        ("history", "continuous over the runs"
         if recording.history == "continuous" or ONE_HISTORY in data.result.notes
         else "play, slip and creep start afresh with each run"),
        ("conditioning runs", ", ".join(map(str, recording.conditioning_runs)) or "none"),
        ("holdout runs", ", ".join(map(str, recording.holdout_runs)) or "chosen by blocks"),
    ]  # fmt: skip
    faults = (fault.reason for fault in recording.faults)
    remarks = [*sentences.asked(data), *recording.notes, *faults]
    listed = "".join(f"<li>{escape(text)}</li>" for text in remarks)
    return section("The recording", definitions(rows) + (f"<ul>{listed}</ul>" if listed else ""))


def _noise(noise: NoiseEstimate) -> str:
    """Size of the noise of a reading, and how it goes on from one to the next."""
    if noise.sigma_deg is None:
        return "not estimated"
    size = f"{number(noise.sigma_deg)} deg"
    if noise.white_share is None or noise.autocorrelation is None:
        return f"{size}, lag-one autocorrelation {number(noise.autocorrelation, 2)}"
    rest = 1.0 - noise.white_share
    white, slow = (number(noise.sigma_deg * part**0.5) for part in (noise.white_share, rest))
    return (
        f"{size}: {white} deg new in every reading, and a slow part of {slow} deg with a lag-one "
        f"autocorrelation of {number(noise.autocorrelation / rest, 3)}"
    )


def _extent(values: "Iterable[float]", unit: str) -> str:
    """Least and largest value."""
    numbers = list(values)
    return f"{number(min(numbers))} to {number(max(numbers))} {unit}" if numbers else "–"


def _provenance(data: ReportData) -> str:
    """Hashes, versions, seeds."""
    rows = ((str(key), str(value)) for key, value in data.provenance.items())
    return section("Provenance", definitions(rows))
