"""Which code a record was made with: hashes over what decides its numbers, and the commit.

The hash of the diagnosis covers every module of cyclosweep that `cyclosweep.diagnosis` and
`cyclosweep.simulation` import, directly or through others, the built-in drives beside them and the
compiled kernel; that of the generator covers what `cyclosweep_challenge.trial.plan` imports. Python
counts as its syntax tree without docstrings, Rust without comments and white space. A comment, a
docstring or a module that is not imported (a sweep, the command line) therefore leaves a record
valid; a changed constant does not. Reports are imported to be written and decide nothing: they are
left out.
"""

from __future__ import annotations

import ast
import hashlib
import json
import re
import subprocess
import tomllib
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path

PYTHON = Path(__file__).parents[2]
"""Folder that holds both packages."""
DIAGNOSES = ("cyclosweep.diagnosis", "cyclosweep.simulation")
"""Packages whose modules, with all that they import, diagnose and predict."""
MAKES_RECORDINGS = ("cyclosweep_challenge.trial.plan",)
"""Module that, with all that it imports, makes recordings and answers."""
DECIDES_NOTHING = ("cyclosweep.report", "cyclosweep.cli", "cyclosweep.reference")
"""Packages that show results; what only they import is left out as well."""
SOURCES = 1024
"""Sources of which what was found is remembered."""
RUST = re.compile(
    r"""
    (?P<raw>b?r(?P<hashes>\#*)".*?"(?P=hashes))   # raw strings
    | (?P<string>"(?:\\.|[^"\\])*")
    | (?P<char>'(?:\\.[^']*|[^'\\])')             # a lifetime has no closing quote
    | (?P<line>//[^\n]*)
    | (?P<block>/\*)
    | (?P<space>\s+)
    | (?P<word>\w+)
    | (?P<sign>.)
    """,
    re.VERBOSE | re.DOTALL,
)
"""The smallest parts of a Rust source."""


def diagnosis_hash(python: Path = PYTHON) -> str:
    """SHA-256 over all that diagnoses and predicts; see the head of this file.

    The compiled kernel counts with all files of ``rust/src`` beside ``python``, those of the sweep
    among them: which functions a module calls cannot be read from them alone. An installed package
    has no such folder, and its kernel does not count.

    Parameters
    ----------
    python : pathlib.Path
        Folder that holds the package ``cyclosweep``.
    """
    modules = imported_modules(python, _modules_of(python, DIAGNOSES), DECIDES_NOTHING)
    parts = {name: syntax(file.read_text("utf-8")) for name, file in modules.items()}
    for folder in {file.parent for file in modules.values()}:
        for file in folder.glob("*.toml"):
            content = tomllib.loads(file.read_text("utf-8"))
            parts[file.relative_to(python).as_posix()] = json.dumps(content, sort_keys=True)
    rust = python.parent / "rust" / "src"
    if rust.is_dir():
        for file in rust.rglob("*.rs"):
            parts[file.relative_to(rust).as_posix()] = bare_rust(file.read_text("utf-8"))
    return _hash(parts)


def rig_hash(python: Path = PYTHON) -> str:
    """SHA-256 over all that makes recordings and answers; see the head of this file.

    Parameters
    ----------
    python : pathlib.Path
        Folder that holds the package ``cyclosweep_challenge``.
    """
    return source_hash(python, MAKES_RECORDINGS)


def source_hash(python: Path, start: Sequence[str], left_out: Sequence[str] = ()) -> str:
    """SHA-256 over some modules and all that they import; see the head of this file.

    Parameters
    ----------
    python : pathlib.Path
        Folder that holds the outermost packages.
    start : sequence of str
        Modules to begin with.
    left_out : sequence of str
        Packages that are not followed.
    """
    modules = imported_modules(python, start, left_out)
    return _hash({name: syntax(file.read_text("utf-8")) for name, file in modules.items()})


def _hash(parts: Mapping[str, str]) -> str:
    """One hash over names and contents."""
    lines = "".join(
        f"{name} {hashlib.sha256(text.encode()).hexdigest()}\n"
        for name, text in sorted(parts.items())
    )
    return hashlib.sha256(lines.encode()).hexdigest()


def _modules_of(python: Path, packages: Sequence[str]) -> list[str]:
    """Every module of some packages."""
    return [
        ".".join(file.relative_to(python).with_suffix("").parts).removesuffix(".__init__")
        for package in packages
        for file in (python / Path(*package.split("."))).rglob("*.py")
    ]


