"""Drawings of discs: true to the profile, closed, readable elsewhere, or refused."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl
import pytest
import trimesh
from ezdxf import path as dxf_path
from ezdxf import units
from ezdxf.filemanagement import readfile
from scipy.spatial import cKDTree

import cyclosweep as cs
from tests.drives import random_drives

ROOT = Path(__file__).parents[2]
Reals = npt.NDArray[np.float64]

CATALOGUE = cs.Drive.from_toml(ROOT / "examples" / "catalogue-29.toml")
MODIFIED = CATALOGUE.replace(
    profile_offset_mm=0.006, profile_shift_mm=0.02, profile_rotation_deg=0.03,
    ring_circle_enlargement_mm=0.01,
)  # fmt: skip
PAPER = cs.Drive.reference_87().replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
FAT = CATALOGUE.replace(
    ratio=9, ring_pin_circle_radius_mm=48.0, ring_pin_radius_mm=5.0, disc_count=3,
    eccentricity_mm=2.0, disc_outer_radius_mm=41.0, output_pin_count=6, disc_3_reach_mm=39.0,
    output_pin_circle_radius_mm=27.0, output_pin_diameter_mm=8.0, disc_bore_radius_mm=15.0,
    profile_offset_mm=0.05,
)  # fmt: skip
DRIVES = {"catalogue": CATALOGUE, "modified": MODIFIED, "paper": PAPER, "fat": FAT}
drives = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES)


def cutting_path(profile: cs.cad.DiscProfile, psi: Reals, derivative: int = 0) -> Reals:
    """Centre of the pin that cuts a profile, seen from the disc: an oracle of its own."""
    many, quarter = profile.lobes + 1, derivative * math.pi / 2
    ring, crank = profile.ring_radius_mm, profile.eccentricity_mm * many**derivative
    return np.column_stack(
        [
            ring * np.cos(psi + quarter) - crank * np.cos(many * psi + quarter),
            ring * np.sin(psi + quarter) - crank * np.sin(many * psi + quarter),
        ]
    )


def flank_numbers(profile: cs.cad.DiscProfile, points: Reals) -> Reals:
    """Points of the outline turned and mirrored onto the flank above the angle zero."""
    angle = np.arctan2(points[:, 1], points[:, 0]) - profile.turned_rad
    pitch = 2 * math.pi / profile.lobes
    angle = np.abs(angle - pitch * np.round(angle / pitch))
    radius = np.hypot(*points.T)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def distance_from_profile(profile: cs.cad.DiscProfile, points: Reals) -> Reals:
    """Distance of points from the true profile: that from the pins' path less the pin's radius."""
    on_flank = flank_numbers(profile, points)
    turn = profile.rotation_rad  # the flank was turned forward: turn the points back
    back = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    points = on_flank @ back.T
    # From the pin of the nearest point of the profile to the nearest pin, by Newton's steps.
    psi = np.linspace(-math.pi / profile.lobes, 2 * math.pi / profile.lobes, 3001)
    slope = cutting_path(profile, psi, 1)
    inwards = np.column_stack([-slope[:, 1], slope[:, 0]]) / np.hypot(*slope.T)[:, None]
    near = cutting_path(profile, psi) + profile.pin_radius_mm * inwards
    at = psi[np.asarray(cKDTree(near).query(points)[1])]
    for _ in range(6):
        off, first = points - cutting_path(profile, at), cutting_path(profile, at, 1)
        bend = (first**2).sum(axis=1) - (off * cutting_path(profile, at, 2)).sum(axis=1)
        at = at + (off * first).sum(axis=1) / bend
    nearest = np.hypot(*(points - cutting_path(profile, at)).T)
    result: Reals = np.abs(nearest - profile.pin_radius_mm)
    return result


def outline_of(path: Path, layer: str) -> Any:
    """The only polyline on a layer of a DXF file."""
    [line] = readfile(path).modelspace().query(f"LWPOLYLINE[layer=='{layer}']")
    return line


def along(line: Any, each: int = 60) -> Reals:
    """Points of a polyline's arcs as ezdxf understands them."""
    found = []
    for arc in line.virtual_entities():
        if arc.dxftype() == "ARC":
            first, last = arc.dxf.start_angle, arc.dxf.end_angle
            angles = np.radians(np.linspace(first, last + 360 * (last < first), each))
            centre = np.array([arc.dxf.center.x, arc.dxf.center.y])
            found.append(
                centre + arc.dxf.radius * np.column_stack([np.cos(angles), np.sin(angles)])
            )
        else:
            start, end = arc.dxf.start, arc.dxf.end
            share = np.linspace(0, 1, each)[:, None]
            found.append((1 - share) * [start.x, start.y] + share * [end.x, end.y])
    return np.concatenate(found)


