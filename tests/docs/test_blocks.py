"""Every code block of README and docs runs, and generated tables are up to date."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import cyclosweep as cs
from tests.support.own_modules import registered_for_now

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.rglob("*.md"))]
RUN_WHOLE = sorted([*(DOCS / "tutorials").glob("*.md"), *(DOCS / "how-to").glob("*.md")])
"""Pages whose blocks build on each other: run from top to bottom in one folder."""
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def _blocks(*languages: str) -> list[object]:
    return [
        pytest.param(match[2], id=f"{page.name}-{number}")
        for page in PAGES
        if page not in RUN_WHOLE
        for number, match in enumerate(_BLOCK.finditer(page.read_text("utf-8")))
        if match[1] in languages
    ]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder with the examples in it, as a reader of README has them."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    # A block may register an effect of its own, which other tests must not see.
    with registered_for_now():
        yield tmp_path


@pytest.mark.parametrize("code", _blocks("python"))
@pytest.mark.usefixtures("folder")
def test_python_block_runs(code: str) -> None:
    exec(compile(code, "block", "exec"), {"__name__": "block"})


def _run_in_shell(code: str, folder: Path) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    run = subprocess.run(
        ["bash", "-eu", "-o", "pipefail", "-c", code],
        cwd=folder,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="the blocks are for a POSIX shell")
@pytest.mark.parametrize("code", _blocks("sh"))
def test_shell_block_runs(code: str, folder: Path) -> None:
    if ".step" in code:
        pytest.importorskip("build123d", reason="pip install 'cyclosweep[step]'")
    _run_in_shell(code, folder)


@pytest.mark.skipif(sys.platform == "win32", reason="the blocks are for a POSIX shell")
@pytest.mark.parametrize("page", [pytest.param(page, id=page.stem) for page in RUN_WHOLE])
def test_page_runs_from_top_to_bottom(page: Path, folder: Path) -> None:
    names: dict[str, object] = {"__name__": "block"}
    for match in _BLOCK.finditer(page.read_text("utf-8")):
        if match[1] == "sh":
            _run_in_shell(match[2], folder)
        elif match[1] == "python":
            exec(compile(match[2], page.name, "exec"), names)


def test_every_page_stands_in_the_contents_of_the_site() -> None:
    contents = (ROOT / "mkdocs.yml").read_text("utf-8")
    missing = [
        page.relative_to(DOCS).as_posix()
        for page in DOCS.rglob("*.md")
        if f": {page.relative_to(DOCS).as_posix()}\n" not in contents
    ]
    assert not missing


@pytest.mark.parametrize(
    "notebook", sorted((ROOT / "examples").glob("*.ipynb")), ids=lambda p: p.stem
)
def test_notebook_runs_beside_its_files(
    notebook: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder / "examples")
    cells = json.loads(notebook.read_text("utf-8"))["cells"]
    names: dict[str, object] = {"__name__": "notebook"}
    for cell in cells:
        if cell["cell_type"] == "code":
            assert not cell["outputs"], "a notebook is kept without its outputs"
            exec(compile("".join(cell["source"]), notebook.name, "exec"), names)


@pytest.mark.parametrize("code", _blocks("make"))
def test_make_targets_exist(code: str) -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8")
    targets = re.findall(r"^make ([\w-]+)", code, re.MULTILINE)
    assert targets
    defined = set(re.findall(r"^([\w-]+):", makefile, re.MULTILINE))
    assert set(targets) <= defined


def test_every_block_is_of_a_kind_that_is_checked() -> None:
    kinds = {match[1] for page in PAGES for match in _BLOCK.finditer(page.read_text("utf-8"))}
    assert kinds <= {"python", "sh", "make", "toml", "json", "text"}


def test_the_study_on_the_files_page_is_one_and_its_statuses_are_all(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "files.md").read_text("utf-8")
    [study] = [match[2] for match in _BLOCK.finditer(page) if match[1] == "toml"]
    (tmp_path / "study.toml").write_text(study)
    labels = cs.Study.from_toml(tmp_path / "study.toml").statuses
    named = set(re.findall(r"`([a-z_]+)`", page.split("## The columns")[1]))
    assert {label for label in labels if not label.startswith("limit_")} - {"ok"} <= named


def test_nomenclature_and_list_of_moves_are_up_to_date() -> None:
    spec = importlib.util.spec_from_file_location("generate", ROOT / "docs" / "generate.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for name in ("nomenclature", "moved"):
        assert (ROOT / "docs" / f"{name}.md").read_text("utf-8") == module.PAGES[name](), name
