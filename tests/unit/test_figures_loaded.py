"""Pictures of loaded drives and of trains: their lines carry the model's forces and budgets."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl
import pytest
from matplotlib.collections import LineCollection
from matplotlib.patches import Rectangle

import cyclosweep as cs
from cyclosweep.design.excitation import excitation_orders
from cyclosweep.figures.budget import budget_figure
from cyclosweep.figures.ring import ring_figure
from cyclosweep.figures.series import (
    clearance_series_figure,
    load_series_figure,
    play_arcmin,
)
from cyclosweep.figures.shares import pin_forces, shares_figure
from cyclosweep.figures.train import campbell_figure, mode_shapes_figure, shock_map_figure
from tests.support.pictures import artists, cut, lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def loaded() -> cs.Drive:
    return cs.Drive.from_toml(EXAMPLES / "components-87.toml")


def test_shares_of_a_disc_sum_to_all_of_it_and_count_as_statics_do(reference: cs.Drive) -> None:
    shares = lines(shares_figure(reference), "share")
    assert len(shares) == 8
    assert sum(share[:, 1] for share in shares) == pytest.approx(100)
    windows = reference.hole_windows("statics").filter(disc=1)
    for index, share in enumerate(shares):
        own = windows.filter(index=index).select("start_deg", "end_deg").rows()
        for turn, value in share:
            is_active = any(start < turn < end for start, end in own)
            assert (value > 0) == is_active or min(abs(turn - e) for w in own for e in w) < 1e-9


def test_shares_of_the_component_model_are_its_forces(loaded: cs.Drive) -> None:
    shares = lines(shares_figure(loaded, output_torque_nm=300.0), "share")
    forces = loaded.loaded(300.0, math.radians(60.0)).output_pin_forces_n[0]
    drawn = [np.interp(60.0, *share.T) for share in shares]
    assert drawn == pytest.approx(100 * forces / forces.sum())
    by_hand = pin_forces(loaded, np.array([60.0]), "components", 300.0)[0, 0]
    assert by_hand == pytest.approx(forces)


def test_lines_on_the_ring_balance_the_torque(loaded: cs.Drive) -> None:
    """The ring's tangential force on a disc is its torque over e N, whatever the sharing."""
    crank, torque = 30.0, 400.0
    figure = ring_figure(loaded, crank_deg=crank, output_torque_nm=torque)
    state = loaded.loaded(torque, math.radians(crank))
    longest = 0.42 * loaded.ring_pin_circle_radius_mm
    newtons = state.ring_pin_forces_n.max() / longest
    total = 0.0
    for disc in range(2):
        [drawn] = artists(figure, f"forces-{disc + 1}")
        assert isinstance(drawn, LineCollection)
        segments = np.array(drawn.get_segments())
        assert len(segments) == np.count_nonzero(state.ring_pin_forces_n[disc])
        assert np.hypot(*segments[:, 0].T) == pytest.approx(90.0)
        vectors = newtons * (segments[:, 1] - segments[:, 0])
        theta = math.radians(crank) + math.pi * disc
        # The picture has ring pin 0 on top, angles clockwise: along u is (sin, cos) there.
        across = np.array([math.cos(theta), -math.sin(theta)])
        total += abs((vectors @ across).sum()) * 0.9e-3 * 87
    assert total == pytest.approx(torque, rel=1e-6)


def test_bars_of_the_budget_are_its_parts(loaded: cs.Drive) -> None:
    found = cs.compare([loaded, EXAMPLES / "catalogue-29.toml"])
    figure = budget_figure(found.budget)
    of_components = found.budget.filter(model="components")
    for name in ("components-87", "catalogue-29"):
        bars = [bar for bar in artists(figure, name) if isinstance(bar, Rectangle)]
        own = of_components.filter(drive=name)["compliance_arcmin_per_nm"]
        assert [bar.get_width() for bar in bars] == pytest.approx((1e3 * own).to_list())
    texts = " ".join(text.get_text() for text in figure.axes[0].texts)
    for share in of_components["share"]:
        assert f"{100 * share:.1f} %" in texts


def test_a_drive_without_components_is_drawn_by_the_published_model(reference: cs.Drive) -> None:
    budget = cs.compare([reference, EXAMPLES / "catalogue-29.toml"]).budget
    bars = artists(budget_figure(budget), "reference-87")
    drawn = [bar for bar in bars if isinstance(bar, Rectangle) and bar.get_width() > 0]
    assert len(drawn) == budget.filter(drive="reference-87", model="published").height
    with pytest.raises(cs.InputError, match=r"reference-87: has no compliance budget"):
        budget_figure(budget, model="components")
    with pytest.raises(cs.InputError, match="did you mean components"):
        budget_figure(budget, model="component")


