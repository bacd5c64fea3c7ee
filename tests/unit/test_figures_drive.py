"""Pictures of a drive show the model's numbers, nothing is cut, and files repeat byte for byte."""

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

import cyclosweep as cs
from cyclosweep.design.active_pins import CRITERIA, Criterion
from cyclosweep.design.disc_profile import disc_profile
from cyclosweep.figures.active_map import map_figure
from cyclosweep.figures.disc import disc_figure
from cyclosweep.figures.style import save
from cyclosweep.figures.twist import twist_figure
from tests.drives import random_drives
from tests.support.pictures import artists, cut, lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).parents[2]


def counted(figure: Figure, drive: cs.Drive, criterion: Criterion) -> bool:
    """Whether the drawn bars add up to the core's counts."""
    from matplotlib.patches import Rectangle

    bars = [bar for bar in artists(figure, "window") if isinstance(bar, Rectangle)]
    start = np.array([bar.get_x() for bar in bars])
    end = start + np.array([bar.get_width() for bar in bars])
    times = drive.disc_count if criterion == "published-map" else 1
    sectors = drive.active_pins(criterion).sectors
    at = 0.617 * sectors["start_deg"].to_numpy() + 0.383 * sectors["end_deg"].to_numpy()
    found = ((start[:, None] < at) & (at < end[:, None])).sum(axis=0) * times
    return bool(np.array_equal(found, sectors["active"].to_numpy()))


@pytest.mark.parametrize("criterion", CRITERIA)
def test_bars_of_the_map_add_up_to_the_counts(reference: cs.Drive, criterion: Criterion) -> None:
    for drive in [reference, *random_drives(41, 6)]:
        assert counted(map_figure(drive, criterion=criterion), drive, criterion), drive


