"""Commands that write files: interrupted, on a full disk, into a folder that takes none."""

from __future__ import annotations

import resource
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

import cyclosweep as cs

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs signals of POSIX")

ROOT = Path(__file__).parents[2]
DRIVE = str(ROOT / "examples" / "catalogue-29.toml")
LEAST_BYTES = 2000
"""Room on the disk that is full: less than any of the files needs."""


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("Ordner für eine Studie") / "Maß"
    space = cs.Space.sobol(
        cs.Drive.reference_87(), 3000, seed=4, eccentricity_mm=(0.3, 0.8), output_pin_count=(6, 9)
    )
    cs.sink(space, folder)
    return folder


def _arguments(study: Path) -> dict[str, list[str]]:
    """Commands by the name of the file that they write."""
    best = ["best", str(study), "--minimise", "reflected_compliance_rad_per_nm"]
    return {
        "report.html": ["report", str(study), "--out"],
        "disc.dxf": ["export", DRIVE, "--out"],
        "disc.svg": ["export", DRIVE, "--out"],
        "disc.png": ["plot", "disc", "reference-87", "--out"],
        "best.csv": [*best, "--out"],
        "best.xlsx": [*best, "--out"],
        "drive.toml": ["pick", str(study), "5", "--force", "--out"],
    }


FILES = tuple(_arguments(Path()))


def _full() -> None:
    """Stand in for a disk that is full: the system refuses to make a file longer."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LEAST_BYTES, LEAST_BYTES))


def _run(
    arguments: Sequence[str], folder: Path, *, full: bool = False
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        encoding="utf-8",
        preexec_fn=_full if full else None,
        check=False,
    )


@pytest.mark.parametrize("name", FILES)
def test_a_full_disk_is_one_line_and_leaves_what_was_there(
    name: str, study: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "für Zeichnungen"
    folder.mkdir()
    (folder / name).write_text("before")
    ended = _run([*_arguments(study)[name], name], folder, full=True)
    if ended.returncode == 0:  # it needs less room
        assert (folder / name).stat().st_size <= LEAST_BYTES
        return
    assert ended.returncode == 1, ended.stderr
    # matplotlib may say that it cannot keep its list of fonts.
    lines = [line for line in ended.stderr.splitlines() if "font_manager" not in line]
    assert len(lines) == 1
    assert lines[0].startswith("cyclosweep: ")
    assert name in lines[0]
    assert ".tmp" not in lines[0]
    assert [path.name for path in folder.iterdir()] == [name]
    assert (folder / name).read_text() == "before"


@pytest.mark.parametrize("name", FILES)
def test_a_folder_that_takes_no_files_is_one_line(name: str, study: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    ended = _run([*_arguments(study)[name], f"file/{name}"], tmp_path)
    assert ended.returncode in (1, 2), ended.stderr
    assert ended.stderr.count("\n") == 1
    assert "file" in ended.stderr
    assert ".tmp" not in ended.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("name", ["report.html", "disc.dxf"])
def test_an_interruption_leaves_nothing_half_written(
    name: str, study: Path, tmp_path: Path
) -> None:
    command = [sys.executable, "-m", "cyclosweep", *_arguments(study)[name], name]
    began = time.monotonic()
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    whole_s = time.monotonic() - began
    (tmp_path / name).unlink()
    interrupted, codes = 0, []
    for share in (0.5, 0.6, 0.7, 0.8, 0.9):
        pipe = subprocess.PIPE
        with subprocess.Popen(
            command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True, encoding="utf-8"
        ) as process:
            time.sleep(share * whole_s)
            process.send_signal(signal.SIGINT)
            _, error = process.communicate(timeout=60)
        left = [path.name for path in tmp_path.iterdir()]
        assert left in ([], [name]), left
        if left:
            end = (tmp_path / name).read_text(encoding="utf-8").rstrip()[-10:]
            assert end.endswith(("</html>", "EOF"))
        codes.append(process.returncode)
        interrupted += process.returncode in (1, 130) and not left
        assert "Traceback" not in error or process.returncode < 0
        (tmp_path / name).unlink(missing_ok=True)
    assert interrupted, codes


IGNORED_INTERRUPTION = """
import os, signal, sys, time, weakref
import typer
from cyclosweep.cli import app, main

class Watched:
    pass

@app.command()
def dawdle() -> None:
    watched = Watched()
    kept = weakref.ref(watched, lambda _: os.kill(os.getpid(), signal.SIGINT))
    del watched
    time.sleep(20.0)
    print("went on")

main()
"""


def test_an_interruption_that_python_ignores_ends_the_command() -> None:
    """Python prints and forgets exceptions in callbacks of weak references."""
    began = time.monotonic()
    command = [sys.executable, "-c", IGNORED_INTERRUPTION, "dawdle"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert time.monotonic() - began < 15.0
    assert ended.returncode == 130
    assert "went on" not in ended.stdout
    assert ended.stderr == ""


INTERRUPTED_IMPORT = """
from cyclosweep.errors import InputError
from cyclosweep.cli import app, main

@app.command()
def load() -> None:
    try:
        {cause}
    except BaseException as before:
        raise {error}("initialization failed") from before

main()
"""


@pytest.mark.parametrize(
    ("cause", "error", "status"),
    [
        ("raise KeyboardInterrupt", "ImportError", 130),
        ("raise KeyboardInterrupt", "InputError", 130),
        ("raise RuntimeError", "ImportError", 1),
    ],
)
def test_an_interruption_of_an_extension_module_ends_the_command(
    cause: str, error: str, status: int
) -> None:
    """pybind11 raises an ImportError from whatever ends the first lines of its modules.

    Some commands take that for a library that is not installed.
    """
    command = [sys.executable, "-c", INTERRUPTED_IMPORT.format(cause=cause, error=error), "load"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == status
    assert ("Traceback" in ended.stderr) == (status == 1)
