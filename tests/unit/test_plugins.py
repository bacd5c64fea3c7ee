"""A module of one's own brings effect, column and constraint, also on the command line."""

from __future__ import annotations

import itertools
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep import plugins
from cyclosweep.diagnosis import folder as folders
from cyclosweep.simulation import effects
from tests.support.own_modules import registered_for_now

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples" / "plugins"


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run the command line in a folder."""
    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", *arguments],
        cwd=cwd, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.fixture
def washers() -> Iterator[Path]:
    """The example's file, with what this process has registered put back afterwards."""
    with registered_for_now():
        yield EXAMPLES / "washers.py"


def with_washers() -> cs.Recording:
    """A recording of a drive with spring washers."""
    washers = cs.simulation.simulate.EffectValue("spring_washer", {"preload_nm": 7.0}, (0.15,))
    ends = (0.4, 24.0, -24.0, 12.0, -6.0, 20.0, 0.4)
    torque = np.concatenate([np.linspace(a, b, 120) for a, b in itertools.pairwise(ends)])
    load = cs.Recording.from_arrays(torque, name="washers")
    angle = cs.simulate(cs.Model(2.73, 28.0, effects=(washers,)), load).angle_deg
    assert angle is not None
    return load.with_angle(angle + 0.3 * np.random.default_rng(4).standard_normal(len(torque)))


def test_the_page_shows_the_file_of_the_examples(washers: Path) -> None:
    page = (ROOT / "docs" / "plugins.md").read_text("utf-8")
    first = re.search(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert first is not None
    assert first[1] == washers.read_text("utf-8")


def test_a_diagnosis_on_the_command_line_names_an_effect_of_a_plugin(
    washers: Path, tmp_path: Path
) -> None:
    plugins.load(str(washers))
    with_washers().to_frame().write_csv(tmp_path / "loop.csv")
    (tmp_path / "loop.toml").write_text('drive = "reference-87"\n')
    done = run(
        "diagnose", "loop.csv", "--plugin", str(washers), "--quick", "--json", "--out", "out",
        cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert [each["name"] for each in json.loads(done.stdout)["effects"]] == ["spring_washer"]
    model = str(tmp_path / "out" / "model.json")
    without = run("simulate", model, "loop.csv", "--out", "a.csv", cwd=tmp_path)
    assert without.returncode == 2
    assert "spring_washer" in without.stderr
    done = run(
        "simulate", model, "loop.csv", "--plugin", str(washers), "--out", "a.csv", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr


def test_workers_of_a_folder_load_the_plugins(washers: Path, tmp_path: Path) -> None:
    plugins.load(str(washers))
    for name in ("a", "b"):
        with_washers().to_frame().write_csv(tmp_path / f"{name}.csv")
        (tmp_path / f"{name}.toml").write_text('drive = "reference-87"\n')
    found = cs.diagnose_folder(tmp_path, tmp_path / "out", workers=2, full=False)
    assert found.table["status"].to_list() == ["ok", "ok"]
    for name in ("a", "b"):
        answer = cs.Diagnosis.from_json(tmp_path / "out" / name / "diagnosis.json")
        assert [effect.name for effect in answer.answer.effects] == ["spring_washer"]


def test_results_of_a_folder_are_of_their_drive_and_effects(washers: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("torque_nm,angle_deg\n0,28\n")

    def key(drive: cs.Drive | None) -> str:
        task = folders._Task(drive, None, tmp_path, True, False, {})
        return folders._key(path, task, folders._metadata(path, None))

    drive = cs.Drive.reference_87()
    keys = [key(None), key(drive), key(drive.replace(bush_wall_mm=drive.bush_wall_mm + 0.1))]
    plugins.load(str(washers))
    assert len({*keys, key(drive)}) == 4


def test_a_sweep_has_the_column_and_the_constraint(washers: Path) -> None:
    plugins.load(str(washers))
    space = cs.Space.grid(
        cs.Drive.reference_87(), output_pin_count=[6, 12], output_pin_diameter_mm=[16.0]
    )
    table = cs.sweep(space)
    assert table["status"].to_list() == ["ok", "constraint_pins_apart"]
    mass = 6 * np.pi / 4 * 16.0**2 * 40.0 * 7.85e-6
    assert table["output_pin_mass_kg"][0] == pytest.approx(mass)
    assert cs.scan(space).filter(pl.col("output_pin_mass_kg") > 1).collect().height == 0


@pytest.mark.usefixtures("washers")
def test_a_misspelt_need_is_refused_and_one_of_other_studies_leaves_the_column_out() -> None:
    space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 12])

    def zero(rows: pl.DataFrame) -> pl.Series:
        return pl.Series([0.0] * rows.height)

    for needs in (
        ["twist_9tn_deg"],
        ["loaded_twist_arcmin"],
        ["rim_of_mine"],
        ["shaft_9_length_mm"],
    ):
        plugins.COLUMNS["own"] = plugins.Column(zero, needs=needs)
        assert "own" not in cs.sweep(space).columns
    plugins.COLUMNS["own"] = plugins.Column(zero, needs=["output_pin_cout"])
    with pytest.raises(cs.InputError) as caught:
        cs.sweep(space)
    assert str(caught.value) == (
        "--plugin: column own needs output_pin_cout, which is no input or result, did you mean "
        "output_pin_count?"
    )


@pytest.mark.parametrize("module", ["nowhere.py", "no_such_module_of_mine"])
def test_a_plugin_that_is_not_there_is_one_line(module: str, tmp_path: Path) -> None:
    done = run("simulate", "reference-87", "a.csv", "--plugin", module, "--out", "b.csv",
               cwd=tmp_path)  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert module in done.stderr


def test_loading_twice_registers_once(washers: Path) -> None:
    assert plugins.load(str(washers)) is plugins.load(str(washers))
    assert [str(washers)] == plugins.LOADED
    assert [effect.name for effect in effects.effects()].count("spring_washer") == 1