def test_a_broken_map_is_noticed(reference: cs.Drive, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = cs.Drive.hole_windows

    def one_less(drive: cs.Drive, criterion: Criterion | None = None) -> pl.DataFrame:
        return whole(drive, criterion).filter(pl.col("hole") != 3)

    monkeypatch.setattr(cs.Drive, "hole_windows", one_less)
    assert not counted(map_figure(reference), reference, "published-map")


def test_steps_of_the_map_are_the_sectors(reference: cs.Drive) -> None:
    from matplotlib.patches import StepPatch

    [steps] = artists(map_figure(reference), "count")
    assert isinstance(steps, StepPatch)
    sectors = reference.active_pins().sectors
    values, edges, _ = steps.get_data()
    assert list(values) == sectors["active"].to_list()
    assert list(edges[:-1]) == sectors["start_deg"].to_list()


def test_active_arcs_are_the_map_s_windows(reference: cs.Drive) -> None:
    for drive in [reference, *random_drives(43, 4, ratio=3), *random_drives(44, 4)]:
        for criterion in CRITERIA:
            windows = drive.hole_windows(criterion).filter(disc=1, hole=2)
            arcs = lines(disc_figure(drive, hole=2, criterion=criterion), "active-arc")
            assert len(arcs) == windows.height
            for arc, window in zip(arcs, windows.iter_rows(named=True), strict=True):
                ends = [window["start_deg"], window["end_deg"]]
                radius = drive.hole_locus(ends, window["index"])["radius_mm"].to_numpy()
                off = radius - drive.output_pin_circle_radius_mm
                assert arc[[0, -1], 1] == pytest.approx(off, abs=1e-9)


def test_by_inside_exactly_the_arcs_lie_inside_the_pins_circle(reference: cs.Drive) -> None:
    figure = disc_figure(reference, criterion="inside")
    [path] = lines(figure, "path")
    inside = lines(figure, "active-arc")
    assert all(np.all(arc[1:-1, 1] < 0) for arc in inside)
    share = sum(np.ptp(arc[:, 0]) for arc in inside) / np.ptp(path[path[:, 1] < 0, 0])
    assert share == pytest.approx(1, abs=0.02)


def test_full_pins_are_those_active_at_that_position(reference: cs.Drive) -> None:
    for turn in (10.0, 45.0, 90.0, 200.0, 359.0):
        figure = disc_figure(reference, mesh_deg=turn)
        sectors = reference.active_pins().sectors
        [here] = [n for start, end, n in sectors.iter_rows() if start <= turn < end]
        assert len(artists(figure, "active-pin")) * 2 == here
        assert len(artists(figure, "idle-pin")) == 8 - here // 2


def test_the_profile_touches_every_ring_pin() -> None:
    lobes, ring, pin, e = 11, 50.0, 4.0, 1.5
    outline = disc_profile(
        lobes, ring_pin_circle_radius_mm=ring, ring_pin_radius_mm=pin, eccentricity_mm=e,
        chord_error_mm=1e-6,
    )  # fmt: skip
    for theta in (0.0, 0.7, 4.0):
        turn = -theta / lobes
        spin = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        here = outline @ spin + e * np.array([math.cos(theta), math.sin(theta)])
        for k in range(lobes + 1):
            at = math.tau * k / (lobes + 1)
            centre = ring * np.array([math.cos(at), math.sin(at)])
            assert np.hypot(*(here - centre).T).min() == pytest.approx(pin, abs=1e-4)


@pytest.mark.parametrize(
    ("lobes", "ring", "pin", "e"),
    [(29, 52.5, 3.5, 1.25), (87, 75.0, 2.0, 0.62), (11, 50.0, 2.0, 4.1), (3, 30.0, 8.0, 6.0)],
)
@pytest.mark.parametrize("chord_error_mm", [1e-2, 1e-3])
def test_chords_of_the_profile_keep_to_it(
    lobes: int, ring: float, pin: float, e: float, chord_error_mm: float
) -> None:
    sizes = {"ring_pin_circle_radius_mm": ring, "ring_pin_radius_mm": pin, "eccentricity_mm": e}
    outline = disc_profile(lobes, **sizes, chord_error_mm=chord_error_mm)
    true = disc_profile(lobes, **sizes, chord_error_mm=1e-7)
    lobe = true[: len(true) // lobes : 7]
    chords = np.diff(outline, axis=0)
    from_start = lobe[:, None] - outline[None, :-1]
    share = np.clip((from_start * chords).sum(axis=2) / (chords**2).sum(axis=1), 0, 1)
    off = np.linalg.norm(from_start - share[:, :, None] * chords, axis=2).min(axis=1)
    assert 0.4 * chord_error_mm < off.max() < chord_error_mm


def test_the_drawn_disc_has_the_holes_that_are_cut_and_no_corners(tmp_path: Path) -> None:
    from matplotlib.patches import Circle, Polygon

    drive = cs.Drive.from_toml(ROOT / "examples" / "catalogue-29.toml")
    drive = drive.replace(hole_clocking_deg=3.0)
    turn, ratio = math.radians(20.0), drive.ratio
    figure = disc_figure(drive, mesh_deg=20.0)
    pins = [*artists(figure, "active-pin"), *artists(figure, "idle-pin")]
    # Up and across the picture are along and across ring pin 0; the disc has turned back.
    drawn = [pin.center[::-1] for pin in pins if isinstance(pin, Circle)]
    [hole] = cs.cad.disc.checked_disc(drive, 1, True, 1.0).holes_mm[:1]
    cut = math.atan2(hole[1], hole[0]) - turn / ratio
    circle = drive.output_pin_circle_radius_mm
    place = circle * np.array([math.cos(cut), math.sin(cut)])
    assert np.linalg.norm(np.array(drawn) - place, axis=1).min() < 1e-9
    assert len(drawn) == drive.output_pin_count
    [profile] = artists(figure, "profile")
    assert isinstance(profile, Polygon)
    steps = np.diff(np.asarray(profile.get_xy()), axis=0)
    steps = steps[np.hypot(*steps.T) > 0]
    bends = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
    assert np.degrees(np.abs(bends)).max() < 12


def test_the_line_of_the_twist_is_the_model_s(reference: cs.Drive) -> None:
    figure = twist_figure(reference)
    results = reference.evaluate()
    [marks] = lines(figure, "marks")
    for load, twist in marks:
        name = f"twist_{load:g}tn_deg".replace(".", "p")
        assert twist == results[name]
    [line] = lines(figure, "line")
    assert np.interp(marks[:, 0], *line.T) == pytest.approx(marks[:, 1])
    [statics] = lines(figure, "statics")
    by_statics = reference.replace(criterion="statics").evaluate()["twist_1tn_deg"]
    assert np.interp(1.0, *statics.T) == pytest.approx(by_statics)


def test_the_published_band_is_the_printed_one_and_of_that_drive_alone(
    reference: cs.Drive,
) -> None:
    [band] = artists(twist_figure(reference), "published-band")
    from matplotlib.collections import PolyCollection

    assert isinstance(band, PolyCollection)
    corners = np.asarray(band.get_paths()[0].vertices, dtype=np.float64)
    ends = sorted({float(y) for x, y in corners if x == 2.5})
    assert ends == pytest.approx([75.0, 80.0])
    assert {float(y) for x, y in corners if x == 0} == {28.0}
    assert artists(twist_figure(reference.replace(ratio=29)), "published-band") == []


def test_the_component_model_s_curve_is_drawn_from_its_own_play() -> None:
    drive = cs.Drive.from_toml(ROOT / "examples" / "components-87.toml")
    [curve] = lines(twist_figure(drive), "components")
    assert curve[0, 1] >= drive.torque_twist("input").free_play_deg[1]
    assert artists(twist_figure(drive, components=False), "components") == []


PICTURES: list[Callable[[cs.Drive], Figure]] = [disc_figure, map_figure, twist_figure]


@pytest.mark.parametrize("draw", PICTURES)
def test_nothing_is_cut_whatever_the_drive(
    draw: Callable[[cs.Drive], Figure], reference: cs.Drive
) -> None:
    odd = [
        *random_drives(51, 1, ratio=3, output_pin_count=3, disc_count=1),
        *random_drives(52, 1, ratio=300, output_pin_count=64, disc_count=2),
        *random_drives(53, 1, disc_count=4, criterion="inside"),
    ]
    long = reference.replace(name="catalogue 29:1 with wider pins, third revision of it, batch 12")
    for drive in [reference, *odd, long]:
        assert cut(draw(drive)) == [], drive


def test_a_title_is_broken_only_where_it_would_leave_the_page(reference: cs.Drive) -> None:
    assert map_figure(reference).axes[0].get_title("left").count("\n") == 0
    long = reference.replace(name="catalogue 29:1 with wider pins, third revision, batch 12")
    title = map_figure(long).axes[0].get_title("left")
    assert title.count("\n") == 1
    assert title.replace("\n", " ") == f"{long.name}: active pins by {long.criterion}"


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_file_has_the_same_bytes_each_time_and_no_date(
    reference: cs.Drive, tmp_path: Path, ending: str
) -> None:
    for name in ("a", "b"):
        save(map_figure(reference), tmp_path / f"{name}.{ending}", dpi=60)
    content = (tmp_path / f"a.{ending}").read_bytes()
    assert content == (tmp_path / f"b.{ending}").read_bytes()
    assert b"Date" not in content
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"a.{ending}", f"b.{ending}"]


def test_the_user_s_own_settings_change_nothing(reference: cs.Drive, tmp_path: Path) -> None:
    import matplotlib as mpl

    save(map_figure(reference), tmp_path / "a.svg")
    with mpl.rc_context({"font.size": 20, "lines.linewidth": 5, "svg.hashsalt": None}):
        save(map_figure(reference), tmp_path / "b.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_a_drive_that_cannot_be_built_is_refused_with_the_reason(reference: cs.Drive) -> None:
    broken = reference.replace(output_pin_diameter_mm=40.0)
    for draw in (disc_figure, twist_figure):
        with pytest.raises(cs.DesignError, match="reference-87: "):
            draw(broken)


def plot(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "cyclosweep", "plot", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


def test_the_command_writes_a_picture(tmp_path: Path) -> None:
    out = tmp_path / "ein Bild ä.svg"
    done = plot("map", "reference-87", "--out", out)
    assert (done.returncode, done.stderr) == (0, "")
    assert out.read_text("utf-8").startswith("<?xml")


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (("map", "reference-87", "--out", "a.jpg"), "expected a file ending in"),
        (("map", "reference-87", "--out", "nowhere/a.png"), "folder that exists"),
        (("map", "reference-88", "--out", "a.png"), "reference-88"),
        (("disc", "reference-87", "--hole", "9", "--out", "a.png"), "expected 1 to 8"),
        (("disc", "reference-87", "--mesh-deg", "nan", "--out", "a.png"), "finite"),
        (("disc", "reference-87", "reference-87", "--out", "a.png"), "expected one"),
        (("disc", "reference-87", "--dpi", "0", "--out", "a.png"), "--dpi"),
        (("mop", "reference-87", "--out", "a.png"), "mop"),
    ],
)
def test_bad_input_is_one_line(
    arguments: tuple[str, ...], found: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = plot(*arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert found in done.stderr
    assert list(tmp_path.iterdir()) == []