def true_points(profile: cs.cad.DiscProfile, count: int) -> Reals:
    """Dense points of the whole true outline."""
    flank = profile.flank(np.linspace(*profile.flank_range, count)).position_mm
    return profile.copies(flank)


@pytest.mark.parametrize("chord_error_mm", [0.05, 1e-3, 1e-5])
@drives
def test_the_outline_keeps_to_the_profile_both_ways(
    drive: cs.Drive, chord_error_mm: float, tmp_path: Path
) -> None:
    disc = drive.disc_count
    facts = cs.cad.write_dxf(drive, tmp_path / "disc.dxf", disc=disc, chord_error_mm=chord_error_mm)
    profile = cs.cad.disc_profile(drive, disc)
    line = outline_of(tmp_path / "disc.dxf", f"DISC_{disc}")
    drawn = along(line)
    rounding = 1e-7  # of the oracles, whose points are that close
    assert distance_from_profile(profile, drawn).max() < chord_error_mm + rounding
    # The other way: no true point is farther from the drawn arcs.
    true = true_points(profile, 301)
    tree = cKDTree(drawn)
    place = np.asarray(tree.query(true)[1])
    chord = np.roll(drawn, -1, axis=0)[place] - np.roll(drawn, 1, axis=0)[place]
    off = true - drawn[place]
    length = np.hypot(*chord.T)
    across = np.abs(chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0]) / length
    spacing = float(np.hypot(*np.diff(drawn, axis=0).T).max())
    assert across.max() < chord_error_mm + spacing**2 / 8 / 0.9
    found = facts["chord_error_found_mm"]
    assert isinstance(found, float)
    assert 0.05 * chord_error_mm < found < chord_error_mm


def test_arcs_touch_one_another_without_an_edge() -> None:
    outline = cs.cad.drawing(CATALOGUE, 1).parts[0]
    assert isinstance(outline, cs.cad.Outline)
    place, bulge = outline.vertices[:, :2], outline.vertices[:, 2]
    chord = np.roll(place, -1, axis=0) - place
    direction, half = np.arctan2(chord[:, 1], chord[:, 0]), 2 * np.arctan(bulge)
    # Direction in which an arc ends, and in which the next one begins.
    turn = np.roll(direction - half, -1) - (direction + half)
    assert np.abs(np.sin(turn / 2)).max() < 1e-9


