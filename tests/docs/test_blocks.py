"""Every code block of README and docs runs, and generated tables are up to date."""

from __future__ import annotations

import ast
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
ONE_SESSION = DOCS / "tutorials" / "better-drive.md"
"""Page whose Python blocks go on from each other in one session, and which says so."""
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


def _writers() -> Iterator[tuple[str, str]]:
    """Folder of each sweep on the pages, and what decides what it holds."""
    for page in PAGES:
        for number, match in enumerate(_BLOCK.finditer(page.read_text("utf-8"))):
            place = f"{page.name}, block {number}"
            if match[1] == "sh":
                for study, rows, out in re.findall(
                    r"^cyclosweep (?:sweep|shard) (\S+)(?: --rows (\d+))?.* --out (\S+)",
                    match[2],
                    re.MULTILINE,
                ):
                    lasts = study.startswith("examples/")
                    yield out.rstrip("/"), f"{study} {rows}" if lasts else f"{page.name}: {study}"
            elif match[1] == "python":
                for out in re.findall(r'cs\.sink\(.*"([\w-]+)"', match[2]):
                    yield out, place


def test_blocks_of_all_pages_run_one_after_the_other_in_one_folder() -> None:
    writers: dict[str, set[str]] = {}
    for folder, what in _writers():
        writers.setdefault(folder, set()).add(what)
    assert len(writers) > 8
    assert {folder: sorted(what) for folder, what in writers.items() if len(what) > 1} == {}
    made = [
        name
        for page in PAGES
        for name in re.findall(
            r"^cyclosweep new .*--out (\S+)", page.read_text("utf-8"), re.MULTILINE
        )
    ]
    assert made
    for name in made:  # new does not overwrite
        others = [
            page.name
            for page in PAGES
            if re.search(rf'(> |Path\("){re.escape(name)}\b', page.read_text("utf-8"))
        ]
        assert made.count(name) == 1
        assert not others, name


def test_every_python_block_imports_what_it_uses() -> None:
    modules = {"cs", "duckdb", "np", "pa", "pd", "pl", "plt"}
    missing = []
    assert "one Python session" in ONE_SESSION.read_text("utf-8")
    for page in (page for page in PAGES if page != ONE_SESSION):
        for match in _BLOCK.finditer(page.read_text("utf-8")):
            if match[1] != "python":
                continue
            nodes = list(ast.walk(ast.parse(match[2])))
            imported = {
                alias.asname or alias.name
                for node in nodes
                if isinstance(node, ast.Import)
                for alias in node.names
            }
            used = {node.id for node in nodes if isinstance(node, ast.Name)} & modules
            missing += [f"{page.name}: {name}" for name in sorted(used - imported)]
    assert not missing


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
