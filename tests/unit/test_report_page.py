"""The page: complete, self-contained, safe, and whole also where the diagnosis is not."""

import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.recording.unbroken_runs import UNBROKEN
from cyclosweep.report import ReportData, write_html
from cyclosweep.report.charts import Line, nice_ticks
from cyclosweep.report.figures import main_figure
from cyclosweep.report.html import page
from cyclosweep.report.regions import located
from cyclosweep.report.sentences import headline, next_experiment
from cyclosweep.report.wording import number
from cyclosweep.result import (
    Answer,
    Bound,
    Mismatch,
    NextExperiment,
    PlayAndStiffness,
    Reading,
    Region,
    Remainder,
)
from tests.unit.made_up_report import make

FAULTY = Answer(verdict="DATA_FAULT", statement="Time runs backwards.")


@pytest.fixture(scope="module")
def whole() -> ReportData:
    return make()


def svgs(text: str) -> list[ET.Element]:
    return [ET.fromstring(part) for part in re.findall(r"<svg.*?</svg>", text, re.DOTALL)]


def test_every_part_is_there(whole: ReportData) -> None:
    text = page(whole)
    for heading in (
        "Where simulation and recording differ", "What was left out of the model",
        "Next experiment", "Loop", "Residuals", "Residual map", "Parameters",
        "Every effect that was tried", "Explanations that fit", "Not found, with 95 % upper bounds",
        "What this recording cannot show", "Errors on data not used", "Self-check",
        "The recording", "Provenance",
    ):  # fmt: skip
        assert f"<h2>{heading}</h2>" in text
    for words in ("arcmin", "N m", "lost motion", "hysteresis loss", "energy lost in one cycle"):
        assert words in text
    assert "IDENTIFIED" in text
    assert "rig-3-monday" in text


