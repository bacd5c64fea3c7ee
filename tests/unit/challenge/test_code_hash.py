"""A record is bound to the code that decides its numbers, and to nothing else."""

import ast
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from cyclosweep_challenge.record.code import (
    DIAGNOSES,
    PYTHON,
    bare_rust,
    diagnosis_hash,
    imported_modules,
    rig_hash,
    syntax,
)

ROOT = PYTHON.parent
EFFECT = "cyclosweep/simulation/effects/creep.py"


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Copy of the sources that may be changed."""
    copy = tmp_path_factory.mktemp("sources")
    ignore = shutil.ignore_patterns("__pycache__", "*.so", "*.pyd")
    shutil.copytree(PYTHON, copy / "python", ignore=ignore)
    shutil.copytree(ROOT / "rust" / "src", copy / "rust" / "src")
    return copy


@pytest.fixture(scope="module")
def unchanged(sources: Path) -> str:
    return diagnosis_hash(sources / "python")


def changed(file: Path, change: Callable[[str], str], python: Path) -> str:
    """Hash with one file changed; the file is put back."""
    before = file.read_text("utf-8")
    after = change(before)
    assert after != before
    file.write_text(after, "utf-8")
    try:
        return diagnosis_hash(python)
    finally:
        file.write_text(before, "utf-8")


def other_docstring(source: str) -> str:
    """The docstring of the file in other words."""
    return source.replace('"""', '"""Other words. ', 1)


def other_constant(source: str) -> str:
    """The first number with a point, doubled."""
    numbers = [
        node
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Constant) and isinstance(node.value, float)
    ]
    first = numbers[0]
    lines = source.splitlines(keepends=True)
    line = lines[first.lineno - 1]
    before, after = line[: first.col_offset], line[first.end_col_offset :]
    lines[first.lineno - 1] = f"{before}{2.0 * float(str(first.value))}{after}"
    return "".join(lines)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        (f"python/{EFFECT}", lambda s: f"# A remark.\n{s}\n\n# Another.\n"),
        (f"python/{EFFECT}", other_docstring),
        ("python/cyclosweep/sweep/space.py", lambda s: f"{s}\nMORE = 1\n"),
        ("python/cyclosweep/cli/__init__.py", lambda s: f"{s}\nMORE = 1\n"),
        ("python/cyclosweep/__init__.py", lambda s: f"{s}\nMORE = 1\n"),
        ("python/cyclosweep_challenge/scoring/criteria.py", lambda s: f"{s}\nMORE = 1\n"),
        ("python/cyclosweep/design/reference_87.toml", lambda s: f"# A remark.\n{s}"),
        ("rust/src/lib.rs", lambda s: f"// A remark.\n/* and /* one */ more */\n{s}"),
    ],
)
def test_what_decides_nothing_does_not_count(
    sources: Path, unchanged: str, name: str, change: Callable[[str], str]
) -> None:
    assert changed(sources / name, change, sources / "python") == unchanged


@pytest.mark.parametrize(
    ("name", "change"),
    [
        (f"python/{EFFECT}", other_constant),
        ("python/cyclosweep/recording/recording.py", lambda s: f"{s}\nMORE = 1\n"),
        ("python/cyclosweep/design/drive.py", lambda s: f"{s}\nMORE = 1\n"),
        ("python/cyclosweep/diagnosis/diagnose.py", lambda s: f"{s}\nMORE = 1\n"),
        ("python/cyclosweep/design/reference_87.toml", lambda s: f"{s}\nmore = 1\n"),
        ("rust/src/lib.rs", lambda s: f"{s}\nconst MORE: f64 = 1.0;\n"),
    ],
)
def test_what_decides_counts(
    sources: Path, unchanged: str, name: str, change: Callable[[str], str]
) -> None:
    assert changed(sources / name, change, sources / "python") != unchanged


def test_the_generator_is_bound_apart_from_the_diagnosis(sources: Path) -> None:
    python = sources / "python"
    before = rig_hash(python)
    for name, same in ((EFFECT, True), ("cyclosweep_challenge/rig/pins.py", False)):
        file = python / name
        text = file.read_text("utf-8")
        file.write_text(f"{text}\nMORE = 1\n", "utf-8")
        assert (rig_hash(python) == before) is same
        file.write_text(text, "utf-8")


def test_imports_are_followed_through_modules_functions_and_dots(tmp_path: Path) -> None:
    files = {
        "p/__init__.py": "import p.never",
        "p/never.py": "",
        "p/a/__init__.py": "",
        "p/a/one.py": "from p.b import two\nfrom . import four\nimport numpy",
        "p/a/four.py": "from ..c.five import x",
        "p/b/__init__.py": "from p.b.three import y",
        "p/b/two.py": "def f():\n    from p.shown.six import z",
        "p/b/three.py": "y = 1",
        "p/c/__init__.py": "",
        "p/c/five.py": "x = 1",
        "p/shown/six.py": "from p.never import z",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = imported_modules(tmp_path, ["p.a.one"], ["p.shown"])
    assert set(found) == {"p.a", "p.a.one", "p.a.four", "p.b", "p.b.two", "p.b.three"} | {
        "p.c",
        "p.c.five",
    }
    assert "p.never" in imported_modules(tmp_path, ["p.a.one"])


def test_the_diagnosis_imports_the_files_that_decide() -> None:
    start = [f"{package}.{file.stem}" for package in DIAGNOSES for file in _files(package)]
    found = imported_modules(PYTHON, start)
    assert {"cyclosweep.recording.recording", "cyclosweep.design.drive"} <= set(found)
    assert not any(name.startswith("cyclosweep.sweep") for name in found)


def _files(package: str) -> list[Path]:
    """Modules at the top of a package."""
    return [f for f in (PYTHON / Path(*package.split("."))).glob("*.py") if f.stem != "__init__"]


def test_the_form_of_a_source_keeps_what_it_does() -> None:
    plain = 'def f(a: int = 1) -> str:\n    return f"{a}!"\n'
    worded = '"""Head."""\n\ndef f(\n    a: int = 1,  # a remark\n) -> str:\n    """Words."""\n'
    worded += '    return f"{a}!"\n"""Words on what is above."""\n'
    assert syntax(plain) == syntax(worded)
    for other in ("a: int = 2", "a: int = 1.0", "b: int = 1", "a: int = True"):
        assert syntax(plain) != syntax(plain.replace("a: int = 1", other))


@pytest.mark.parametrize(
    ("source", "bare"),
    [
        ("let  a = 1 ; // one\nlet b=2;", "let a=1;let b=2;"),
        ("a /* x /* y */ z */ b", "a b"),
        ('let s = "a // b /* c";', 'let s="a // b /* c";'),
        (r'"a\" // b" // c', r'"a\" // b"'),
        ('r#"a " // b"# // c', 'r#"a " // b"#'),
        ("x == '\"' // c", "x=='\"'"),
        (r"x == '\'' // c", r"x=='\''"),
        ("fn f<'a>(x: &'a str) // 'b'", "fn f<'a>(x:&'a str)"),
    ],
)
def test_rust_without_comments(source: str, bare: str) -> None:
    assert bare_rust(source) == bare
