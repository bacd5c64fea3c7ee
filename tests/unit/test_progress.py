"""What long work says: to a log, to a terminal, to a notebook, to a function, or nothing."""

from __future__ import annotations

import io
import logging
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.display import in_notebook, shown_steps
from cyclosweep.sweep import progress
from cyclosweep.sweep.progress import Progress

DRIVE = cs.Drive.reference_87()
SPACE = cs.Space.grid(DRIVE, eccentricity_mm=cs.linspace(0.3, 0.8, 10))


class Shown:
    """The part of IPython that a notebook's kernel has; what is shown is kept."""

    def __init__(self) -> None:
        self.pages: list[str] = []

    def display(self, page: str, *, display_id: bool) -> Shown:
        assert display_id
        self.update(page)
        return self

    def update(self, page: str) -> None:
        self.pages.append(page)


@pytest.fixture
def notebook(monkeypatch: pytest.MonkeyPatch) -> Shown:
    """A notebook's kernel around the test."""
    shown = Shown()
    ipython, display = types.ModuleType("IPython"), types.ModuleType("IPython.display")
    shell = types.SimpleNamespace(config={"IPKernelApp": {}})
    vars(ipython)["get_ipython"] = lambda: shell
    vars(display).update(HTML=str, display=shown.display)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    return shown


@pytest.fixture(scope="module")
def loop() -> cs.Recording:
    """A loop of the published model with noise."""
    torque = np.concatenate([np.linspace(a, b, 100) for a, b in ((0.4, 20), (20, -20), (-20, 0.4))])
    load = cs.Recording.from_arrays(torque, name="a<b")
    angle = cs.simulate(cs.Model.of_drive(DRIVE), load).angle_deg
    assert angle is not None
    return load.with_angle(angle + 0.1 * np.random.default_rng(1).standard_normal(300))


def test_a_function_is_told_how_much_is_done(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    cs.sink(SPACE, tmp_path, rows_per_part=4, progress=lambda done, of: told.append((done, of)))
    assert len(told) == 3
    assert sorted(told)[-1] == (10, 10)
    told.clear()
    cs.sink(SPACE, tmp_path, rows_per_part=4, progress=lambda done, of: told.append((done, of)))
    assert told == []


def test_a_notebook_gets_one_line_that_goes_away(
    notebook: Shown, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert in_notebook()
    monkeypatch.setattr(progress, "_SHOW_AFTER_S", 0.0)
    with Progress("sweep", 4000) as bar:
        bar.advance(1000)
        bar.advance(1000)  # too soon after the first
    assert len(notebook.pages) == 2
    assert '<progress value="1000" max="4000">' in notebook.pages[0]
    assert "1,000 of 4,000" in notebook.pages[0]
    assert notebook.pages[1] == ""


def test_short_work_and_silent_work_leave_a_notebook_alone(
    notebook: Shown, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Progress("sweep", 4000) as bar:
        bar.advance(1000)
    monkeypatch.setattr(progress, "_SHOW_AFTER_S", 0.0)
    with Progress("sweep", 4000, show=False) as bar:
        bar.advance(1000)
    assert notebook.pages == []


def test_steps_of_a_diagnosis_in_a_notebook(notebook: Shown, loop: cs.Recording) -> None:
    cs.diagnose(loop, DRIVE, full=False, progress=True)
    assert notebook.pages[0] == "a&lt;b: preparing ..."
    assert notebook.pages[-1] == ""
    assert len(notebook.pages) > 2


def test_steps_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = io.StringIO()
    monkeypatch.setattr(sys, "stderr", screen)
    with shown_steps("loop", True) as say:
        say("preparing")
    with shown_steps("loop", False) as say:
        say("fitting")
    with shown_steps("loop", None) as say:
        say("fitting")
    assert "fitting" not in screen.getvalue()


@pytest.mark.parametrize("wrong", ["yes", 1, 0.5])
def test_another_kind_of_progress_is_one_line(tmp_path: Path, wrong: Any) -> None:
    with pytest.raises(cs.InputError, match="progress: found"):
        cs.sink(SPACE, tmp_path, progress=wrong)
    with pytest.raises(cs.InputError, match="progress: found"), shown_steps("a", wrong):
        pass


def test_the_log_tells_what_was_swept(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "cyclosweep"):
        cs.sink(SPACE, tmp_path)
    first, last = (record.getMessage() for record in caplog.records)
    assert "10 variants, 0 of them there" in first
    assert str(tmp_path) in last
    assert "<Summary: 10 variants" in last


def test_the_log_tells_steps_and_verdict(
    loop: cs.Recording, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.DEBUG, "cyclosweep"):
        found = cs.diagnose(loop, DRIVE, full=False)
    assert caplog.records[0].getMessage() == "a<b: preparing"
    assert caplog.records[-1].levelno == logging.INFO
    assert caplog.records[-1].getMessage() == repr(found)


QUIET = """
import sys, tempfile, logging
import cyclosweep as cs
space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8])
with tempfile.TemporaryDirectory() as folder:
    cs.sink(space, folder)
logging.getLogger("cyclosweep").warning("said to nobody")
assert "IPython" not in sys.modules and "rich" not in sys.modules
"""


def test_nothing_is_printed_unless_asked() -> None:
    done = subprocess.run([sys.executable, "-c", QUIET], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")


LIBRARY = [
    path
    for path in sorted(Path(cs.__file__).parent.rglob("*.py"))
    if path.parent.name not in ("cli",) and path.name not in ("terminal.py",)
]


@pytest.mark.parametrize("path", LIBRARY, ids=lambda path: path.stem)
def test_library_code_does_not_print(path: Path) -> None:
    lines = path.read_text("utf-8").splitlines()
    assert not [line for line in lines if line.lstrip().startswith("print(")]