def test_series_over_load_are_the_sweep_s(loaded: cs.Drive) -> None:
    figure = load_series_figure(loaded, hole_clearances_mm=(0.0, 0.1), loads=(0.5, 1.0))
    twists = lines(figure, "loaded_twist_arcmin")
    assert len(twists) == 2
    space = cs.Space.grid(loaded.replace(hole_clearance_mm=0.1), disc_width_mm=[12.0])
    row = cs.sweep(space, model="components", solver="full").row(0, named=True)
    assert twists[1][1] == pytest.approx([1.0, row["loaded_twist_arcmin"]])


def test_play_over_clearance_is_that_of_the_torque_twist_curve(loaded: cs.Drive) -> None:
    figure = clearance_series_figure(loaded, loads=(1.0,), hole_clearances_mm=(0.02, 0.05))
    [play] = lines(figure, "play_arcmin")
    below, above = loaded.torque_twist("output").free_play_deg  # its clearance is 0.05 mm
    assert play[1] == pytest.approx([0.05, 60 * (above - below)])
    assert play_arcmin(loaded, 0.02) == pytest.approx(play[0, 1])


PICTURES: list[Callable[[cs.Drive], Figure]] = [
    shares_figure,
    ring_figure,
    lambda drive: budget_figure(cs.compare([drive] * 6).budget),
    lambda drive: load_series_figure(drive, loads=(0.5, 1.0)),
    lambda drive: clearance_series_figure(drive, hole_clearances_mm=(0.0, 0.1)),
]


@pytest.mark.parametrize("draw", PICTURES)
def test_nothing_is_cut(draw: Callable[[cs.Drive], Figure], loaded: cs.Drive) -> None:
    few = cs.Drive.from_toml(EXAMPLES / "catalogue-29.toml").replace(
        output_pin_count=3, disc_count=1, output_pin_diameter_mm=8.0
    )
    long = loaded.replace(name="catalogue 29:1 with wider pins, third revision of it, batch 12")
    for drive in (loaded, few, long):
        assert cut(draw(drive)) == [], drive.name


@pytest.mark.parametrize("draw", PICTURES[1:2] + PICTURES[3:])
def test_a_drive_without_a_component_model_is_refused(
    draw: Callable[[cs.Drive], Figure], reference: cs.Drive
) -> None:
    with pytest.raises(cs.DesignError, match="reference-87: "):
        draw(reference)


def test_series_refuse_what_is_no_number_of_lines(loaded: cs.Drive) -> None:
    with pytest.raises(cs.InputError, match="expected one to six"):
        load_series_figure(loaded, hole_clearances_mm=[0.01 * k for k in range(7)], loads=(1.0,))
    with pytest.raises(cs.InputError, match="expected numbers"):
        load_series_figure(loaded, loads=(0.0,))
    with pytest.raises(cs.InputError, match="expected numbers"):
        clearance_series_figure(loaded, hole_clearances_mm=())


def test_pictures_of_a_train_are_in_the_house_s_style_and_whole(reference: cs.Drive) -> None:
    train = reference.train(load_inertia_kg_m2=5.0)
    modes = train.modes()
    for figure in (
        mode_shapes_figure(modes),
        campbell_figure(modes, excitation_orders(reference), 1500.0),
        shock_map_figure(reference.nominal_torque_nm, (5.0, 100.0), (0.0, 40.0)),
    ):
        assert cut(figure) == []
        assert {axis.xaxis.label.get_fontsize() for axis in figure.axes} == {7.0}


def test_the_ring_s_forces_stand_over_their_pins(loaded: cs.Drive) -> None:
    figure = ring_figure(loaded, crank_deg=0.0)
    drawn: list[LineCollection] = [
        each for each in artists(figure, "force") if isinstance(each, LineCollection)
    ]
    forces = loaded.loaded(crank_rad=0.0).ring_pin_forces_n
    for disc, each in enumerate(drawn):
        tops = np.array([segment[1] for segment in each.get_segments()])
        at = np.flatnonzero(forces[disc])
        assert tops[:, 0] == pytest.approx(at * 360 / 88)
        assert tops[:, 1] == pytest.approx(forces[disc, at])
    assert pl.Series([len(each.get_segments()) for each in drawn]).sum() > 20


def test_a_drive_that_cannot_be_built_is_not_left_out_of_a_budget_in_silence(
    reference: cs.Drive, tmp_path: Path
) -> None:
    broken = tmp_path / "broken.toml"
    reference.replace(output_pin_diameter_mm=40.0).to_toml(broken)
    command = [sys.executable, "-m", "cyclosweep", "plot", "budget", "reference-87", broken]
    done = subprocess.run(
        [*map(str, command), "--out", str(tmp_path / "a.png")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "holes overlap" in done.stderr
    assert not (tmp_path / "a.png").exists()
