"""Trains: modes, transients beside SciPy, events, and what is refused."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.design.excitation import campbell, excitation_orders
from cyclosweep.dynamics import SlipElement, TrainSpring, backbone_frequency_hz
from cyclosweep.dynamics.spring import Brake
from cyclosweep.simulation.effect_value import EffectValue
from cyclosweep.simulation.effects.slip_start import STATES, in_other_state
from tests.unit.dynamics_oracle import Oracle

TRAINS = 50
GAP = math.radians(28)
PARTS = {"ring_pin_radius_mm": 2.0, "disc_width_mm": 12.0, "ring_clearance_mm": 0.02}


def _random_train(seed: int) -> tuple[cs.Train, Oracle, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    nodes = int(rng.integers(1, 6))
    grounded = nodes == 1 or bool(rng.integers(2))
    count = nodes if grounded else nodes - 1
    inertias = 10 ** rng.uniform(-3, -1, nodes)
    stiffnesses = 10 ** rng.uniform(1, 3, count)
    gaps = np.where(rng.random(count) < 0.6, rng.uniform(0.02, 0.4, count), 0.0)
    friction = [
        (float(s * rng.uniform(0.3, 2)), float(rng.uniform(0.2, 2))) if rng.random() < 0.3 else None
        for s in stiffnesses
    ]
    torques = rng.normal(0, 1, nodes)
    springs = [
        TrainSpring.linear(float(s), float(g), () if f is None else (SlipElement(*f),))
        for s, g, f in zip(stiffnesses, gaps, friction, strict=True)
    ]
    train = cs.Train(inertias.tolist(), springs=springs, grounded=grounded)
    oracle = Oracle(
        inertias.tolist(), stiffnesses.tolist(), gaps.tolist(), friction, grounded, torques.tolist()
    )
    return train, oracle, torques, rng.normal(0, 15, nodes)


@pytest.mark.parametrize("seed", range(TRAINS))
def test_transients_are_those_of_an_integrator_with_events(seed: int) -> None:
    train, oracle, torques, speeds = _random_train(seed)
    duration = 0.25
    run = train.transient(
        dict(enumerate(torques.tolist())), duration, 2, speeds_rad_per_s=speeds.tolist()
    )
    state, count = oracle.run(np.zeros(len(torques)), speeds, duration)
    last = run.table.tail(1)
    found = [last[f"angle_{name}_rad"][0] for name in train.names]
    found += [last[f"speed_{name}_rad_per_s"][0] for name in train.names]
    scale = np.maximum(1.0, np.abs(state))
    assert len(run.events) == count
    np.testing.assert_allclose(found / scale, state / scale, atol=1e-8)


def test_peaks_are_those_of_dense_samples() -> None:
    train = cs.Train([0.0035, 4e-4, 0.0026], [900.0, 21.0], [0.0, 0.2])
    run = train.transient({0: 3.0}, 0.3, 400_001, speeds_rad_per_s=[2.0, 2.0, -3.0])
    for name, peak in run.peak_torques_nm.items():
        dense = float(run.table[f"torque_{name}_nm"].abs().max())  # type: ignore[arg-type]
        assert dense <= abs(peak) * (1 + 1e-12)
        assert dense == pytest.approx(abs(peak), rel=1e-6)


def test_external_work_is_kinetic_elastic_and_lost_energy() -> None:
    spring = TrainSpring.linear(21.0, 0.1, [SlipElement(30.0, 0.5, 0.1), SlipElement(9.0, 0.2)])
    train = cs.Train([0.0035, 0.0026], springs=[spring])
    run = train.transient({0: 2.0, 1: -1.5}, 1.0, 501)
    table = run.table
    work = 2.0 * table["angle_node_1_rad"] - 1.5 * table["angle_node_2_rad"]
    held = table["kinetic_energy_j"] + table["elastic_energy_j"] + table["friction_loss_j"]
    np.testing.assert_allclose(held, work, atol=1e-11)
    assert run.friction_losses_j["node_1-node_2"] == pytest.approx(table["friction_loss_j"][-1])
    assert table["friction_loss_j"].diff().drop_nulls().min() >= -1e-13  # type: ignore[operator]


def test_damping_fades_a_free_oscillation_by_its_logarithmic_decrement() -> None:
    damping = 1e-3
    train = cs.Train([0.0035], [21.0], grounded=True, damping_s=damping)
    omega = math.sqrt(21.0 / 0.0035)
    share = 0.5 * damping * omega
    damped = omega * math.sqrt(1 - share**2)
    run = train.transient({}, 2 * math.tau / damped, 3, speeds_rad_per_s=1.0)
    speeds = run.table["speed_node_1_rad_per_s"]
    assert speeds[1] / speeds[0] == pytest.approx(math.exp(-share * omega * math.tau / damped))


def test_ratios_join_shafts_as_inertias_referred_by_their_square() -> None:
    geared = cs.Train([0.0035, 5.0], [21.0], [0.1], ratios=[87.0], names=["motor", "load"])
    plain = cs.Train([0.0035, 5.0 / 87**2], [21.0], [0.1], names=["motor", "load"])
    np.testing.assert_allclose(geared.modes().frequencies_hz, plain.modes().frequencies_hz)
    runs = [
        geared.transient({"motor": 3.0, "load": -100.0}, 0.2, 20),
        plain.transient({"motor": 3.0, "load": -100.0 / 87}, 0.2, 20),
    ]
    tables = [run.table for run in runs]
    np.testing.assert_allclose(tables[0]["angle_load_rad"] * 87, tables[1]["angle_load_rad"])
    np.testing.assert_allclose(tables[0]["torque_motor-load_nm"], tables[1]["torque_motor-load_nm"])


def test_sensitivities_are_those_of_small_changes() -> None:
    train = cs.Train([0.0035, 4e-4, 0.0026], [900.0, 21.0])
    table = train.modes().sensitivities.filter(pl.col("mode") == 2)
    step = 1e-6
    for row in table.iter_rows(named=True):
        inertias, stiffnesses = [0.0035, 4e-4, 0.0026], [900.0, 21.0]
        names = {"node_1": (inertias, 0), "node_2": (inertias, 1), "node_3": (inertias, 2)}
        names |= {"node_1-node_2": (stiffnesses, 0), "node_2-node_3": (stiffnesses, 1)}
        values, k = names[row["component"]]
        values[k] *= 1 + step
        moved = cs.Train(inertias, stiffnesses).modes().frequencies_hz[1]
        found = (moved / row["frequency_hz"] - 1) / step
        assert row["percent_per_percent"] == pytest.approx(found, abs=1e-6)


def test_energy_shares_are_one_for_inertias_and_one_for_springs() -> None:
    shares = cs.Train([0.0035, 4e-4, 0.0026], [900.0, 21.0]).modes().energy_shares
    sums = shares.group_by("mode", "kind").agg(pl.col("share").sum()).sort("mode", "kind")
    assert sums["share"].to_list() == pytest.approx([1, 0, 1, 1, 1, 1])


def test_frequency_follows_the_backbone_through_the_play() -> None:
    numbers = {"stiffness_nm_per_rad": 21.0, "inertia_kg_m2": 0.0035, "gap_rad": GAP}
    slow, fast = (backbone_frequency_hz(a, **numbers) for a in (0.1, 1.0))
    assert slow < fast < math.sqrt(21.0 / 0.0035) / math.tau


def _friction_model() -> cs.Model:
    shape = {"slip_deg": 1.5, "scatter": 0.8, "skew": 0.0, "slack": 0.0}
    friction = EffectValue("friction_hysteresis", shape, (0.6,))
    return cs.Model(compliance_deg_per_nm=2.7, free_play_deg=28.0, effects=(friction,))


def _diagnosed_model(drive: cs.Drive) -> cs.Model:
    """Model of a recording of a drive with friction, its datum and torque zero put to zero."""
    line = drive.nominal_line()
    true = dataclasses.replace(_friction_model(), compliance_deg_per_nm=line.compliance_deg_per_nm)
    up = np.linspace(0, 28, 90)
    ramp = np.r_[up, up[::-1], -up, -up[::-1]]
    clean = cs.simulate(true, cs.Recording.from_arrays(np.r_[ramp, 0.6 * ramp]))
    assert clean.angle_deg is not None
    noise = np.random.default_rng(3).normal(0, 0.05, len(clean))
    found = cs.diagnose(clean.with_angle(clean.angle_deg + noise), drive)
    assert found.model is not None
    (friction,) = found.model.effects
    assert friction.name == "friction_hysteresis"
    # Loops that slide fully do not tell where friction lies; the train's slides through the play.
    through = dataclasses.replace(friction, shape=in_other_state(friction.shape, STATES[0]))
    return dataclasses.replace(found.model, effects=(through,), datum_deg=0.0, torque_zero_nm=0.0)


def test_friction_of_a_diagnosed_model_takes_the_area_of_its_static_loop() -> None:
    drive = cs.Drive.reference_87()
    model = _diagnosed_model(drive)
    train = drive.train(model)
    # From preload to the opposite side and back: the twist turns twice.
    run = train.transient({0: -6.0}, 0.2, 20_001, preload_nm={0: 6.0})
    twist = run.table["angle_input_rad"].to_numpy()
    low = int(twist.argmin())
    high = low + int(twist[low:].argmax())
    losses = run.table["friction_loss_j"]
    there = np.linspace(twist[0], twist[low], 4001)
    back = np.linspace(twist[low], twist[high], 4001)
    path = np.r_[there, back]
    load = cs.Recording.from_arrays(np.zeros(len(path)), np.degrees(path))
    torque = cs.simulate(model, load, predict="torque").torque_nm
    friction = torque - train.springs[0].torque_nm(path)
    limit = sum(element.limit_nm for element in train.springs[0].friction)
    # Slid to the end at both turns, the elements hold the same energy there.
    assert friction[4000] == pytest.approx(-limit, rel=1e-6)
    assert friction[-1] == pytest.approx(limit, rel=1e-6)
    area = float(np.trapezoid(friction[4001:], back))
    assert losses[high] - losses[low] == pytest.approx(area, rel=2e-3)


def test_a_repaired_model_keeps_its_play_its_curve_and_its_drag() -> None:
    model = _friction_model()
    drag = EffectValue("viscous_drag", {"power": 1.0, "lag_s": 0.01}, (0.1,))
    train = cs.Drive.reference_87().train(
        cs.Model(compliance_deg_per_nm=2.7, free_play_deg=28.0, effects=(*model.effects, drag))
    )
    assert train.damping_s == 0.01
    assert train.springs[0].gap_rad == pytest.approx(GAP)
    assert sum(e.limit_nm for e in train.springs[0].friction) == pytest.approx(0.6)
    at_output = cs.Model(compliance_deg_per_nm=2.7 / 87**2, free_play_deg=28 / 87, side="output")
    spring = cs.Drive.reference_87().train(at_output).springs[0]
    assert spring.gap_rad == pytest.approx(GAP)
    assert spring.slopes_nm_per_rad[0] == pytest.approx(1 / math.radians(2.7))


def test_component_train_is_as_soft_as_the_loaded_drive() -> None:
    drive = cs.Drive.reference_87().replace(**PARTS)
    train = drive.train("components", load_inertia_kg_m2=5.0)
    torque = drive.output_torque_nm
    mesh, output = train.springs
    at_mesh = np.interp(
        torque / 87, mesh.torque_nm(np.linspace(0, 1, 20001)), np.linspace(0, 1, 20001)
    )
    angles = np.linspace(0, 0.01, 20001)
    at_output = np.interp(torque, output.torque_nm(angles), angles)
    twist = (at_mesh / 87 + at_output) * 10_800 / math.pi
    assert twist == pytest.approx(drive.loaded().twist_arcmin, rel=1e-3)


def test_orders_of_the_transmission_error_are_those_of_the_pins() -> None:
    drive = cs.Drive.reference_87().replace(**PARTS, hole_clearance_mm=0.05)
    orders = excitation_orders(drive, samples=128)
    largest = orders.sort("twist_arcmin", descending=True).row(0, named=True)
    assert largest["source"] == "output pins"
    assert largest["order"] == pytest.approx(8 * 88 / 87)
    meetings = campbell(drive.train(load_inertia_kg_m2=5.0).modes(), orders, 1500.0)
    row = meetings.filter(pl.col("order") == largest["order"]).row(0, named=True)
    assert row["speed_rpm"] * row["order"] / 60 == pytest.approx(row["frequency_hz"])
    with pytest.raises(cs.InputError, match="speed: found 0 rpm, expected a number above zero"):
        campbell(drive.train(load_inertia_kg_m2=5.0).modes(), orders, 0.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0.0, 1.0], [5.0]), "inertia of node_1: found 0 kg m^2, expected a number above zero"),
        (([1.0, -2.0], [5.0]), "inertia of node_2: found -2 kg m^2"),
        (([1.0, 2.0], [0.0], [0.1]), "spring 1: stiffness behind the gap: found 0 N m/rad"),
        (([1.0, 2.0], [-3.0]), "spring 1: stiffness: found -3 N m/rad"),
        (([1.0, 2.0], [3.0], [-0.1]), "spring 1: gap: found -0.1 rad"),
        (([1.0, 2.0], [3.0, 4.0]), "springs: found 2, expected 1"),
        (([1.0, 2.0], [3.0], None, True), "springs: found 1, expected 2 of a grounded train"),
    ],
)
def test_a_train_that_cannot_be_is_refused(arguments: tuple[object, ...], message: str) -> None:
    with pytest.raises(cs.InputError, match=message.replace("^", r"\^")):
        cs.Train(*arguments)  # type: ignore[arg-type]


def test_an_input_inertia_of_zero_is_refused() -> None:
    with pytest.raises(cs.InputError, match="inertia of input: found 0 kg m"):
        cs.Drive.reference_87().train(input_inertia_kg_m2=0.0)


def test_a_preload_that_nothing_holds_is_refused() -> None:
    train = cs.Train([1.0, 2.0], [3.0])
    with pytest.raises(cs.InputError, match="2 N m left over at the first shaft of a train that"):
        train.transient({}, 1.0, preload_nm={0: 2.0})


def test_a_recorded_torque_is_followed(tmp_path: Path) -> None:
    file = tmp_path / "torque.csv"
    file.write_text("time_s,input_nm\n0,0\n0.1,5\n0.1,-5\n0.2,-5\n")
    (tmp_path / "event.toml").write_text(
        'kind = "recorded"\nrecording = "torque.csv"\nduration_s = 0.3\n'
    )
    train = cs.Train([0.0035], [21.0], grounded=True)
    run = cs.transient(train, cs.Event.from_toml(tmp_path / "event.toml"))
    again = train.transient({0: ([0, 0.1, 0.1, 0.2], [0, 5, -5, -5])}, 0.3)
    assert run.table.equals(again.table)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0,0\n0.2,5\n0.1,5\n", "time_s, data row 3: found 0.1 after 0.2, expected times that"),
        ("0,0\n0.2,nan\n", "column input_nm: expected a number in every row"),
        ("", "no rows"),
    ],
)
def test_a_recorded_torque_that_makes_no_sense_names_its_file(
    tmp_path: Path, rows: str, words: str
) -> None:
    (tmp_path / "torque.csv").write_text(f"time_s,input_nm\n{rows}")
    (tmp_path / "event.toml").write_text('kind = "recorded"\nrecording = "torque.csv"\n')
    with pytest.raises(cs.InputError, match=f"torque.csv: .*{words}"):
        cs.transient(
            cs.Train([0.0035], [21.0], grounded=True), cs.Event.from_toml(tmp_path / "event.toml")
        )


def test_a_blocked_output_stops_what_turns() -> None:
    drive = cs.Drive.reference_87()
    train = drive.train(load_inertia_kg_m2=5.0)
    event = cs.Event(kind="blocked-output", duration_s=0.1).of_drive(drive)
    run = cs.transient(train, event)
    energy = run.table["kinetic_energy_j"][0]
    speed = drive.input_speed_rpm * math.pi / 30
    assert energy == pytest.approx(0.5 * 0.002 * speed**2)
    assert run.shock_factor is not None
    assert run.shock_factor > 3


def test_shock_writes_tables_and_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from cyclosweep.cli import main

    event = tmp_path / "event.toml"
    event.write_text('kind = "reversal"\nduration_s = 0.2\n')
    out = tmp_path / "with space"
    monkeypatch.setattr(
        "sys.argv", ["cyclosweep", "shock", "reference-87", str(event), "--out", str(out)]
    )
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    content = json.loads((out / "shock.json").read_text())
    gap, torque = GAP, cs.Drive.reference_87().nominal_torque_nm
    stiffness = cs.Drive.reference_87().train().springs[0].slopes_nm_per_rad[0]
    expected = 1 + 2 * math.sqrt(1 + stiffness * gap / torque)
    assert content["shock_factor"] == pytest.approx(expected)
    assert f"shock factor {expected:.3f}" in capsys.readouterr().out
    assert pl.read_parquet(out / "transient.parquet").height == 2000
    assert (out / "events.csv").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('kind = "stopp"', "kind: found 'stopp', expected 'start', 'stop'"),
        ('kind = "pulse"', "event.toml: pulse_torque_nm: missing"),
        ('kind = "emergency-stop"', "needs an output that turns"),
        ('kind = "recorded"', "event.toml: recording: missing"),
        ('kind = "reversal"\ntorque_nm = -1', "torque_nm: found -1, expected greater than 0"),
        ('kind = "reversal"\n[train]\nload_inertia = 3', "train.load_inertia: unknown key"),
        ('kind = "reversal"\nduration_s = 1e9', "event.toml: duration_s: found 1e+09 s, 1.63e+10"),
        (
            'kind = "reversal"\n[train]\nload_inertia_kg_m2 = 1e-30',
            "Hz), expected at most 1e+06 periods",
        ),
    ],
)
def test_a_wrong_event_is_one_line(
    text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    from cyclosweep.cli import main

    event = tmp_path / "event.toml"
    event.write_text(text)
    argv = ["cyclosweep", "shock", "reference-87", str(event), "--out", str(tmp_path / "out")]
    monkeypatch.setattr("sys.argv", argv)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_a_brake_counts_as_an_oscillation_that_lasts_too_long() -> None:
    train = cs.Train([0.0035, 0.1], [21.0])
    stiff = Brake(0, SlipElement(1e20, 1.0))
    with pytest.raises(
        cs.InputError, match=r"duration_s: found 1 s, .* expected at most 1e\+06 per"
    ):
        train.transient({}, 1.0, brake=stiff)


@pytest.mark.parametrize("model", ["published", "components"])
def test_dimensions_move_a_frequency_as_their_small_changes_do(model: str) -> None:
    drive = cs.Drive.reference_87().replace(**PARTS)
    options: dict[str, Any] = {"model": model, "load_inertia_kg_m2": 5.0, "torque_nm": 5.0}
    table = cs.dimension_sensitivities(drive, **options)
    first = table.filter(pl.col("mode") == 2)
    named = dict(first.select("dimension", "hz_per_unit").iter_rows())
    assert {"output_pin_diameter_mm", "shaft_1_length_mm", "input_inertia_kg_m2"} <= set(named)
    assert ("ring_pin_radius_mm" in named) == (model == "components")
    assert not {"ratio", "input_speed_rpm", "output_pin_count"} & set(named)
    for name, step in (("output_pin_diameter_mm", 0.01), ("shaft_1_diameter_mm", 0.01)):
        at = [
            cs.modes(
                drive.replace(**{name: drive.values()[name] + sign * step}), **options
            ).frequencies_hz[1]
            for sign in (-1, 1)
        ]
        assert named[name] == pytest.approx((at[1] - at[0]) / (2 * step), rel=1e-3)
    # The published frequency goes with the root of the stiffness, which goes with the modulus.
    elasticity = first.filter(pl.col("dimension") == "youngs_modulus_gpa")["percent_per_percent"]
    assert model == "components" or elasticity[0] == pytest.approx(0.5, abs=1e-7)


def test_a_dimension_at_its_limit_is_moved_to_the_other_side() -> None:
    drive = cs.Drive.reference_87().replace(poisson_ratio=0.5)
    found = cs.dimension_sensitivities(drive)
    assert "poisson_ratio" in found["dimension"].to_list()


def test_parts_that_are_not_given_are_the_drive_s_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from cyclosweep.cli import main

    drive = cs.Drive.reference_87().replace(load_inertia_kg_m2=5.0, eccentric_inertia_kg_m2=1e-3)
    expected = drive.train().modes(drive.nominal_torque_nm).frequencies_hz
    assert len(expected) == 2
    drive.to_toml(tmp_path / "drive.toml")
    monkeypatch.setattr("sys.argv", ["cyclosweep", "modes", str(tmp_path / "drive.toml"), "--json"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["frequencies_hz"] == pytest.approx(expected.tolist())
    assert answer["dimension_sensitivities"][0]["mode"] == 2
    assert cs.Event(kind="start", train={"load_inertia_kg_m2": 2.0}).parts == {  # type: ignore[arg-type]
        "load_inertia_kg_m2": 2.0, "damping_s": 0.0,
    }  # fmt: skip