def test_nothing_is_fetched(whole: ReportData) -> None:
    text = page(whole)
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)""", text)
    assert not re.search(r"@import|url\(\s*['\"]?(?!#)", text)
    assert set(re.findall(r"https?://[^\s\"'<]+", text)) <= {"http://www.w3.org/2000/svg"}
    assert len(text.encode()) < 1_000_000


def first_figure(text: str) -> ET.Element:
    """Legend and panels of the first figure, and its texts."""
    figure = re.search(r"<figure>(.*?)<figcaption>", text, re.DOTALL)
    assert figure is not None
    return ET.fromstring(f"<figure>{figure[1]}</figure>")


def test_main_picture_comes_first_and_is_complete(whole: ReportData) -> None:
    text = page(whole)
    assert text.index("<svg") < text.index("<h2>")
    first = first_figure(text)
    words = [word for element in first.iter() for word in (element.text, element.tail) if word]
    for name in (
        "measured", "simulation before", "simulation after", "what the repair adds",
        "located region", "residual (arcmin)", "torque at the input shaft (N m)",
    ):  # fmt: skip
        assert name in words
    assert any(word.startswith("Residual before") for word in words)
    assert any(word.startswith("Residual after") for word in words)
    shaded = [e for e in first.iter() if e.get("class") == "span"]
    assert len(shaded) == 6  # two regions in each of three panels


def test_panels_are_pictures_of_their_own_that_can_stack(whole: ReportData) -> None:
    panels = re.findall(r'<div class="panels".*?</div>', page(whole), re.DOTALL)
    assert panels[0].count("<svg") == 3
    assert ".panels { display: block; }" in page(whole)


def test_readings_in_the_dead_zone_do_not_set_the_scale(whole: ReportData) -> None:
    assert whole.before_deg is not None
    assert whole.after_deg is not None
    near = np.flatnonzero(np.abs(whole.recording.torque_nm) < 1.0)[:5]
    wrong = whole.after_deg.copy()
    wrong[near] += 30.0
    usual = main_figure(whole).panels[2].panel.y_range
    shown = main_figure(replace(whole, after_deg=wrong))
    found = shown.panels[2].panel.y_range
    assert usual is not None
    assert found is not None
    assert found[1] < 2 * usual[1]
    assert "lie beyond the scale" in shown.caption


def test_headline_and_picture_quote_the_same_error(whole: ReportData) -> None:
    error = whole.result.baseline.rmse_deg
    assert error is not None
    title = main_figure(whole).panels[1].panel.title
    assert title == f"Residual before: fit error {number(error)} deg"
    assert any(number(error) in value for value, _, _ in headline(whole))


def test_every_axis_has_two_numbers_at_least() -> None:
    for low, high in ((0.6, 1.9), (-0.04, 0.9), (7.1, 7.9), (1e-6, 3e-6), (-1.0, 1.0)):
        for count in range(1, 9):
            assert len(nice_ticks(low, high, count)) >= 2


def test_what_was_not_computed_is_a_dash(whole: ReportData) -> None:
    base = replace(whole.result.baseline, holdout_rmse_deg=0.0)
    repaired = replace(whole.result.repaired, holdout_rmse_deg=0.0)
    quick = replace(whole, result=replace(whole.result, baseline=base, repaired=repaired))
    assert ("–", "held-out error", "not computed") in headline(quick)


def test_simulation_lines_reach_the_last_of_a_dozen_readings() -> None:
    torque = np.array([0.5, 2, 4, 6, 8, 10, 14, 18, 14, 10, 6, 2])
    twist = 28 + 2.7 * torque
    recording = cs.Recording.from_arrays(torque, twist)
    data = ReportData(recording=recording, result=FAULTY, before_deg=twist, after_deg=twist)
    loop = main_figure(data).panels[0].panel
    line = next(s for s in loop.series if isinstance(s, Line))
    assert not np.isnan(line.x).any()
    assert line.x[-1] == 2


def test_nothing_is_drawn_outside_the_page(whole: ReportData) -> None:
    for svg in svgs(page(whole)):
        _, _, width, height = map(float, (svg.get("viewBox") or "").split())
        for element in svg.iter():
            if element.tag.endswith("}text") and element.get("x"):
                anchor = {"end": 1.0, "middle": 0.5}.get(element.get("text-anchor") or "", 0.0)
                long = 5.5 * len(element.text or "")
                left = float(element.get("x") or 0) - anchor * long
                assert left >= 0
                assert left + long <= width or element.get("class") == "at"
                assert 0 <= float(element.get("y") or 0) <= height


def test_foreign_text_is_escaped(whole: ReportData) -> None:
    recording = replace(whole.recording, name="<script>x</script>", notes=('<img src="x">',))
    result = replace(whole.result, statement="<b>bold</b> & more")
    text = page(replace(whole, recording=recording, result=result))
    assert "<script>x" not in text
    assert "<img" not in text
    assert "&lt;b&gt;bold&lt;/b&gt; &amp; more" in text


def test_a_question_of_the_diagnosis_is_shown(whole: ReportData) -> None:
    result = replace(whole.result, notes=(UNBROKEN,))
    assert escape(UNBROKEN) in page(replace(whole, result=result))
    assert escape(UNBROKEN) not in page(whole)


@pytest.mark.parametrize(
    "recording",
    [
        cs.Recording.from_arrays([], []),
        cs.Recording.from_arrays([1.0], [2.0]),
        cs.Recording.from_arrays([1.0, 2.0], [2.0, 3.0]),
        cs.Recording.from_arrays(np.ones(50), np.arange(50.0)),
        cs.Recording.from_arrays(np.arange(50.0), np.ones(50), time_s=np.arange(50.0)[::-1]),
        cs.Recording.from_arrays(np.arange(12.0) + 1, 28 + 2.7 * np.arange(12.0)),
    ],
    ids=["empty", "one", "two", "constant torque", "constant angle", "a dozen"],
)
@pytest.mark.parametrize("predicted", [False, True])
def test_poor_recordings_have_a_page_too(recording: cs.Recording, predicted: bool) -> None:
    assert recording.angle_deg is not None
    simulated = np.zeros(len(recording)) if predicted else None
    data = ReportData(recording=recording, result=FAULTY, before_deg=simulated, after_deg=simulated)
    text = page(data)
    assert "The recording is faulty" in text
    assert "NaN" not in text
    assert "nan" not in re.sub(r"[a-z]nan|nan[a-z]", "", text)
    svgs(text)


def test_a_fault_shows_no_tables_of_nothing(whole: ReportData) -> None:
    text = page(ReportData(recording=whole.recording, result=FAULTY))
    assert "<table" not in text
    assert "– deg" not in text
    assert "Energy lost" not in text


READ = PlayAndStiffness(
    definition="straight lines",
    runs=5,
    free_play_deg=Reading(estimate=56.1, ci95=(55.0, 57.2)),
    free_play_at_output_deg=Reading(estimate=0.645, ci95=(0.632, 0.657)),
    stiffness_at_output_nm_per_arcmin=Reading(estimate=46.2, ci95=(45.0, 47.0)),
)


def test_one_free_play_and_one_stiffness_come_before_all_others(whole: ReportData) -> None:
    text = page(replace(whole, result=replace(whole.result, play_and_stiffness=READ)))
    first = text.index("<h2>Free play and stiffness</h2>")
    assert first < text.index("<h2>What was left out of the model</h2>")
    assert text.index("<td>46.2 N m/arcmin") < text.index("slope of the loading branches")
    assert "45 … 47" in text
    assert "Intervals by Student&#x27;s t over 5 runs" in text
    # What else could be taken for it says how it differs.
    assert "differs from the stiffness at the top of the page" in text
    assert "<td>stiffness at the" not in text[text.index("<h2>Loop</h2>") :]


def test_the_slope_says_between_which_torques_it_was_taken(whole: ReportData) -> None:
    far = replace(whole, rated_torque_nm=1000.0)  # the rated torque was never reached
    reached = float(np.abs(whole.recording.torque_nm).max())
    assert f"{number(0.5 * reached)} to {number(reached)} N m" in page(far)
    assert "of rated torque." not in page(far)


def test_the_verdict_box_holds_two_sentences_and_what_to_do(whole: ReportData) -> None:
    found = re.search(r'<section class="verdict".*?</section>', page(whole), re.DOTALL)
    assert found is not None
    box = found[0]
    assert len(re.sub("<.*?>", "", box)) < 700
    assert "are missing from the model (97 %): with them the error on data not used falls" in box
    assert "<b>Look at</b> what gives way above the load" in box
    assert whole.result.statement not in box
    assert whole.result.statement in page(whole)


def test_a_possible_cause_is_not_among_what_was_not_found(whole: ReportData) -> None:
    result = replace(whole.result, undecided=(Bound(name="clearance_takeup", upper95_deg=0.9),))
    text = page(replace(whole, result=result))
    start, stop = (text.index(f"<h2>{h}") for h in ("Possible, with", "Not found, with"))
    assert "Clearance takeup: at most 0.9 deg" in text[start:stop]
    assert "Clearance takeup" not in text[stop : text.index("<h2>What this recording cannot")]


def test_plus_minus_is_the_interval_of_95_percent_everywhere(whole: ReportData) -> None:
    text = page(whole)
    assert "Friction torque 0.2 ± 0.0078 N m (± 95 %)" in text  # standard error 0.004
    assert "28.05 ± 0.059" in text  # standard error 0.03
    assert "behind ± stands the half width of the 95 % interval" in text


def test_the_size_of_an_effect_is_compared_with_a_load_as_the_answer_says(
    whole: ReportData,
) -> None:
    assert page(whole).count("; the twist of 0.31 N m of load") == 1
    assert page(whole).count("; the twist of ") == 1  # the other effect has no torque


def test_loads_of_the_next_experiment_beyond_the_rated_torque_are_said(whole: ReportData) -> None:
    plan = NextExperiment(program="two loops", loads_nm=(0.0, 30.0, -30.0, 0.0))
    data = replace(whole, result=replace(whole.result, next_experiment=plan))
    text = next_experiment(replace(data, rated_torque_nm=7.5))
    assert "0, 30, −30, 0 N m. The largest is 4 times the rated torque" in text
    for rated in (30.0, None):
        assert "rated" not in next_experiment(replace(data, rated_torque_nm=rated))


def test_a_place_without_a_clock_is_said_in_readings(whole: ReportData) -> None:
    region = Region(run=(1, 1), readings=(7, 10), mean_residual_deg=1.1, share_of_excess=0.004)
    result = replace(whole.result, mismatch=Mismatch(p_value=0.001, regions=(region,)))
    data = replace(whole, result=result)
    text = page(data)
    assert "Run 1, readings 7 to 10: mean residual 1.1 deg" in text
    assert "less than 1 % of the misfit" in text
    assert located(data).sum() == 4


def test_wide_tables_stack_on_a_phone(whole: ReportData) -> None:
    text = page(whole)
    assert '<table class="stacked"' in text
    assert 'data-name="95 % interval (deg)"' in text
    assert ".stacked td[data-name]::before" in text


def test_the_names_of_the_rows_of_the_map_have_room(whole: ReportData) -> None:
    rows = [e for svg in svgs(page(whole)) for e in svg.iter()
            if (e.text or "").endswith("unloading") and e.get("text-anchor") == "end"]  # fmt: skip
    assert rows
    for element in rows:  # letters of 14.5 px on a narrow screen
        assert float(element.get("x") or 0) >= 7.9 * len(element.text or "")


def test_the_name_of_a_shaded_stretch_lies_above_its_panel(whole: ReportData) -> None:
    named = 0
    for svg in svgs(page(whole)):
        tops = [float(e.get("y") or 0) for e in svg.iter() if e.get("class") == "plot"]
        for element in svg.iter():
            if element.get("class") == "spanlabel":
                named += 1
                assert float(element.get("y") or 0) < min(tops)
    assert named


def test_a_programme_alone_has_a_page() -> None:
    program = cs.Recording.from_arrays(np.arange(30.0))
    assert "<svg" not in page(ReportData(recording=program, result=FAULTY))


def test_many_samples_are_thinned() -> None:
    text = page(make(runs=40, samples=3000))
    assert len(text.encode()) < 2_000_000


def test_an_event_in_time_is_shown_over_time(whole: ReportData) -> None:
    region = Region(
        torque_nm=(-32.0, 32.0),
        direction="both",
        run=(4, 4),
        time_s=(3000.0, 3100.0),
        mean_residual_deg=0.5,
        share_of_excess=0.9,
    )
    result = replace(whole.result, mismatch=Mismatch(p_value=0.001, regions=(region,)))
    first = first_figure(page(replace(whole, result=result)))
    words = [element.text or "" for element in first.iter() if element.tag.endswith("text")]
    assert words.count("time (s)") == 2


def test_unknown_physics_has_shape_place_and_size(whole: ReportData) -> None:
    result = replace(
        whole.result,
        verdict="UNKNOWN_PHYSICS",
        effects=(),
        unknown=Remainder(
            shape="step of the angle", place="from t = 2671 s (run 7)", size_deg=0.16
        ),
        undecided=(Bound(name="creep", upper95_deg=0.9),),
    )
    text = page(replace(whole, result=result))
    assert "Step of the angle of 0.16 deg (9.6 arcmin), from t = 2671 s (run 7)." in text
    assert "Creep: could be as large as 0.9 deg (54 arcmin), above the tolerance" in text
    assert "Residual after (no repair)" in text
    assert "What was left out of the model" not in text


def test_which_readings_the_errors_count_is_said(whole: ReportData) -> None:
    said = {}
    for counted in ("readings in contact", "whole loops"):
        base = replace(whole.result.baseline, counted=counted)
        data = replace(whole, result=replace(whole.result, baseline=base))
        said[counted] = main_figure(data).caption, headline(data)[1][1]
    assert "Errors count readings in contact" in said["readings in contact"][0]
    assert said["readings in contact"][1] == "fit error"
    assert "Errors count whole loops, the way through the play included" in said["whole loops"][0]
    assert said["whole loops"][1] == "fit error, way through the play included"


def test_the_file_appears_whole(tmp_path: Path, whole: ReportData) -> None:
    path = write_html(whole, tmp_path / "report.html")
    assert path.read_text(encoding="utf-8") == page(whole)
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_chromium_shows_it_without_an_error(tmp_path: Path, whole: ReportData) -> None:
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if browser is None:
        pytest.skip("no chromium here")
    path = write_html(whole, tmp_path / "report.html")
    done = subprocess.run(
        [
            browser, "--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom",
            "--enable-logging=stderr", f"--user-data-dir={tmp_path / 'profile'}", path.as_uri(),
        ],
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert 'data-ready="yes"' in done.stdout, "the script ran to its end"
    assert "CONSOLE" not in done.stderr


def test_the_hash_of_the_recording_stands_once_on_the_page(whole: ReportData) -> None:
    digest = "ab12" * 16
    data = replace(
        whole,
        recording=replace(whole.recording, sha256=digest),
        provenance={**whole.provenance, "sha256": digest},
    )
    assert page(data).count(digest) == 1
