"""The terminal summary and the PNG files."""

import io
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from rich.console import Console

import cyclosweep as cs
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.unbroken_runs import UNBROKEN
from cyclosweep.report import ReportData, print_summary, write_png, write_report
from cyclosweep.report.figures import all_figures
from cyclosweep.report.png import _write
from cyclosweep.report.summary import summary_of
from cyclosweep.result import (
    Answer,
    Bound,
    Mismatch,
    NextExperiment,
    PlayAndStiffness,
    Reading,
    Untestable,
)
from tests.unit.made_up_report import make


def play_and_stiffness_at_input() -> PlayAndStiffness:
    """Values with intervals, and no friction."""
    return PlayAndStiffness(
        runs=3,
        free_play_deg=Reading(estimate=55.5, ci95=(55.2, 55.8)),
        stiffness_at_output_nm_per_arcmin=Reading(estimate=46.04, ci95=(46.02, 46.06)),
        friction_nm=Reading(estimate=-0.005, ci95=(-0.04, 0.03)),
    )


def printed(data: ReportData, width: int) -> str:
    stream = io.StringIO()
    print_summary(data, Console(file=stream, width=width, color_system=None))
    return stream.getvalue()


@pytest.mark.parametrize("width", [40, 60, 80, 120])
def test_summary_fits_and_is_complete(width: int) -> None:
    text = printed(make(), width)
    assert max(len(line) for line in text.splitlines()) <= width
    squeezed = " ".join(text.split())
    for words in (
        "IDENTIFIED", "1.31 → 0.21 deg", "friction", "0.51 … 0.59", "21.5 to 32.6 N m",
        "Next experiment", "rig compliance".capitalize(),
    ):  # fmt: skip
        assert words in squeezed
    assert "…" not in text.replace(" … ", "")


def test_no_word_is_broken_and_the_verdict_is_whole_in_40_columns() -> None:
    data = make()
    answer = replace(
        data.result, verdict="UNKNOWN_PHYSICS", play_and_stiffness=play_and_stiffness_at_input()
    )
    words = set(printed(replace(data, result=answer), 300).split())
    narrow = printed(replace(data, result=answer), 40)
    assert max(len(line) for line in narrow.splitlines()) <= 40
    inside = narrow.translate(str.maketrans("", "", "╭╮╰╯│─"))
    assert set(inside.split()) <= words | {"deg", "p", "e", "95", "%:", "0.001,"}
    squeezed = " ".join(narrow.replace("│", "").split())
    assert "Known effects found, and something without a name (UNKNOWN_PHYSICS)" in squeezed
    assert "friction hysteresis 0.55 deg (33 arcmin) 95 %: 0.51 … 0.59 deg" in squeezed


def test_evidence_that_was_not_computed_is_a_dash() -> None:
    data = make()
    effects = tuple(replace(effect, e_value=None) for effect in data.result.effects)
    text = printed(replace(data, result=replace(data.result, effects=effects)), 80)
    [line] = [line for line in text.splitlines() if line.startswith("friction hysteresis  ")]
    assert line.split()[-1] == "–"


def test_the_first_lines_are_short() -> None:
    lines = printed(make(), 80).splitlines()
    end = next(k for k, line in enumerate(lines) if line.startswith("╰"))
    assert end < 9
    assert "Look at" in " ".join(lines[:end])
    assert "The answer in full" in lines


def test_brackets_in_remarks_are_not_markup() -> None:
    data = make()
    fault = Fault("clock_ticks", None, "use [merge] same_time = true")
    text = printed(replace(data, recording=replace(data.recording, faults=(fault,))), 80)
    assert "[merge]" in text


def test_a_question_of_the_diagnosis_is_shown() -> None:
    data = make()
    result = replace(data.result, notes=("Side not given.", UNBROKEN))
    text = " ".join(printed(replace(data, result=result), 80).split())
    assert 'write history = "continuous"' in text
    assert 'write history = "continuous"' not in " ".join(printed(data, 80).split())