def imported_modules(
    python: Path, start: Sequence[str], left_out: Sequence[str] = ()
) -> dict[str, Path]:
    """Modules that some modules import, those themselves among them, by name.

    Imports inside functions count. Of a package on the way to a module its ``__init__`` counts,
    except that of the outermost package, which imports everything to offer it to users.

    Parameters
    ----------
    python : pathlib.Path
        Folder that holds the outermost packages.
    start : sequence of str
        Modules to begin with.
    left_out : sequence of str
        Packages that are not followed.
    """
    found: dict[str, Path] = {}
    waiting = list(start)
    while waiting:
        name = waiting.pop()
        file = _file(python, name)
        inside_left_out = any(name == p or name.startswith(f"{p}.") for p in left_out)
        if name in found or file is None or "." not in name or inside_left_out:
            continue
        found[name] = file
        parts = name.split(".")
        waiting += [".".join(parts[:k]) for k in range(2, len(parts))]
        waiting += _imports(file.read_text("utf-8"), name, file.name == "__init__.py")
    return found


def _file(python: Path, name: str) -> Path | None:
    """Source file of a module or package; None if it is neither."""
    path = python / Path(*name.split("."))
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file
    return None


@lru_cache(maxsize=SOURCES)
def _imports(source: str, name: str, is_package: bool) -> tuple[str, ...]:
    """Names of what a module imports: modules, and what may be a module or a name in one."""
    found: list[str] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            # One dot stands for the package of the module, each further one for that above.
            up = len(name.split(".")) - node.level + (1 if is_package else 0)
            above = name.split(".")[:up] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            found += [base, *(f"{base}.{alias.name}" for alias in node.names)]
    return tuple(found)


@lru_cache(maxsize=SOURCES)
def syntax(source: str) -> str:
    """Syntax tree of a Python source as text, without docstrings, comments and positions.

    The form does not depend on the version of Python: fields that are empty are left out.
    """
    return _node(ast.parse(source))


def _node(value: object) -> str:
    """Text of a node, a list of nodes or a constant."""
    if isinstance(value, ast.AST):
        fields = [
            f"{name}={_node(field)}"
            for name, field in ast.iter_fields(value)
            if field not in (None, []) and name not in {"kind", "type_comment"}
        ]
        return f"{type(value).__name__}({','.join(fields)})"
    if isinstance(value, list):
        return f"[{','.join(_node(item) for item in value if not _is_text(item))}]"
    return repr(value)


def _is_text(node: object) -> bool:
    """Whether a statement is a docstring, or a string beside an attribute: it does nothing."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


@lru_cache(maxsize=SOURCES)
def bare_rust(source: str) -> str:
    """Rust source without comments and white space; what stands in quotes is left as it is.

    Words that only white space or a comment keeps apart stay apart by one space.
    """
    out: list[str] = []
    place, after_word = 0, False
    while (match := RUST.match(source, place)) is not None:
        place = match.end()
        if match["block"] is not None:
            place = _block_end(source, place)
        elif match["line"] is None and match["space"] is None:
            is_word = match["word"] is not None
            out.append(f" {match[0]}" if is_word and after_word else match[0])
            after_word = is_word
    return "".join(out)


def _block_end(source: str, place: int) -> int:
    """End of a block comment, which may hold others."""
    depth = 1
    while depth and place < len(source):
        if source.startswith("/*", place):
            depth, place = depth + 1, place + 2
        elif source.startswith("*/", place):
            depth, place = depth - 1, place + 2
        else:
            place += 1
    return place


def commit(package: Path = PYTHON) -> str:
    """Commit of the source tree, with a plus where files differ from it; empty without one."""

    def git(*words: str) -> str:
        done = subprocess.run(
            ["git", *words], cwd=package, capture_output=True, text=True, check=False
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    try:
        name = git("rev-parse", "HEAD")
        changed = git("status", "--porcelain", "--", ".")
    except OSError:
        return ""
    return name + ("+" if name and changed else "")


@cache
def code(python: Path = PYTHON) -> Mapping[str, str]:
    """Hashes that must not change within a record; those of the code that this process runs."""
    return {"diagnosis": diagnosis_hash(python), "rig": rig_hash(python)}
