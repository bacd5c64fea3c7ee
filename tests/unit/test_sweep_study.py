"""Spaces and study files: what they give, and one clear line for whatever is wrong."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import cyclosweep as cs
from cyclosweep.design.units import quantity

DRIVE = cs.Drive.reference_87()
E: dict[str, Any] = {"eccentricity_mm": (0.3, 0.8)}

# A space that makes no sense, and what its line must name.
WRONG_SPACES: list[tuple[Callable[[], Any], tuple[str, ...]]] = [
    (lambda: cs.Space.grid(DRIVE, eccentricty_mm=[1]), ("eccentricty_mm", "mean eccentricity_mm?")),
    (lambda: cs.Space.grid(DRIVE, shaft_9_length_mm=[1]), ("shaft_9_length_mm", "no such input")),
    (lambda: cs.Space.grid(DRIVE, shaft_2_keyway_depth_mm=[1]), ("shaft_2_keyway_depth_mm",)),
    (lambda: cs.Space.grid(DRIVE, eccentricity_mm=[]), ("eccentricity_mm", "no values")),
    (lambda: cs.Space.grid(DRIVE, eccentricity_mm=["0.5"]), ("eccentricity_mm", "'0.5'", "number")),
    (lambda: cs.Space.grid(DRIVE, eccentricity_mm=[True]), ("eccentricity_mm", "True", "number")),
    (
        lambda: cs.Space.grid(DRIVE, eccentricity_mm=cast("list[float]", [None])),
        ("eccentricity_mm", "None", "number"),
    ),
    (
        lambda: cs.Space.grid(DRIVE, eccentricity_mm=cast("list[float]", 0.5)),
        ("eccentricity_mm", "0.5", "list"),
    ),
    (lambda: cs.Space.grid(DRIVE, eccentricity_mm="0.5"), ("eccentricity_mm", "'0.5'", "list")),
    (lambda: cs.Space.grid(DRIVE, criterion=["inner"]), ("criterion", "'inner'", "published-map")),
    (lambda: cs.Space.grid(DRIVE, criterion=[0]), ("criterion", "0", "published-map")),
    (lambda: cs.Space.grid(DRIVE, criterion=cs.linspace(0, 2, 3)), ("criterion", "list")),
    (lambda: cs.Space.grid(DRIVE, eccentricity_mm=cs.linspace(0, 1, 0)), ("eccentricity_mm", "0")),
    (lambda: cs.Space.grid(DRIVE, ratio=cs.linspace(3, 300, 5)), ("ratio", "whole")),
    (
        lambda: cs.Space.grid(
            DRIVE,
            eccentricity_mm=cs.linspace(0, 1, 2**32),
            bush_wall_mm=cs.linspace(0, 1, 2**32),
        ),
        ("2^63",),
    ),
    (lambda: cs.linspace(0, 1, 2.5), ("steps", "2.5", "whole")),  # type: ignore[arg-type]
    (lambda: cs.linspace("0", 1, 2), ("start", "'0'", "number")),  # type: ignore[arg-type]
    (lambda: cs.linspace(0, float("nan"), 2), ("stop", "nan", "finite")),
    (lambda: cs.linspace(0, True, 2), ("stop", "True", "number")),
    (lambda: cs.Space.sobol(DRIVE, 8), ("sobol", "no axes")),
    (lambda: cs.Space.sobol(DRIVE, 0, **E), ("count", "0", "above zero")),
    (lambda: cs.Space.sobol(DRIVE, 1.5, **E), ("count", "1.5", "whole")),  # type: ignore[arg-type]
    (lambda: cs.Space.sobol(DRIVE, True, **E), ("count", "True", "whole")),
    (lambda: cs.Space.sobol(DRIVE, 2**63 + 1, **E), ("count", "2^63")),
    (lambda: cs.Space.sobol(DRIVE, 8, seed=-1, **E), ("seed", "-1")),
    (lambda: cs.Space.sobol(DRIVE, 8, seed=2**64, **E), ("seed",)),
    (lambda: cs.Space.sobol(DRIVE, 8, seed="a", **E), ("seed", "'a'")),  # type: ignore[arg-type]
    (lambda: cs.Space.sobol(DRIVE, 8, seed=1.5, **E), ("seed", "1.5")),  # type: ignore[arg-type]
    (lambda: cs.Space.random(DRIVE, 8, eccentricity_mm=(0.8, 0.3)), ("eccentricity_mm", "0.8")),
    (lambda: cs.Space.random(DRIVE, 8, eccentricity_mm=(0, float("inf"))), ("eccentricity_mm",)),
    (lambda: cs.Space.random(DRIVE, 8, ratio=(3.5, 10)), ("ratio", "whole")),
    (
        lambda: cs.Space.random(DRIVE, 8, eccentricity_mm=cast("list[float]", 0.5)),
        ("eccentricity_mm", "0.5"),
    ),
    (lambda: cs.Space.random(DRIVE, 8, eccentricity_mm=("a", "b")), ("eccentricity_mm", "'a'")),
    (lambda: cs.Space.table(DRIVE, pl.DataFrame({"e": [1.0]})), ("e: no such input",)),
    (lambda: cs.Space.table(DRIVE, pl.DataFrame({"ratio": ["a"]})), ("ratio", "String", "numbers")),
    (lambda: cs.Space.table(DRIVE, pl.DataFrame({"ratio": [True]})), ("ratio", "Bool", "numbers")),
    (lambda: cs.Space.table(DRIVE, pl.DataFrame({"criterion": [None]})), ("criterion", "None")),
]


@pytest.mark.parametrize(("make", "words"), WRONG_SPACES)
def test_a_space_that_makes_no_sense(make: Callable[[], Any], words: tuple[str, ...]) -> None:
    with pytest.raises(cs.InputError) as caught:
        make()
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message, message


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"loads_tn": [1, 0]}, ("loads_tn", "0", "above zero")),
        ({"loads_tn": [float("inf")]}, ("loads_tn", "inf")),
        ({"loads_tn": [float("nan")]}, ("loads_tn", "nan")),
        ({"loads_tn": [1, 1.0]}, ("loads_tn", "once")),
        ({"loads_tn": [-0.0]}, ("loads_tn", "0", "below zero for the other direction")),
        ({"loads_tn": [-math.inf]}, ("loads_tn", "-inf")),
        ({"loads_tn": [np.float64("nan")]}, ("loads_tn", "nan")),
        ({"loads_tn": [True]}, ("loads_tn", "True", "number")),
        ({"loads_tn": ["1"]}, ("loads_tn", "'1'", "number")),
        ({"loads_tn": "1"}, ("loads_tn", "'1'", "list")),
        ({"loads_tn": 2.0}, ("loads_tn", "2.0", "list")),
        ({"limits": {"web": (1, 2)}}, ("limits.web", "no such column")),
        ({"limits": {"criterion": (1, 2)}}, ("limits.criterion",)),
        ({"limits": {"status": (1, 2)}}, ("limits.status",)),
        ({"limits": {"hole_web_mm": (3, 2)}}, ("limits.hole_web_mm", "min <= max")),
        ({"limits": {"hole_web_mm": (float("nan"), 2)}}, ("limits.hole_web_mm",)),
        ({"limits": {"hole_web_mm": (None, None)}}, ("limits.hole_web_mm", "neither min nor max")),
        ({"solver": "full"}, ("solver: found 'full' with the published model", "components")),
        ({"limits": {"hole_web_mm": ("2", None)}}, ("limits.hole_web_mm", "'2'", "number")),
        ({"objective": cs.Objective("web")}, ("objective", "web")),
    ],
)
def test_a_study_that_makes_no_sense(options: dict[str, Any], words: tuple[str, ...]) -> None:
    with pytest.raises(cs.InputError) as caught:
        cs.Study.of(cs.Space.grid(DRIVE), **options)
    for word in words:
        assert word in str(caught.value), caught.value


def test_tables_keep_their_rows(reference: cs.Drive) -> None:
    frame = pl.DataFrame(
        {
            "eccentricity_mm": [0.5, 0.6, None, float("nan"), 0.7],
            "criterion": ["inside", "statics", "inside", "published-map", "statics"],
            "output_pin_count": pl.Series([8, 9, 8, 8, 10], dtype=pl.Int8),
        }
    )
    swept = cs.sweep(cs.Space.table(reference, frame))
    statuses = ["ok", "ok", "non_finite_input", "non_finite_input", "ok"]
    assert swept["status"].to_list() == statuses
    assert swept["criterion"].cast(pl.String).to_list() == frame["criterion"].to_list()
    assert swept["output_pin_count"].to_list() == [8, 9, 8, 8, 10]
    assert swept["eccentricity_mm"].to_list()[:2] == [0.5, 0.6]
    for k in (0, 1, 4):
        name, value = "eccentricity_mm", frame["eccentricity_mm"][k]
        drive = reference.replace(
            **{name: value},
            criterion=frame["criterion"][k],
            output_pin_count=frame["output_pin_count"][k],
        )
        assert swept["twist_1tn_deg"][k] == drive.evaluate()["twist_1tn_deg"]


def test_the_column_of_a_negative_load_has_a_name_of_its_own(reference: cs.Drive) -> None:
    frame = cs.sweep(cs.Space.grid(reference), loads_tn=[4.5, -4.5])
    assert frame.columns[-2:] == ["twist_4p5tn_deg", "twist_minus_4p5tn_deg"]
    assert quantity("twist_minus_4p5tn_deg").unit == "deg"
    assert "under -4.5 T_N" in quantity("twist_minus_4p5tn_deg").meaning


@pytest.mark.parametrize("load", [0.5, 1, 4.5])
def test_a_negative_load_twists_as_far_the_other_way(reference: cs.Drive, load: float) -> None:
    frame = cs.sweep(cs.Space.grid(reference, output_pin_count=[6, 8]), loads_tn=[load, -load])
    forth, back = (name for name in frame.columns if name.startswith("twist"))
    assert back == forth.replace("twist_", "twist_minus_")
    assert frame[back].to_list() == (-frame[forth]).to_list()
    assert all(value > reference.free_play_deg for value in frame[forth])
    alone = reference.evaluate((load, -load))
    assert alone[back] == -alone[forth]  # type: ignore[operator]
    unit = quantity(back)
    assert (unit.unit, f" -{load:g} T_N" in unit.meaning) == ("deg", True)


def test_numbers_of_numpy_make_the_same_study(reference: cs.Drive) -> None:
    axes: dict[str, Any] = {"eccentricity_mm": (0.3, 0.8), "output_pin_count": (6, 12)}
    plain = cs.Space.sobol(reference, 16, seed=3, **axes)
    wrapped = {name: tuple(map(np.int64, v)) for name, v in axes.items() if name.endswith("count")}
    numpy = cs.Space.sobol(reference, np.int32(16), seed=np.uint64(3), **{**axes, **wrapped})  # type: ignore[arg-type]
    loads: Any = np.array([1, 2])
    assert cs.Study.of(numpy, loads_tn=loads).hash == cs.Study.of(plain, loads_tn=[1, 2]).hash
    grid = cs.Space.grid(
        reference,
        output_pin_count=np.array([6, 8], dtype=np.uint8),
        eccentricity_mm=cs.linspace(np.float32(0.25), np.float64(0.75), np.int64(3)),  # type: ignore[arg-type]
    )
    listed = cs.Space.grid(reference, output_pin_count=[6, 8], eccentricity_mm=[0.25, 0.5, 0.75])
    assert_frame_equal(cs.sweep(grid), cs.sweep(listed), check_exact=True)
    four, other, part = cast("tuple[Any, Any, Any]", (np.int64(4), np.uint8(4), np.int16(1)))
    assert grid[four] == grid[4] == grid[other] == grid[-2]
    assert_frame_equal(cs.sweep(grid[part:four]), cs.sweep(grid[1:4]))
    with pytest.raises(TypeError):
        grid[1.0]  # type: ignore[call-overload]


def test_a_space_is_sampled_over_any_collection_of_values(reference: cs.Drive) -> None:
    listed = cs.Space.random(reference, 20, output_pin_count=[6, 7, 8, 9])
    for values in (range(6, 10), np.arange(6, 10), pl.Series([6, 7, 8, 9]), iter([6, 7, 8, 9])):
        space = cs.Space.random(reference, 20, output_pin_count=values)
        assert cs.Study.of(space).hash == cs.Study.of(listed).hash


def test_any_loads(reference: cs.Drive) -> None:
    frame = cs.sweep(cs.Space.grid(reference), loads_tn=[0.25, 10, 1e-3])
    twists = [name for name in frame.columns if name.startswith("twist")]
    assert twists == ["twist_0p25tn_deg", "twist_10tn_deg", "twist_0p001tn_deg"]
    slope = (frame["twist_10tn_deg"][0] - 28) / 10
    assert frame["twist_0p25tn_deg"][0] == pytest.approx(28 + slope / 4, rel=1e-13)
    assert cs.sweep(cs.Space.grid(reference), loads_tn=[]).columns[-1] == "pin_bending_stress_mpa"


def study_file(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


SAMPLED = """
drive = "reference-87"
[sample]
method = "{method}"
count = 50
seed = 3
[axes]
eccentricity_mm = {{ from = 0.3, to = 0.8 }}
output_pin_count = {{ from = 6, to = 12 }}
bush_wall_mm = {{ values = [1, 2.5] }}
"""


@pytest.mark.parametrize(
    ("method", "make"),
    [
        ("sobol", cs.Space.sobol),
        ("latin-hypercube", cs.Space.latin_hypercube),
        ("random", cs.Space.random),
    ],
)
def test_a_sampled_study_file(tmp_path: Path, method: str, make: Any) -> None:
    study = cs.Study.from_toml(study_file(tmp_path, SAMPLED.format(method=method)))
    axes = {"output_pin_count": (6, 12), "bush_wall_mm": [1, 2.5]}
    space = make(DRIVE, 50, seed=3, eccentricity_mm=(0.3, 0.8), **axes)
    assert study.hash == cs.Study.of(space).hash
    assert_frame_equal(cs.sweep(study), cs.sweep(space), check_exact=True)


def test_steps_of_a_drawn_axis_are_the_values_among_which_is_drawn(tmp_path: Path) -> None:
    study = cs.Study.from_toml(study_file(tmp_path, AXIS + SOBOL))
    found = cs.sweep(study)["eccentricity_mm"].unique().sort().to_list()
    assert found == pytest.approx([0.3, 0.55, 0.8])


def test_a_grid_study_file(tmp_path: Path) -> None:
    path = study_file(
        tmp_path,
        """
        loads_tn = [1, 4.5]
        [axes]
        eccentricity_mm = { from = 0.3, to = 0.8, steps = 6 }
        output_pin_count = { from = 6, to = 9 }
        criterion = { values = ["inside", "statics"] }
        [limits]
        hole_web_mm = { min = 2.0 }
        [objective]
        minimise = "reflected_compliance_rad_per_nm"
        """,
    )
    study = cs.Study.from_toml(path)
    assert len(study) == 6 * 4 * 2
    assert study.loads_tn == (1.0, 4.5)
    assert study.objective == cs.Objective("reflected_compliance_rad_per_nm")
    frame = cs.sweep(study)
    assert frame["eccentricity_mm"].unique().sort().to_list() == list(np.linspace(0.3, 0.8, 6))
    assert frame["output_pin_count"].unique().sort().to_list() == [6, 7, 8, 9]
    assert "twist_4p5tn_deg" in frame.columns
    assert "twist_2tn_deg" not in frame.columns


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_table_study_file(tmp_path: Path, suffix: str) -> None:
    frame = pl.DataFrame({"eccentricity_mm": [0.4, 0.6], "criterion": ["inside", "statics"]})
    path = tmp_path / f"variants.{suffix}"
    frame.write_csv(path) if suffix == "csv" else frame.write_parquet(path)
    DRIVE.to_toml(tmp_path / "mine.toml")
    file = study_file(
        tmp_path,
        f'drive = "mine.toml"\n[sample]\nmethod = "table"\nfile = "variants.{suffix}"\n',
    )
    expected = cs.sweep(cs.Space.table(DRIVE, frame))
    assert_frame_equal(cs.sweep(cs.Study.from_toml(file)), expected, check_exact=True)


AXIS = "[axes]\neccentricity_mm = { from = 0.3, to = 0.8, steps = 3 }\n"
TABLE = '[sample]\nmethod = "table"\n'
SOBOL = '[sample]\nmethod = "sobol"\ncount = 8\n'

WRONG_FILES: list[tuple[str, tuple[str, ...]]] = [
    ("", ("axes", "none")),
    ("axes = 3", ("axes", "3")),
    ("drive = 3\n" + AXIS, ("drive", "3", "string")),
    ('drive = "reference-88"\n' + AXIS, ("reference-88", "no such built-in drive")),
    ('drive = "other.toml"\n' + AXIS, ("other.toml", "No such file")),
    ("speed = 3\n" + AXIS, ("speed", "unknown key")),
    ("loads_tn = [0]\n" + AXIS, ("loads_tn", "0")),
    ('loads_tn = ["1"]\n' + AXIS, ("loads_tn", "'1'", "number")),
    ("loads_tn = [nan]\n" + AXIS, ("loads_tn", "nan", "above zero")),
    ("loads_tn = [1e-300]\n" + AXIS, ("loads_tn", "1e-300", "from 1e-06 to 1e+06")),
    ("loads_tn = [1, -1e308]\n" + AXIS, ("loads_tn", "-1e+308", "from 1e-06 to 1e+06")),
    ("loads_tn = [-inf]\n" + AXIS, ("loads_tn", "-inf", "above zero")),
    (AXIS + '[sample]\nmethod = "halton"', ("sample.method", "halton", "sobol")),
    (AXIS + "[sample]\ncount = 3", ("sample.count", "grid")),
    (AXIS + '[sample]\nmethod = "sobol"', ("sample.count", "missing")),
    (AXIS + '[sample]\nmethod = "sobol"\ncount = 0', ("sample.count", "0")),
    (AXIS + '[sample]\nmethod = "sobol"\ncount = 1.5', ("sample.count", "1.5")),
    (AXIS + '[sample]\nmethod = "sobol"\ncount = true', ("sample.count", "True")),
    (AXIS + SOBOL + "seed = -1", ("sample.seed", "-1")),
    (AXIS + SOBOL + "file = 'a.csv'", ("sample.file", "table")),
    (TABLE, ("sample.file", "missing")),
    (TABLE + "file = 'a.csv'", ("a.csv", "No such file")),
    (TABLE + "file = 'a.csv'\n" + AXIS, ("axes", "table")),
    ("[axes]\neccentricty_mm = { values = [1] }", ("eccentricty_mm", "mean eccentricity_mm?")),
    (
        "[axes]\neccentricity_mm = { values = [] }",
        ("eccentricity_mm.values: found [], expected at least 1",),
    ),
    ("[axes]\neccentricity_mm = { values = ['a'] }", ("eccentricity_mm", "'a'", "number")),
    ("[axes]\neccentricity_mm = { values = [true] }", ("axes.eccentricity_mm", "True", "number")),
    ("[axes]\neccentricity_mm = { values = 3 }", ("axes.eccentricity_mm", "3", "list")),
    ("[axes]\neccentricity_mm = 0.5", ("axes.eccentricity_mm", "0.5")),
    ("[axes]\neccentricity_mm = { from = 0.3, to = 0.8 }", ("axes.eccentricity_mm.steps",)),
    ("[axes]\neccentricity_mm = { from = 0.3 }", ("axes.eccentricity_mm", "to", "missing")),
    ("[axes]\neccentricity_mm = { from = '0', to = 1 }", ("axes.eccentricity_mm", "'0'")),
    ("[axes]\neccentricity_mm = { from = 0, to = inf, steps = 2 }", ("eccentricity_mm", "inf")),
    ("[axes]\neccentricity_mm = { from = 0, to = 1, steps = 0 }", ("eccentricity_mm", "0")),
    ("[axes]\neccentricity_mm = { from = 0, to = 1, steps = 2.5 }", ("eccentricity_mm", "2.5")),
    ("[axes]\neccentricity_mm = { from = 0, to = 1, step = 2 }", ("step", "unknown key")),
    ("[axes]\nratio = { from = 3.5, to = 9 }", ("ratio", "3.5", "whole")),
    ("[axes]\nratio = { values = [6.5, 12] }", ("axes.ratio: found 6.5, expected whole numbers",)),
    ("[axes]\nratio = { from = 9, to = 3 }", ("ratio", "9", "3")),
    ("[axes]\nratio = { from = 3, to = 300, steps = 7 }", ("ratio", "whole")),
    (AXIS + "[limits]\nweb = { min = 1 }", ("limits.web", "no such column")),
    (AXIS + "[limits]\nhole_web_mm = { min = '1' }", ("limits.hole_web_mm.min", "'1'")),
    (AXIS + "[limits]\nhole_web_mm = { low = 1 }", ("limits.hole_web_mm.low", "unknown key")),
    (AXIS + "[limits]\nhole_web_mm = {}", ("limits.hole_web_mm", "neither min nor max")),
    ('solver = "full"\n' + AXIS, ("solver: found 'full' with the published model",)),
    ('model = "components"\n' + AXIS, ("lacks ring_pin_radius_mm and disc_width_mm",)),
    (AXIS + "[limits]\nhole_web_mm = 3", ("limits.hole_web_mm", "3")),
    (AXIS + "[objective]\nminimise = 'web'", ("objective", "web")),
    (AXIS + "[objective]\nminimize = 'hole_web_mm'", ("objective.minimize", "unknown key")),
    (AXIS + "[objective]", ("objective", "minimise or maximise")),
    (AXIS + "[axes]", ("not valid TOML",)),
]


@pytest.mark.parametrize(("text", "words"), WRONG_FILES)
def test_one_clear_line_for_what_is_wrong(
    tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    path = study_file(tmp_path, text)
    with pytest.raises(cs.InputError) as caught:
        cs.Study.from_toml(path)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    for word in words:
        assert word in message, message


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("eccentricity\n0.5\n", ("variants.csv", "eccentricity", "did you mean")),
        ("eccentricity_mm\nhalf\n", ("variants.csv", "row 2, eccentricity_mm", "a number")),
        ("", ("variants.csv",)),
        ("criterion\ninner\n", ("variants.csv", "criterion", "'inner'")),
    ],
)
def test_a_table_that_makes_no_sense(tmp_path: Path, content: str, words: tuple[str, ...]) -> None:
    (tmp_path / "variants.csv").write_text(content)
    with pytest.raises(cs.InputError) as caught:
        cs.Study.from_toml(study_file(tmp_path, TABLE + 'file = "variants.csv"\n'))
    for word in words:
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("count", [2**40, 2**53 + 1])
def test_a_huge_whole_axis_costs_no_memory(reference: cs.Drive, count: int) -> None:
    with pytest.raises(cs.InputError, match="whole"):
        cs.Space.grid(reference, ratio=cs.linspace(3, 300, count))