def test_pictures(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    files = write_png(make(runs=2, samples=200), tmp_path / "pictures")
    assert [path.name for path in files] == ["loop.png", "zoom.png", "profiles.png", "map.png"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in files)
    assert len(list((tmp_path / "pictures").iterdir())) == 4


def test_the_caption_of_a_picture_is_drawn_whole(tmp_path: Path) -> None:
    image = pytest.importorskip("matplotlib.image")
    figure = next(iter(all_figures(make(runs=2, samples=200))))
    heights = []
    for lines in range(1, 7):
        caption = "whatever its letters gjpqy, " * 6 * lines
        file = _write(replace(figure, caption=caption), tmp_path / "loop.png")
        pixels = image.imread(file)[:, :, :3]
        foot = (pixels[-200:] < 0.9).any(axis=(1, 2))
        assert not foot[-4:].any(), "nothing is cut at the edge"
        heights.append(len(pixels))
    assert all(low < high for low, high in pairwise(heights))


def test_the_name_chooses_the_form(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    data = make(runs=2, samples=200)
    assert write_report(data, tmp_path / "a.html").read_text("utf-8").startswith("<!doctype html>")
    assert write_report(data, tmp_path / "b.png").read_bytes().startswith(b"\x89PNG")
    assert (write_report(data, tmp_path / "pictures") / "loop.png").is_file()
    with pytest.raises(cs.InputError, match=r"\.pdf"):
        write_report(data, tmp_path / "c.pdf")
    program = ReportData(
        recording=cs.Recording.from_arrays([1.0, 2.0]), result=Answer(verdict="DATA_FAULT")
    )
    with pytest.raises(cs.InputError, match="no angles"):
        write_report(program, tmp_path / "d.png")


def test_a_long_list_ends_with_the_names_of_the_rest() -> None:
    data = make()
    bounds = tuple(Bound(name=f"effect_{k}", upper95_deg=0.1) for k in range(9))
    text = " ".join(
        printed(
            replace(data, result=replace(data.result, ruled_out=bounds, undecided=())), 120
        ).split()
    )
    assert "And 3 more: effect 6, effect 7, effect 8" in text


def test_a_bound_below_the_tolerance_is_not_said_to_be_above_it() -> None:
    data = make()
    for tolerance, said in ((0.05, True), (0.5, False)):
        bound = (Bound(name="creep", upper95_deg=0.1),)
        answer = replace(data.result, undecided=bound, tolerance_deg=tolerance)
        text = " ".join(printed(replace(data, result=answer), 120).split())
        assert ("could be as large as 0.1 deg (6 arcmin), above the tolerance" in text) is said


def test_nothing_missing_says_what_the_recording_cannot_show() -> None:
    hidden = (Untestable(name="friction_hysteresis", reason="it only loads"),)
    data = make()
    told = {}
    for rows in ((), hidden):
        answer = Answer(
            verdict="NOTHING_MISSING",
            not_testable=rows,
            next_experiment=NextExperiment(program="none needed"),
        )
        told[rows] = " ".join(printed(replace(data, result=answer), 120).replace("│", "").split())
    assert "the calibrated model describes this drive" in told[()]
    assert "None needed" in told[()]
    assert "It cannot show friction hysteresis" in told[hidden]
    assert "None needed" not in told[hidden]


def test_a_loop_that_runs_backwards_is_called_so() -> None:
    data = make()
    for friction, said in ((-0.4, True), (-1e-4, False), (0.4, False)):
        read = PlayAndStiffness(runs=1, friction_nm=Reading(estimate=friction))
        text = printed(replace(data, result=replace(data.result, play_and_stiffness=read)), 300)
        assert ("the wrong way round" in text) is said


def test_an_unknown_without_shape_or_effects_still_has_a_sentence() -> None:
    answer = Answer(verdict="UNKNOWN_PHYSICS", mismatch=Mismatch(p_value=0.001))
    assert "something that no listed effect explains" in summary_of(answer)


def test_what_the_diagnosis_asks_is_said_once() -> None:
    data = make()
    data = replace(data, result=replace(data.result, notes=(*data.result.notes, UNBROKEN)))
    text = " ".join(printed(data, 100).split())
    assert text.count("Runs follow each other without a pause") == 1
