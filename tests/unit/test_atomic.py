"""Files appear whole or not at all."""

from __future__ import annotations

import ast
import os
from pathlib import Path

import pytest

import cyclosweep as cs
from cyclosweep.atomic import unfinished, write_bytes, write_text


def test_text_and_bytes_arrive_as_they_are(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "1 °C\n")
    write_bytes(tmp_path / "b.bin", b"\0\xff")
    assert (tmp_path / "a.txt").read_bytes() == "1 °C\n".encode()
    assert (tmp_path / "b.bin").read_bytes() == b"\0\xff"


def write_half(file: Path) -> None:
    with unfinished(file) as temporary:
        temporary.write_text("aft")
        raise RuntimeError("half way")


def test_a_failure_leaves_what_was_there_and_nothing_else(tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    file.write_text("before")
    with pytest.raises(RuntimeError, match="half way"):
        write_half(file)
    assert [path.name for path in tmp_path.iterdir()] == ["result.json"]
    assert file.read_text() == "before"


def test_until_it_is_whole_the_old_content_stands(tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    file.write_text("before")
    with unfinished(file) as temporary:
        temporary.write_text("after")
        assert temporary.parent == file.parent
        assert file.read_text() == "before"
    assert file.read_text() == "after"


def test_a_text_that_cannot_be_encoded_leaves_the_file(tmp_path: Path) -> None:
    file = tmp_path / "result.json"
    file.write_text("before")
    with pytest.raises(UnicodeEncodeError):
        write_text(file, "\ud800")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["before"]


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    file, link = tmp_path / "file", tmp_path / "link"
    file.write_text("before")
    link.symlink_to(file)
    write_text(link, "after")
    assert link.is_symlink()
    assert file.read_text() == "after"


@pytest.mark.skipif(not os.path.exists("/dev/null"), reason="no /dev/null on this system")
def test_what_is_no_regular_file_is_written_directly() -> None:
    write_text("/dev/null", "gone")
    assert not Path("/dev/null").is_file()


def test_a_folder_in_its_place_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=tmp_path.name):
        write_text(tmp_path, "text")


def test_nothing_is_written_by_hand() -> None:
    by_hand = []
    for path in sorted(Path(cs.__file__).parent.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if path.name == "atomic.py" or not isinstance(node, ast.Call):
                continue
            called = ast.unparse(node.func)
            is_write = called.endswith((".write_text", ".write_bytes")) or called == "os.replace"
            modes = [a.value for a in node.args if isinstance(a, ast.Constant)]
            is_open = called.endswith("open") and any(
                mode in ("w", "wb", "a", "x") for mode in modes
            )
            if is_write or is_open:
                by_hand.append(f"{path.name}: {ast.unparse(node)}")
    assert by_hand == []
