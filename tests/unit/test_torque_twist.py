"""Torque over twist of the component model: states, energy, free play and simulation."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.design.torque_twist import TorqueTwist
from cyclosweep.simulation.elastic_curve import ElasticCurve
from tests.support.arrays import present

EXAMPLE = Path(__file__).parents[2] / "examples" / "components-87.toml"


def run_cli(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "cyclosweep", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def drive(**changes: Any) -> cs.Drive:
    """The 87:1 drive whose every component number is given, with a shaft of 4.1e-6 rad/(N m)."""
    given = {"shaft_1_length_mm": 120 * 4.1e-6 / 2.46835409992929e-06, "hole_clearance_mm": 0.2}
    return cs.Drive.from_toml(EXAMPLE).replace(**{**given, **changes})


def test_the_rig_of_the_design_notes() -> None:
    # Their prototype: free play 24 to 25 deg, 2.62 T_N at 70 deg and 3.08 at 80, output torque over
    # 87 times the input's 0.958 to 1.049, 0.962 to 1.079 with the crank at 0.4 rad in the middle.
    for crank, largest in ((0.0, 1.049), (math.degrees(0.4), 1.079)):
        curve = drive().torque_twist("input", crank)
        assert curve.reached
        below, above = curve.free_play_deg
        assert 23.0 < -below < 25.0
        assert 23.0 < above < 25.0
        loading = curve.table.filter(pl.col("angle_deg").is_between(35.0, 85.0))
        ratio = (loading["output_torque_nm"] / (87 * loading["input_torque_nm"])).to_numpy()
        assert ratio.max() == pytest.approx(largest, abs=0.002)
        assert ratio.min() == pytest.approx(0.96, abs=0.02)
        if crank == 0.0:
            angle, load = loading["angle_deg"].to_numpy(), loading["load_tn"].to_numpy()
            assert np.interp(70.0, angle, load) == pytest.approx(2.62, rel=0.02)
            assert np.interp(80.0, angle, load) == pytest.approx(3.08, rel=0.02)


@pytest.mark.parametrize("side", ["input", "output"])
@pytest.mark.parametrize("stiff_shaft", [False, True])
def test_a_point_is_the_equilibrium_under_its_torque(side: Any, stiff_shaft: bool) -> None:
    rigid = {"shaft": (), "output_stiffness_nm_per_arcmin": 1e9} if stiff_shaft else {}
    of = cs.Drive.from_toml(EXAMPLE).replace(**rigid)
    curve = of.torque_twist(side, 10.0, points=40)
    checked = 0
    for row in curve.table.iter_rows(named=True):
        if abs(row["load_tn"]) < 0.05:
            continue
        crank = math.radians(10.0 + (row["angle_deg"] if side == "input" else 0.0))
        turn = row["angle_deg"] / (87 if side == "input" else 1)
        state = of.loaded(row["output_torque_nm"], crank)
        assert state.twist_arcmin == pytest.approx(60 * turn, rel=1e-7)
        assert state.input_torque_nm == pytest.approx(row["input_torque_nm"], rel=1e-6)
        checked += 1
    assert checked > 40


def test_work_does_not_depend_on_the_way() -> None:
    # Once by turning the crank with the output locked, once by turning the crank with the output
    # free, which takes no work, and then the output back.
    of = drive()
    locked = of.torque_twist("input", 0.0, to_load_tn=2.5, points=3000)
    half = locked.table.filter(pl.col("angle_deg") >= 0)
    turn = half["angle_deg"].to_numpy()
    work = np.trapezoid(half["input_torque_nm"].to_numpy(), np.radians(turn))
    back = of.torque_twist("output", float(turn[-1]), to_load_tn=4.5, points=3000).table
    back = back.filter(pl.col("angle_deg").is_between(0.0, turn[-1] / 87))
    angle = np.r_[back["angle_deg"].to_numpy(), turn[-1] / 87]
    torque = np.r_[back["output_torque_nm"].to_numpy(), half["output_torque_nm"][-1]]
    assert np.trapezoid(torque, np.radians(angle)) == pytest.approx(work, rel=1e-5)


def test_free_play_is_the_backlash() -> None:
    of = drive()
    period = 360 / 8 * 87 / 88
    plays = []
    for k in range(8):
        below, above = of.torque_twist("output", period * k / 8, points=2).free_play_deg
        plays.append(60 * (above - below))
    space = cs.Space.grid(of)
    backlash = cs.scan(space, model="components").select("backlash_arcmin").collect().item()
    assert np.mean(plays) == pytest.approx(backlash, rel=1e-6)


def test_without_clearance_there_is_no_play_and_the_slope_is_the_stiffness() -> None:
    of = drive(hole_clearance_mm=0.0, ring_clearance_mm=0.0)
    curve = of.torque_twist("output", 17.0, points=2000)
    assert max(map(abs, curve.free_play_deg)) < 1e-6
    table = curve.table.filter(pl.col("load_tn").is_between(0.98, 1.02))
    slope = np.polyfit(60 * table["angle_deg"].to_numpy(), table["torque_nm"].to_numpy(), 1)[0]
    state = of.loaded(585.0, math.radians(17.0))
    assert slope == pytest.approx(state.tangent_stiffness_nm_per_arcmin, rel=1e-4)


def test_friction_lies_on_either_side() -> None:
    smooth = drive(friction_ring=0.0, friction_output=0.0, friction_bearing=0.0)
    table = smooth.torque_twist(points=20).table
    assert table["loading_torque_nm"].equals(table["torque_nm"])
    rough = drive().torque_twist(points=20)
    forwards = rough.table.filter(pl.col("load_tn") > 0.1)
    assert (forwards["loading_torque_nm"] > forwards["torque_nm"]).all()
    assert (forwards["unloading_torque_nm"] < forwards["torque_nm"]).all()
    backwards = rough.table.filter(pl.col("load_tn") < -0.1)
    assert (backwards["loading_torque_nm"] < backwards["torque_nm"]).all()
    # One more coefficient: the holes' share alone is e times the sum of the forces.
    output = drive(friction_ring=0.0, friction_bearing=0.0)
    row = output.torque_twist(points=20).table.row(-1, named=True)
    turned = math.radians(row["angle_deg"])
    forces = output.loaded(row["output_torque_nm"], turned).output_pin_forces_n
    taken = row["loading_torque_nm"] - row["torque_nm"]
    assert taken == pytest.approx(0.05 * 0.9e-3 * forces.sum(), rel=1e-5)
    assert output.torque_twist("output", points=5).table["loading_torque_nm"].null_count() == 13


def test_the_line_is_predicted_from_clearances() -> None:
    line = drive().torque_twist("input").line()
    assert 23.0 < line.free_play_deg < 28.0
    # 87^2 times shaft and, about as stiff, the contacts.
    assert line.compliance_deg_per_nm > math.degrees(87**2 * 4.1e-6)
    tight = drive(hole_clearance_mm=0.05).torque_twist("input").line()
    assert tight.free_play_deg < 0.5 * line.free_play_deg


@pytest.mark.parametrize("side", ["input", "output"])
def test_simulation_follows_the_curve(side: Any) -> None:
    of = drive()
    curve = of.torque_twist(side, 5.0)
    model = cs.Model.of_components(of, side, 5.0)
    rising = curve.table.filter(pl.col("load_tn").abs() > 0.01)["torque_nm"].to_numpy()
    angle = curve.table.filter(pl.col("load_tn").abs() > 0.01)["angle_deg"].to_numpy()
    if side == "output":
        found = cs.simulate(model, cs.Recording.from_arrays(rising, side=side))
        np.testing.assert_allclose(present(found.angle_deg), angle, atol=1e-9)
    back = cs.simulate(
        model, cs.Recording.from_arrays(rising, angle_deg=angle, side=side), predict="torque"
    )
    # Where the curve waves, torque as a function of angle is what the rising branch says.
    assert np.abs(back.torque_nm - rising).max() < 0.02 * np.abs(rising).max()


def test_simulated_friction_opens_the_loop() -> None:
    of = drive()
    model = cs.Model.of_components(of, friction=True)
    share = of.torque_twist().friction_share()
    assert share > 0.1
    torque = np.r_[np.linspace(0, 20, 200), np.linspace(20, 0.5, 200)]
    angle = present(cs.simulate(model, cs.Recording.from_arrays(torque)).angle_deg)
    smooth = cs.Model.of_components(of)
    for load, turn in ((12.0, np.interp(12.0, torque[:200], angle[:200])),):
        held = cs.simulate(smooth, cs.Recording.from_arrays([load / (1 + share)])).angle_deg
        assert turn == pytest.approx(present(held)[0], abs=0.3)
    up = np.interp(10.0, torque[:200], angle[:200])
    down = np.interp(-10.0, -torque[200:], angle[200:])
    assert down > up + 1.0


def test_a_model_file_keeps_the_curve(tmp_path: Path) -> None:
    model = cs.Model.of_components(drive(), friction=True)
    (tmp_path / "model.json").write_text(model.to_json())
    again = cs.Model.from_json(tmp_path / "model.json")
    assert again == model
    content = json.loads(model.to_json())
    for broken, message in (
        ({"torque_nm": [0, 1, 2], "twist_deg": [0, 1]}, "as many of both"),
        ({"torque_nm": [-1, 0, 0], "twist_deg": [-1, 0, 1]}, "that rise"),
        ({"torque_nm": [1, 2, 3], "twist_deg": [1, 2, 3]}, "no torque and no twist"),
        ({"torque_nm": [-1, 0, "x"], "twist_deg": [-1, 0, 1]}, "torque_nm 3"),
    ):
        (tmp_path / "model.json").write_text(json.dumps({**content, "elastic_curve": broken}))
        with pytest.raises(cs.InputError, match=message):
            cs.Model.from_json(tmp_path / "model.json")


def test_where_the_torque_falls_the_branch_jumps() -> None:
    angle = [-3.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    load = [-2.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.75, 2.0]
    table = pl.DataFrame({"angle_deg": angle, "torque_nm": load}).with_columns(converged=True)
    curve = TorqueTwist("input", 0.0, 1.0, (-1.0, 1.0), True, table)
    torque, twist = curve.branches()
    np.testing.assert_allclose(torque, [-2.0, 0.0, 1.0, 2.0])
    np.testing.assert_allclose(twist, [-2.0, 0.0, 1.0, 4.0])


def test_a_curve_goes_straight_on() -> None:
    curve = ElasticCurve((-1.0, 0.0, 1.0, 2.0), (-2.0, 0.0, 1.0, 1.5))
    np.testing.assert_allclose(curve.twist(np.array([-3.0, 0.5, 4.0])), [-6.0, 0.5, 2.5])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"side": "left"}, "side: found 'left'"),
        ({"crank_deg": math.nan}, "crank_deg"),
        ({"to_load_tn": -1.0}, "to_load_tn"),
        ({"points": 1}, "points"),
    ],
)
def test_refused_arguments(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(cs.InputError, match=message):
        drive().torque_twist(**arguments)
    with pytest.raises(cs.DesignError, match="ring_pin_radius_mm"):
        cs.Drive.reference_87().torque_twist()
    with pytest.raises(cs.InputError, match="found 0 points from 8 to 9"):
        drive().torque_twist(points=4).line(8.0, 9.0)


def test_commands(tmp_path: Path) -> None:
    out = tmp_path / "curve.csv"
    run = run_cli("torque-twist", str(EXAMPLE), "--out", str(out), "--points", "30", "--json")
    assert run.returncode == 0, run.stderr
    summary = json.loads(run.stdout)
    assert summary["reached"]
    assert summary["line_free_play_deg"] > 0
    table = pl.read_csv(out)
    assert table.height == 63
    programme = tmp_path / "load.csv"
    programme.write_text("torque_nm\n0\n5\n10\n5\n")
    run = run_cli(
        *("simulate", str(EXAMPLE), str(programme), "--model", "components"),
        *("--out", str(tmp_path / "out.csv")),
    )
    assert run.returncode == 0, run.stderr
    angle = pl.read_csv(tmp_path / "out.csv")["angle_deg"]
    assert angle[3] > angle[1] + 0.5
    for arguments, message in (
        (("torque-twist", "reference-87", "--out", str(out)), "ring_pin_radius_mm"),
        (("torque-twist", str(EXAMPLE), "--out", str(EXAMPLE)), "which is read"),
        (("torque-twist", str(EXAMPLE), "--out", str(tmp_path / "no" / "x.csv")), "folder"),
    ):
        run = run_cli(*arguments)
        assert run.returncode == 2
        assert message in run.stderr
        assert run.stderr.count("\n") == 1