@drives
def test_points_of_the_table_lie_on_the_profile_and_their_chords_keep_to_it(
    drive: cs.Drive, tmp_path: Path
) -> None:
    cs.cad.write_points(drive, tmp_path / "points.csv", chord_error_mm=2e-3)
    table = pl.read_csv(tmp_path / "points.csv")
    profile = cs.cad.disc_profile(drive)
    points = table.select("x_mm", "y_mm").to_numpy()
    assert distance_from_profile(profile, points).max() < 1e-7
    middles = 0.5 * (points + np.roll(points, -1, axis=0))
    assert distance_from_profile(profile, middles).max() < 2e-3
    normal = table.select("normal_x", "normal_y").to_numpy()
    assert np.abs(np.hypot(*normal.T) - 1).max() < 1e-12
    # Outwards by a little, the distance from the pins' path falls by as much.
    inside = table["curvature_radius_mm"].to_numpy()
    moved = distance_from_profile(profile, points + 0.01 * normal)
    at_edge = np.zeros(len(points), bool)
    if profile.rotation_rad:
        per_lobe = len(points) // profile.lobes
        at_edge[:: per_lobe // 2] = True
    assert np.abs(moved[~at_edge] - 0.01).max() < 1e-6
    assert inside[inside > 0].min() == pytest.approx(profile.convex_radius_min_mm, rel=0.02)
    assert -inside[inside < 0].max() == pytest.approx(profile.concave_radius_min_mm, rel=0.02)


@drives
def test_the_radius_of_curvature_is_that_of_a_circle_through_neighbours(drive: cs.Drive) -> None:
    profile = cs.cad.disc_profile(drive)
    psi = np.linspace(*profile.flank_range, 40_001)
    x, y = profile.flank(psi).position_mm.T
    slope_x, slope_y = np.gradient(x, psi), np.gradient(y, psi)
    bend = slope_x * np.gradient(slope_y, psi) - slope_y * np.gradient(slope_x, psi)
    measured = bend / np.hypot(slope_x, slope_y) ** 3
    given = profile.flank(psi).curvature_per_mm
    assert np.abs(measured - given)[5:-5].max() < 1e-4 * np.abs(given).max()


@drives
def test_the_core_knows_the_same_smallest_radius_and_mass(drive: cs.Drive) -> None:
    profile = cs.cad.disc_profile(drive, modification=False)
    columns = ["profile_curvature_radius_min_mm", "disc_mass_kg"]
    row = cs.scan(
        cs.Space.grid(drive, output_pin_count=[drive.output_pin_count]), model="components"
    )
    radius, mass = row.select(columns).collect().row(0)
    assert profile.convex_radius_min_mm == pytest.approx(radius, rel=1e-12)
    facts = cs.cad.drawing(drive, 1, modification=False).facts
    density = (
        1e-9 * dict(drive.part_table().select("key", "value").iter_rows())["disc_density_kg_m3"]
    )
    area, width = facts["disc_area_mm2"], drive.disc_width_mm
    assert isinstance(area, float)
    assert width is not None
    assert area * width * density == pytest.approx(mass, rel=1e-9)


# The model is linear in the gaps, the outline exact: a tenth of them leaves a hundredth.
@pytest.mark.parametrize(("share", "most"), [(1.0, 2e-3), (0.1, 2e-5)])
@pytest.mark.parametrize("crank", [0.0, 0.4, 2.9])
@drives
def test_ring_pins_keep_the_gaps_of_the_component_model(
    drive: cs.Drive, crank: float, share: float, most: float
) -> None:
    gaps_of = ("ring_clearance_mm", "profile_offset_mm", "profile_shift_mm", "profile_rotation_deg",
        "ring_circle_enlargement_mm")  # fmt: skip
    drive = drive.replace(**{name: share * (getattr(drive, name) or 0) for name in gaps_of})
    ring = drive.ring_pin_circle_radius_mm + (drive.ring_circle_enlargement_mm or 0)
    count, lobes, e = drive.ratio + 1, drive.ratio, drive.eccentricity_mm
    angles = 2 * math.pi * np.arange(count) / count
    pins = ring * np.column_stack([np.cos(angles), np.sin(angles)])
    for disc in range(1, drive.disc_count + 1):
        at = crank + 2 * math.pi * (disc - 1) / drive.disc_count
        outline = true_points(cs.cad.disc_profile(drive, disc), 4001)
        turn = -crank / lobes  # the disc, with its holes, turns back as the crank goes on
        matrix = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        placed = outline @ matrix.T + e * np.array([math.cos(at), math.sin(at)])
        gaps = np.asarray(cKDTree(placed).query(pins)[0]) - (drive.ring_pin_radius_mm or 0)
        # The component model's gaps (rust/src/components/ring.rs).
        width = e * count / drive.ring_pin_circle_radius_mm
        x, y = np.cos(angles - at), np.sin(angles - at)
        length = np.hypot(width - x, y)
        uniform = (drive.ring_clearance_mm or 0) + (drive.profile_offset_mm or 0)
        along_u = (drive.ring_circle_enlargement_mm or 0) + (drive.profile_shift_mm or 0)
        turned = math.radians(drive.profile_rotation_deg or 0) * e * lobes
        model = uniform + along_u * (1 - width * x) / length + turned * np.abs(y) / length
        assert np.abs(gaps - model).max() < most


@drives
def test_without_modification_every_ring_pin_touches(drive: cs.Drive) -> None:
    profile = cs.cad.disc_profile(drive, modification=False)
    ring, e = drive.ring_pin_circle_radius_mm, drive.eccentricity_mm
    angles = 2 * math.pi * np.arange(drive.ratio + 1) / (drive.ratio + 1)
    pins = ring * np.column_stack([np.cos(angles), np.sin(angles)]) - [e, 0]
    apart = np.asarray(cKDTree(true_points(profile, 4001)).query(pins)[0])
    assert apart == pytest.approx(drive.ring_pin_radius_mm, abs=1e-6)


def test_holes_stand_about_the_pins_at_the_eccentricity(tmp_path: Path) -> None:
    cs.cad.write_dxf(FAT, tmp_path / "drive.dxf")
    space = readfile(tmp_path / "drive.dxf").modelspace()
    centres = {
        layer: np.array(
            [
                (circle.dxf.center.x, circle.dxf.center.y)
                for circle in space.query(f"CIRCLE[layer=='{layer}']")
                if circle.dxf.radius != FAT.disc_bore_radius_mm
            ]
        )
        for layer in ("OUTPUT_PINS", "DISC_1", "DISC_2", "DISC_3")
    }
    for number in (1, 2, 3):
        apart = centres[f"DISC_{number}"] - centres["OUTPUT_PINS"]
        phase = 2 * math.pi * (number - 1) / 3
        assert apart == pytest.approx(
            np.tile([2 * math.cos(phase), 2 * math.sin(phase)], (6, 1)), abs=1e-9
        )


@pytest.mark.parametrize("drive", [*DRIVES.values(), FAT.replace(ratio=10)])
def test_a_disc_that_is_the_first_one_turned_is_said_to_be(drive: cs.Drive) -> None:
    first = true_points(cs.cad.disc_profile(drive, 1), 101)
    for disc in range(2, drive.disc_count + 1):
        [line] = [line for line in cs.cad.drawing(drive).title if line.startswith(f"disc {disc}:")]
        other = true_points(cs.cad.disc_profile(drive, disc), 101)
        found = re.search(r"disc 1 turned by (\d+) holes", line)
        same = []
        for holes in range(drive.output_pin_count):
            angle = 2 * math.pi * holes / drive.output_pin_count
            turn = np.array(
                [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
            )
            if np.asarray(cKDTree(other).query(first @ turn.T)[0]).max() < 1e-6:
                same.append(holes)
        assert (int(found[1]) if found else None) == (same[0] if same else None)


@drives
def test_the_dxf_is_sound_and_names_its_numbers(drive: cs.Drive, tmp_path: Path) -> None:
    cs.cad.write_dxf(drive, tmp_path / "drive.dxf")
    document = readfile(tmp_path / "drive.dxf")
    audit = document.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    assert document.units == units.MM
    lines: list[Any] = list(document.modelspace().query("LWPOLYLINE"))
    assert sorted(line.dxf.layer for line in lines) == [
        *(f"DISC_{disc + 1}" for disc in range(drive.disc_count)), "HOUSING",
    ]  # fmt: skip
    assert all(line.closed for line in lines)
    assert all(len(path) > 10 for path in map(dxf_path.make_path, lines))
    texts = [text.dxf.text for text in document.modelspace().query("TEXT")]
    assert f"ratio {drive.ratio}" in texts[0]
    assert f"eccentricity {drive.eccentricity_mm:g}" in texts[0]
    names = {layer.dxf.name for layer in document.layers}
    assert {"DISC_1", "RING_PINS", "HOUSING", "OUTPUT_PINS", "CENTRES", "TITLE"} <= names


@drives
def test_a_second_reader_finds_one_closed_outline_and_its_area(
    drive: cs.Drive, tmp_path: Path
) -> None:
    facts = cs.cad.write_dxf(drive, tmp_path / "disc.dxf", disc=1)
    with (tmp_path / "disc.dxf").open("rb") as file:
        read: Any = trimesh.load_path(file, file_type="dxf")
    assert read.units == "millimeters"
    read.entities = [
        part for part in read.entities if part.layer != "CENTRES" and type(part).__name__ == "Arc"
    ]
    assert len(read.entities) == facts["arcs_of_a_disc"] + drive.output_pin_count + 1  # type: ignore[operator]
    assert read.is_closed
    areas = sorted(polygon.area for polygon in read.polygons_closed)
    assert len(areas) == drive.output_pin_count + 2
    profile = cs.cad.disc_profile(drive)
    assert areas[-1] == pytest.approx(profile.area_mm2, rel=2e-4)


@drives
def test_the_housing_is_one_closed_line_around_the_lobes(drive: cs.Drive, tmp_path: Path) -> None:
    cs.cad.write_dxf(drive, tmp_path / "drive.dxf")
    housing = along(outline_of(tmp_path / "drive.dxf", "HOUSING"), 30)
    ring = drive.ring_pin_circle_radius_mm + (drive.ring_circle_enlargement_mm or 0)
    pin = drive.ring_pin_radius_mm or 0
    radii = np.hypot(*housing.T)
    profile = cs.cad.disc_profile(drive)
    assert radii.min() > profile.tip_radius_mm + drive.eccentricity_mm
    assert radii.max() == pytest.approx(ring + pin, abs=1e-2)
    angles = 2 * math.pi * np.arange(drive.ratio + 1) / (drive.ratio + 1)
    pins = ring * np.column_stack([np.cos(angles), np.sin(angles)])
    apart, _ = cKDTree(pins).query(housing)
    assert np.asarray(apart).min() == pytest.approx(pin, abs=1e-9)


def test_the_svg_has_the_arcs_of_the_dxf(tmp_path: Path) -> None:
    cs.cad.write_svg(MODIFIED, tmp_path / "drive.svg")
    cs.cad.write_dxf(MODIFIED, tmp_path / "drive.dxf")
    tree = ET.parse(tmp_path / "drive.svg")
    space = "{http://www.w3.org/2000/svg}"
    groups = {group.get("id"): group for group in tree.iter(f"{space}g")}
    for layer in ("DISC_1", "DISC_2", "HOUSING"):
        [path] = groups[layer].findall(f"{space}path")
        words = path.get("d", "")
        corners = outline_of(tmp_path / "drive.dxf", layer).get_points("xyb")
        ends = re.findall(r"(?:M|L|A\S+ \S+ 0 [01] [01] )(-?[\d.e-]+) (-?[\d.e-]+)", words)
        assert np.array(ends, float)[:-1] == pytest.approx(
            np.array([row[:2] for row in corners]), abs=1e-7
        )
        sweeps = re.findall(r"A\S+ \S+ 0 [01] ([01]) ", words)
        assert [sweep == "1" for sweep in sweeps] == [row[2] > 0 for row in corners]
    assert len(groups["RING_PINS"].findall(f"{space}circle")) == MODIFIED.ratio + 1
    assert "scale(1 -1)" in (tmp_path / "drive.svg").read_text("utf-8")


@pytest.mark.parametrize("number", range(12))
def test_any_drive_is_drawn_true_or_refused_with_the_reason(number: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(number)
    [drive] = random_drives(4100 + number, 1, ratio=int(rng.integers(3, 60)))
    most = drive.ring_pin_circle_radius_mm * math.sin(math.pi / (drive.ratio + 1))
    drive = drive.replace(
        ring_pin_radius_mm=most * rng.uniform(0.1, 1), disc_width_mm=10.0,
        profile_rotation_deg=rng.choice([0.0, 0.02]), profile_offset_mm=rng.uniform(-0.01, 0.02),
    )  # fmt: skip
    refusal = ""
    try:
        profile = cs.cad.disc_profile(drive, min_wall_mm=0.0)
    except cs.DesignError as error:
        refusal = str(error)
    if refusal:
        assert refusal.startswith(f"{drive.name}: ")
        assert "\n" not in refusal
        return
    cs.cad.write_dxf(drive, tmp_path / "disc.dxf", disc=1, min_wall_mm=0.0)
    drawn = along(outline_of(tmp_path / "disc.dxf", "DISC_1"), 20)
    assert distance_from_profile(profile, drawn).max() < 1.001e-3


REFUSED = {
    "undercut": ({"eccentricity_mm": 1.7}, "undercut", "3.51 mm"),
    "offset": ({"profile_offset_mm": 1.4, "eccentricity_mm": 1.55}, "undercut"),
    "no ring": ({"ring_pin_radius_mm": None}, "needs ring_pin_radius_mm"),
    "out of the disc": ({"output_pin_circle_radius_mm": 40.0, "disc_outer_radius_mm": 52.0},
                        "hole and profile"),
    "into the bore": ({"disc_bore_radius_mm": 26.5}, "hole and bore", "at least 1 mm"),
    "each other": ({"output_pin_count": 14, "output_pin_diameter_mm": 12.2}, "neighbouring holes"),
    "narrow roots": ({"profile_offset_mm": -0.3, "ring_clearance_mm": 0.0}, "narrower"),
    "turned away": ({"profile_rotation_deg": 6.3}, "profile_rotation_deg is 6.3"),
    "no ring left": ({"profile_shift_mm": 52.0}, "profile_shift_mm"),
}  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "words"), [(r[0], r[1:]) for r in REFUSED.values()], ids=REFUSED
)
def test_what_cannot_be_made_is_refused_with_the_reason(
    changes: dict[str, Any], words: tuple[str, ...], tmp_path: Path
) -> None:
    with pytest.raises(cs.DesignError) as caught:
        cs.cad.write_dxf(CATALOGUE.replace(**changes), tmp_path / "disc.dxf")
    for word in words:
        assert word in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_no_ring_pins_fit_a_bore_that_clears_lobes_of_a_large_eccentricity() -> None:
    drive = FAT.replace(ring_pin_radius_mm=1.9)
    with pytest.raises(cs.DesignError, match="no housing bore clears the lobes"):
        cs.cad.drawing(drive)
    assert cs.cad.drawing(drive, 1).layers[0] == "DISC_1"
    with pytest.raises(cs.InputError, match=r"housing_bore_radius_mm: found 60, expected above 46"):
        cs.cad.drawing(FAT, housing_bore_radius_mm=60)
    assert cs.cad.drawing(FAT, housing_bore_radius_mm=48.0).parts


STEPS = {"catalogue": CATALOGUE, "modified": MODIFIED, "fat": FAT}


@pytest.mark.parametrize("drive", STEPS.values(), ids=STEPS)
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_the_step_file_opens_again_with_the_same_volume(drive: cs.Drive, tmp_path: Path) -> None:
    build123d = pytest.importorskip("build123d", reason="pip install 'cyclosweep[step]'")
    facts = cs.cad.write_step(drive, tmp_path / "drive.step")
    read = build123d.import_step(tmp_path / "drive.step")
    volumes = {part.label: part.volume for part in read.children}
    area, width = facts["disc_area_mm2"], drive.disc_width_mm
    assert isinstance(area, float)
    assert width is not None
    for disc in range(1, drive.disc_count + 1):
        assert volumes[f"disc_{disc}"] == pytest.approx(area * width, rel=1e-5)
    assert len(volumes) == facts["solids"]
    assert read.is_valid
    pin = math.pi * (drive.ring_pin_radius_mm or 0) ** 2
    reach = dict(drive.part_table().select("key", "value").iter_rows())
    middles = [reach[f"disc_{disc + 1}_reach_mm"] for disc in range(drive.disc_count)]
    assert volumes["ring_pin_0"] == pytest.approx(pin * (max(middles) - min(middles) + width))
    cs.cad.write_step(drive, tmp_path / "disc.step", disc=2, chord_error_mm=1e-4)
    alone = build123d.import_step(tmp_path / "disc.step")
    assert alone.volume == pytest.approx(area * width, rel=1e-6)
    side = [
        (point.X, point.Y)
        for edge in alone.edges()
        if edge.geom_type == build123d.GeomType.BSPLINE
        for point in (edge.position_at(share) for share in np.linspace(0, 1, 20))
    ]
    assert distance_from_profile(cs.cad.disc_profile(drive, 2), np.array(side)).max() < 1e-4


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_discs_that_stand_in_one_another_have_no_solids(tmp_path: Path) -> None:
    pytest.importorskip("build123d", reason="pip install 'cyclosweep[step]'")
    drive = CATALOGUE.replace(disc_2_reach_mm=20.0)
    with pytest.raises(cs.DesignError, match=r"discs 1 and 2 overlap: .* 11 mm apart"):
        cs.cad.write_step(drive, tmp_path / "drive.step")


@pytest.mark.parametrize(("module", "ending"), [("ezdxf", "dxf"), ("build123d", "step")])
def test_a_missing_extra_is_one_line_that_names_it(
    module: str, ending: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [module, *(n for n in sys.modules if n.startswith(f"{module}."))]:
        monkeypatch.setitem(sys.modules, name, None)
    write = cs.cad.write_dxf if ending == "dxf" else cs.cad.write_step
    with pytest.raises(cs.InputError, match=r"pip install 'cyclosweep\[(cad|step)\]'"):
        write(CATALOGUE, tmp_path / f"drive.{ending}")


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", "export", *arguments],
        capture_output=True, text=True, cwd=cwd, check=False,
    )  # fmt: skip


def test_the_command_writes_every_format(tmp_path: Path) -> None:
    folder = tmp_path / "für die Werkstatt"
    folder.mkdir()
    CATALOGUE.to_toml(folder / "Übersetzung.toml")
    for name in ("all.dxf", "all.svg", "points.csv"):
        done = run("Übersetzung.toml", "--out", name, "--json", cwd=folder)
        assert done.returncode == 0, done.stderr
        facts = json.loads(done.stdout)
        assert facts["schema"] == "cyclosweep.export/1"
        assert facts["wall_min_mm"] == pytest.approx(6.47)
        assert (folder / name).stat().st_size > 1000
    plain = run("Übersetzung.toml", "--out", "b.svg", "--without-modification", "--disc", "2",
                "--chord-error-mm", "0.01", cwd=folder)  # fmt: skip
    assert plain.returncode == 0
    assert "profile without modification" in (folder / "b.svg").read_text("utf-8")
    assert "chord_error_mm: 0.01\n" in plain.stdout


WRONG = {
    "ending": (["--out", "a.dfx"], "did you mean .dxf?"),
    "disc": (["--out", "a.dxf", "--disc", "3"], "expected 1 to 2"),
    "disc of points": (["--out", "a.csv", "--disc", "0"], "disc: found 0, expected 1 to 2"),
    "thin": (["--out", "a.svg", "--min-wall-mm", "50"], "drive.toml: holes leave too little of"),
    "no folder": (["--out", "none/a.dxf"], "a folder that exists"),
    "itself": (["--out", "drive.csv"], "which is read"),
    "chord error": (["--out", "a.dxf", "--chord-error-mm", "0"], "expected 1e-06 to 1"),
    "no number": (["--out", "a.csv", "--chord-error-mm", "nan"], "found nan"),
    "wall": (["--out", "a.svg", "--min-wall-mm", "-1"], "min_wall_mm: found -1"),
    "bore": (["--out", "a.csv", "--housing-bore-radius-mm", "50"], "the whole drive alone"),
}


@pytest.mark.parametrize(("arguments", "word"), WRONG.values(), ids=WRONG)
def test_bad_input_is_one_line(arguments: list[str], word: str, tmp_path: Path) -> None:
    drive = "drive.csv" if "drive.csv" in arguments else "drive.toml"
    CATALOGUE.to_toml(tmp_path / drive)
    before = sorted(tmp_path.iterdir())
    done = run(drive, *arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1
    assert word in done.stderr
    assert sorted(tmp_path.iterdir()) == before


def test_the_published_model_alone_is_refused_with_what_to_add(tmp_path: Path) -> None:
    done = run("reference-87", "--out", "a.dxf", cwd=tmp_path)
    assert done.returncode == 2
    assert "needs ring_pin_radius_mm and disc_width_mm" in done.stderr
    assert "add them to the drive file" in done.stderr
