"""The tool that compares the diagnoses of two versions of the code."""

import importlib.util
import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

TOOL = Path(__file__).parents[3] / "proof" / "same_diagnosis.py"


@pytest.fixture(scope="module")
def tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("same_diagnosis", TOOL)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


ANSWER = {"verdict": "IDENTIFIED", "rms": 0.25, "found": [{"name": "creep", "p": None}]}


@pytest.mark.parametrize(
    ("change", "found"),
    [
        ({}, []),
        ({"rms": 0.25 + 1e-10}, []),
        ({"rms": 0.25 + 2e-9}, ["/rms: 0.25, then 0.250000002"]),
        ({"provenance": "another version"}, []),
        ({"verdict": "AMBIGUOUS"}, ["/verdict: 'IDENTIFIED', then 'AMBIGUOUS'"]),
        ({"rms": True}, ["/rms: 0.25, then True"]),
        ({"found": []}, ["/found: 1 entries, then 0"]),
        (
            {"found": [{"name": "drag", "p": None}]},
            ["/found[0]/name: 'creep', then 'drag'"],
        ),
    ],
)
def test_every_kind_of_difference_is_seen(
    tool: ModuleType, change: dict[str, object], found: list[str]
) -> None:
    before = ANSWER | {"provenance": "a version"}
    assert tool.differences(before, ANSWER | {"provenance": "", "new": 1.0} | change) == found


def test_a_key_that_is_gone_is_a_difference(tool: ModuleType) -> None:
    assert tool.differences(ANSWER, {"verdict": "IDENTIFIED", "rms": 0.25}) == ["/found: gone"]


def test_exit_status_says_whether_all_is_the_same(
    tool: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def written(name: str, content: object) -> Path:
        (tmp_path / name).write_text(json.dumps(content))
        return tmp_path / name

    compare: Callable[[Path, Path], int] = tool.compare
    one = written("a.json", {"case-1": ANSWER, "case-2": ANSWER})
    assert compare(one, one) == 0
    assert "2 with the same verdict, 2 the same in every word" in capsys.readouterr().out
    other = written("b.json", {"case-1": ANSWER, "case-2": ANSWER | {"verdict": "AMBIGUOUS"}})
    assert compare(one, other) == 1
    assert "1 with the same verdict, 1 the same in every word" in capsys.readouterr().out
    assert compare(one, written("c.json", {"case-1": ANSWER})) == 1
    assert compare(written("d.json", {}), written("e.json", {})) == 1
