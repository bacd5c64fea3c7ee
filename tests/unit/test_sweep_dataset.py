"""Datasets: what a part carries, what resuming keeps, what is refused, what a failure leaves."""

from __future__ import annotations

import json
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from filelock import FileLock
from polars.testing import assert_frame_equal

import cyclosweep as cs
from cyclosweep.sweep.dataset import Dataset, Part, read_footer

ROWS = 100
SPACE = cs.Space.sobol(
    cs.Drive.reference_87(), 730, seed=4, eccentricity_mm=(0.3, 0.9), output_pin_count=(6, 12)
)
STUDY = cs.Study.of(SPACE, objective=cs.Objective("reflected_compliance_rad_per_nm"))
WHOLE = cs.sweep(SPACE)


def sink(folder: Path, **options: Any) -> Any:
    return cs.sink(options.pop("study", STUDY), folder, **{"rows_per_part": ROWS, **options})


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def assert_whole(folder: Path, expected: pl.DataFrame = WHOLE) -> None:
    names = sorted(path.name for path in folder.iterdir())
    parts = -(-expected.height // ROWS)
    assert names == ["_manifest.json", *(f"part-{k:06d}.parquet" for k in range(parts))]
    assert_frame_equal(cs.scan_dataset(folder).collect(), expected, check_exact=True)
    manifest = json.loads((folder / "_manifest.json").read_text())
    assert manifest["complete"] is True
    assert manifest["rows"] == manifest["variants"] == expected.height
    assert [part["file"] for part in manifest["parts"]] == names[1:]


def test_scan_sweep_and_sink_are_one(tmp_path: Path) -> None:
    summary = sink(tmp_path / "study")
    assert_whole(tmp_path / "study")
    assert_frame_equal(cs.scan(SPACE).collect(), WHOLE, check_exact=True)
    assert cs.scan_dataset(tmp_path / "study").collect_schema() == WHOLE.schema
    assert summary.rows == 730
    expected = dict(WHOLE["status"].value_counts().iter_rows())
    assert summary.status == expected


def test_summary_is_that_of_the_rows(tmp_path: Path) -> None:
    summary = sink(tmp_path)
    ok = WHOLE.filter(pl.col("status") == "ok")
    column = "reflected_compliance_rad_per_nm"
    best = ok.sort(column, "variant").head(10)
    assert [row["variant"] for row in summary.best] == best["variant"].to_list()
    assert [row[column] for row in summary.best] == best[column].to_list()
    for name, (low, high) in summary.ranges.items():
        assert (low, high) == (ok[name].min(), ok[name].max()), name
    assert sink(tmp_path) == summary  # from the footers alone


def test_maximising(tmp_path: Path) -> None:
    objective = cs.Objective("output_stiffness_nm_per_arcmin", maximise=True)
    summary = sink(tmp_path, study=cs.Study.of(SPACE, objective=objective))
    ok = WHOLE.filter(pl.col("status") == "ok")
    assert summary.best[0]["output_stiffness_nm_per_arcmin"] == ok[objective.column].max()
    assert summary.objective == "maximise output_stiffness_nm_per_arcmin"


def test_another_objective_on_a_finished_dataset(tmp_path: Path) -> None:
    """The objective decides no numbers: the dataset is kept, the best variants are the new ones."""
    sink(tmp_path, study=cs.Study.of(SPACE))
    before = files(tmp_path)
    for column, maximise in (("hole_web_mm", True), ("pin_bending_stress_mpa", False)):
        study = cs.Study.of(SPACE, objective=cs.Objective(column, maximise))
        best = sink(tmp_path, study=study).best
        expected = WHOLE.sort(column, "variant", descending=[maximise, False], nulls_last=True)
        assert [row["variant"] for row in best] == expected["variant"].head(10).to_list()
    assert {n: b for n, b in files(tmp_path).items() if n.startswith("part")} == {
        n: b for n, b in before.items() if n.startswith("part")
    }


@pytest.mark.parametrize("maximise", [False, True])
def test_among_equals_the_first_variants_are_best_however_the_study_is_cut(
    tmp_path: Path, maximise: bool
) -> None:
    study = cs.Study.of(SPACE, objective=cs.Objective("active_pins_min", maximise))
    ok = WHOLE.filter(pl.col("status") == "ok")
    expected = ok.sort("active_pins_min", "variant", descending=[maximise, False])["variant"]
    for rows in (100, 730):
        best = sink(tmp_path / f"{rows}", study=study, rows_per_part=rows).best
        assert [row["variant"] for row in best] == expected.head(10).to_list()


@pytest.mark.parametrize("column", ["natural_frequency_hz", "statics_applicable", "variant"])
def test_an_objective_that_does_not_apply_everywhere(tmp_path: Path, column: str) -> None:
    drive = cs.Drive.reference_87().replace(input_inertia_kg_m2=None)
    study = cs.Study.of(
        cs.Space.grid(drive, output_pin_count=[6, 8, 9]), objective=cs.Objective(column)
    )
    best = sink(tmp_path, study=study).best
    assert len(best) == (0 if column == "natural_frequency_hz" else 3)


@pytest.mark.parametrize("column", ["status", "criterion"])
def test_an_objective_must_be_a_number(column: str) -> None:
    space = cs.Space.grid(cs.Drive.reference_87(), criterion=["inside", "statics"])
    with pytest.raises(cs.InputError, match=f"objective.*{column}"):
        cs.Study.of(space, objective=cs.Objective(column))


def test_a_part_says_what_it_is(tmp_path: Path) -> None:
    sink(tmp_path)
    for path in tmp_path.glob("part-*.parquet"):
        footer = read_footer(path)
        assert footer is not None
        assert footer["study"] == STUDY.hash
        assert footer["version"] == cs.__version__
        assert set(footer["columns"]) == set(WHOLE.columns)
        assert footer["columns"]["twist_4p5tn_deg"]["unit"] == "deg"
        assert footer["columns"]["reflected_compliance_rad_per_nm"]["unit"] == "rad/(N m)"
        assert all(c["meaning"] and c["unit"] for c in footer["columns"].values())
        assert footer["record"]["stop"] - footer["record"]["start"] in (ROWS, 30)
    manifest = json.loads((tmp_path / "_manifest.json").read_text())
    assert manifest["study"] == STUDY.hash
    assert manifest["version"] == cs.__version__
    assert manifest["definition"]["method"] == "sobol"
    assert manifest["definition"]["seed"] == 4


def test_the_hash_is_of_what_decides_the_numbers(reference: cs.Drive) -> None:
    space = cs.Space.grid(reference, output_pin_count=[6, 8])
    study = cs.Study.of(space)
    same = [
        cs.Study.of(cs.Space.grid(reference, output_pin_count=[6, 8])),
        cs.Study.of(space, objective=cs.Objective("hole_web_mm")),
        cs.Study.of(cs.Space.grid(reference.replace(name="other"), output_pin_count=[6, 8])),
    ]
    other = [
        cs.Study.of(space[:1]),
        cs.Study.of(space, loads_tn=[1]),
        cs.Study.of(space, limits={"hole_web_mm": (2, None)}),
        cs.Study.of(cs.Space.grid(reference, output_pin_count=[8, 6])),
        cs.Study.of(cs.Space.grid(reference, output_pin_count=[6, 8, 9])),
        cs.Study.of(cs.Space.grid(reference.replace(free_play_deg=1.0), output_pin_count=[6, 8])),
        cs.Study.of(cs.Space.grid(reference.replace(criterion="inside"), output_pin_count=[6, 8])),
        cs.Study.of(cs.Space.sobol(reference, 2, output_pin_count=[6, 8])),
        cs.Study.of(cs.Space.random(reference, 2, output_pin_count=[6, 8])),
        cs.Study.of(cs.Space.random(reference, 2, seed=1, output_pin_count=[6, 8])),
        cs.Study.of(cs.Space.grid(reference, disc_count=[1, 2])),
    ]
    assert {s.hash for s in same} == {study.hash}
    assert len({s.hash for s in other} | {study.hash}) == len(other) + 1


def flip_in_footer(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[-6] ^= 0xFF
    path.write_bytes(data)


DAMAGE: dict[str, Callable[[Path], object]] = {
    "deleted": Path.unlink,
    "emptied": lambda path: path.write_bytes(b""),
    "truncated": lambda path: path.write_bytes(path.read_bytes()[:-100]),
    "halved": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "garbage": lambda path: path.write_bytes(b"PAR1" + b"\0" * 1000 + b"PAR1"),
    "a flipped footer": flip_in_footer,
}


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("victims", [[0], [3], [7], [0, 1, 7], list(range(8))])
def test_damaged_parts_are_written_again_and_no_others(
    tmp_path: Path, damage: str, victims: list[int]
) -> None:
    sink(tmp_path)
    times = {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("part-*")}
    for victim in victims:
        DAMAGE[damage](tmp_path / f"part-{victim:06d}.parquet")
    summary = sink(tmp_path)
    assert_whole(tmp_path)
    assert summary.rows == 730
    for number in set(range(8)) - set(victims):
        path = tmp_path / f"part-{number:06d}.parquet"
        assert path.stat().st_mtime_ns == times[path.name]


def test_a_part_in_another_s_place_is_written_again(tmp_path: Path) -> None:
    sink(tmp_path)
    moved = (tmp_path / "part-000003.parquet").read_bytes()
    (tmp_path / "part-000005.parquet").write_bytes(moved)
    sink(tmp_path)
    assert_whole(tmp_path)


@pytest.mark.parametrize("damage", ["deleted", "emptied", "halved"])
def test_a_damaged_manifest_is_made_again(tmp_path: Path, damage: str) -> None:
    sink(tmp_path)
    DAMAGE[damage](tmp_path / "_manifest.json")
    sink(tmp_path)
    assert_whole(tmp_path)


OTHER = cs.Study.of(
    cs.Space.grid(cs.Drive.reference_87(), eccentricity_mm=cs.linspace(0.3, 0.8, 500))
)


@pytest.mark.parametrize("damage", ["none", "manifest", "first part", "manifest and first part"])
def test_another_study_is_refused_and_left_untouched(tmp_path: Path, damage: str) -> None:
    sink(tmp_path, study=OTHER)
    if "manifest" in damage:
        (tmp_path / "_manifest.json").unlink()
    if "first part" in damage:
        DAMAGE["truncated"](tmp_path / "part-000000.parquet")
    before = files(tmp_path)
    with pytest.raises(cs.InputError, match="holds another study") as caught:
        sink(tmp_path)
    assert str(tmp_path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert files(tmp_path) == before


def test_a_garbled_manifest_is_not_deleted_before_the_folder_is_refused(tmp_path: Path) -> None:
    sink(tmp_path, study=OTHER)
    (tmp_path / "_manifest.json").write_text("{")
    before = files(tmp_path)
    with pytest.raises(cs.InputError, match="holds another study"):
        sink(tmp_path)
    assert files(tmp_path) == before


def test_someone_else_s_parts_are_refused_and_left_untouched(tmp_path: Path) -> None:
    pl.DataFrame({"a": [1]}).write_parquet(tmp_path / "part-000000.parquet")
    before = files(tmp_path)
    for fresh in (False, True):
        with pytest.raises(cs.InputError, match=r"part-000000\.parquet"):
            sink(tmp_path, fresh=fresh)
        assert files(tmp_path) == before


@pytest.mark.parametrize("content", [b"", b"a,b\n1,2\n", b"PAR1 cut short"])
def test_unreadable_parts_without_a_manifest_are_left_untouched(
    tmp_path: Path, content: bytes
) -> None:
    (tmp_path / "part-000000.parquet").write_bytes(content)
    before = files(tmp_path)
    for fresh in (False, True):
        with pytest.raises(
            cs.InputError, match=r"part-000000\.parquet: cannot be read, and no man"
        ):
            sink(tmp_path, fresh=fresh)
        assert files(tmp_path) == before


def test_someone_else_s_manifest_is_left_untouched(tmp_path: Path) -> None:
    (tmp_path / "manifest.json").write_text('{"name": "a page"}')
    before = files(tmp_path)
    for fresh in (False, True):
        with pytest.raises(cs.InputError, match=r"manifest\.json: not written by cyclosweep"):
            sink(tmp_path, fresh=fresh)
        assert files(tmp_path) == before


def test_a_file_on_the_way_to_the_folder_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("precious")
    with pytest.raises(cs.InputError, match="file: is a file, expected a folder"):
        sink(tmp_path / "file" / "study")


def test_other_part_sizes_are_refused_and_left_untouched(tmp_path: Path) -> None:
    sink(tmp_path)
    before = files(tmp_path)
    with pytest.raises(cs.InputError, match="parts of 100 variants, expected 50"):
        sink(tmp_path, rows_per_part=50)
    assert files(tmp_path) == before


def test_without_resume_a_used_folder_is_refused(tmp_path: Path) -> None:
    sink(tmp_path, resume=False)
    before = files(tmp_path)
    with pytest.raises(cs.InputError, match="expected an empty folder"):
        sink(tmp_path, resume=False)
    assert files(tmp_path) == before


def test_fresh_replaces_whatever_study_was_there(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    sink(tmp_path, study=OTHER, rows_per_part=20)
    sink(tmp_path, fresh=True)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    (tmp_path / "notes.txt").unlink()
    assert_whole(tmp_path)


def test_a_file_in_the_folder_s_place(tmp_path: Path) -> None:
    (tmp_path / "study").write_text("mine")
    for folder in (tmp_path / "study", tmp_path / "study" / "deep"):
        with pytest.raises((cs.InputError, cs.SweepError), match="study"):
            sink(folder)
    assert (tmp_path / "study").read_text() == "mine"


def test_a_refused_study_leaves_no_new_folder(tmp_path: Path) -> None:
    with pytest.raises(cs.InputError, match="rows_per_part"):
        sink(tmp_path / "study", rows_per_part=0)
    with pytest.raises(cs.InputError, match="engine"):
        sink(tmp_path / "study", engine="gears")
    with pytest.raises(cs.InputError, match="workers"):
        sink(tmp_path / "study", workers=0)
    assert not (tmp_path / "study").exists()


def test_a_second_sweep_of_the_folder_is_refused(tmp_path: Path) -> None:
    with (
        FileLock(tmp_path / ".sweep.lock"),
        pytest.raises(cs.SweepError, match="another sweep is writing there"),
    ):
        sink(tmp_path)
    sink(tmp_path)
    assert_whole(tmp_path)


@pytest.mark.parametrize("of", [1, 2, 3, 7, 11])
def test_shards_in_any_order_are_the_whole(tmp_path: Path, of: int) -> None:
    rows = 0
    for index in reversed(range(of)):
        rows += cs.shard(STUDY, tmp_path, index=index, of=of, rows_per_part=ROWS).rows
    assert rows == 730
    assert_frame_equal(cs.scan_dataset(tmp_path).collect(), WHOLE, check_exact=True)
    assert_whole(tmp_path)


@pytest.mark.parametrize(("index", "of"), [(-1, 2), (2, 2), (0, 0), (0.0, 2), (True, 2), (0, "2")])
def test_shard_numbers_that_make_no_sense(tmp_path: Path, index: Any, of: Any) -> None:
    with pytest.raises(cs.InputError, match=r"shard: .*expected a whole number"):
        cs.shard(STUDY, tmp_path, index=index, of=of)


@pytest.mark.parametrize(
    "options",
    [{"rows_per_part": 0}, {"rows_per_part": 100.0}, {"workers": 0}, {"workers": 1.5}],
)
def test_counts_that_are_none_are_refused(tmp_path: Path, options: dict[str, Any]) -> None:
    with pytest.raises(cs.InputError, match=f"{next(iter(options))}: found .*, expected a whole"):
        sink(tmp_path / "study", **options)
    assert not (tmp_path / "study").exists()


def test_numpy_counts_are_counts(tmp_path: Path) -> None:
    sink(tmp_path / "a", rows_per_part=np.int64(ROWS), workers=np.uint8(1))
    assert_whole(tmp_path / "a")
    for index in np.arange(2):
        cs.shard(STUDY, tmp_path / "b", index=index, of=np.int32(2), rows_per_part=np.int16(ROWS))  # type: ignore[arg-type]
    assert_whole(tmp_path / "b")


def test_a_shard_of_another_study_is_refused(tmp_path: Path) -> None:
    sink(tmp_path, study=OTHER)
    before = files(tmp_path)
    with pytest.raises(cs.InputError, match="holds another study"):
        cs.shard(STUDY, tmp_path, index=0, of=2, rows_per_part=ROWS)
    assert files(tmp_path) == before


def test_an_unfinished_study_can_be_read(tmp_path: Path) -> None:
    cs.shard(STUDY, tmp_path, index=1, of=3, rows_per_part=ROWS)
    read = cs.scan_dataset(tmp_path).collect()
    parts = [1, 4, 7]
    expected = pl.concat([WHOLE[k * ROWS : (k + 1) * ROWS] for k in parts])
    assert_frame_equal(read, expected, check_exact=True)
    DAMAGE["truncated"](tmp_path / "part-000004.parquet")
    assert cs.scan_dataset(tmp_path).select(pl.len()).collect().item() == 130


def test_a_folder_without_parts_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(cs.InputError, match="no parts of a study"):
        cs.scan_dataset(tmp_path)


def failing(monkeypatch: pytest.MonkeyPatch, error: Exception, *numbers: int) -> list[int]:
    """Make some parts fail whenever they are written; returns what was tried."""
    tried: list[int] = []
    write = Dataset.write

    def fails(self: Dataset, part: Part) -> Any:
        tried.append(part.index)
        if part.index in numbers:
            raise error
        return write(self, part)

    monkeypatch.setattr(Dataset, "write", fails)
    return tried


def test_a_part_that_always_fails_is_named_and_the_others_are_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = failing(monkeypatch, RuntimeError("cosmic ray\nand more"), 2, 5)
    with pytest.raises(cs.SweepError) as caught:
        sink(tmp_path)
    message = str(caught.value)
    assert "part 2 failed: cosmic ray" in message
    assert "6 of 8 parts written" in message
    assert "\n" not in message
    assert tried.count(2) == tried.count(5) == 3
    names = {path.name for path in tmp_path.glob("part-*")}
    assert names == {f"part-{k:06d}.parquet" for k in (0, 1, 3, 4, 6, 7)}
    manifest = json.loads((tmp_path / "_manifest.json").read_text())
    assert manifest["complete"] is False
    assert manifest["rows"] == 530
    monkeypatch.undo()
    sink(tmp_path)
    assert_whole(tmp_path)


def test_a_part_that_fails_once_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, once = Dataset.write, {3}

    def fails(self: Dataset, part: Part) -> Any:
        if part.index in once:
            once.clear()
            raise RuntimeError("hiccup")
        return write(self, part)

    monkeypatch.setattr(Dataset, "write", fails)
    sink(tmp_path)
    assert_whole(tmp_path)


def test_a_full_disk_stops_the_sweep_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = failing(monkeypatch, OSError(28, "No space left on device"), *range(2, 8))
    with pytest.raises(cs.SweepError, match="No space left on device"):
        sink(tmp_path)
    assert len(tried) < 8
    monkeypatch.undo()
    sink(tmp_path)
    assert_whole(tmp_path)


def test_a_manifest_that_cannot_be_written_is_one_clear_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sink(tmp_path)
    (tmp_path / "part-000003.parquet").unlink()

    def full(*args: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Dataset, "write_manifest", full)
    with pytest.raises(cs.SweepError, match="No space left on device"):
        sink(tmp_path)


class Broken(Executor):
    """An executor whose workers are all gone."""

    def submit(self, *args: Any, **kwargs: Any) -> Future[Any]:
        raise BrokenExecutor("a worker died")


def test_a_lent_executor_that_is_broken_ends_the_sweep(tmp_path: Path) -> None:
    with pytest.raises(cs.SweepError, match="a worker died"):
        sink(tmp_path, executor=Broken())


def test_a_lent_executor_stays_open(tmp_path: Path) -> None:
    with ThreadPoolExecutor(1) as pool:
        sink(tmp_path, executor=pool)
        assert pool.submit(int, "1").result() == 1
    assert_whole(tmp_path)


@pytest.mark.parametrize("engine", ["threads", "processes"])
def test_engines_write_the_same_dataset(tmp_path: Path, engine: Any) -> None:
    sink(tmp_path, engine=engine, workers=2)
    assert_whole(tmp_path)
    single = tmp_path.with_name("single")
    sink(single, workers=1)
    assert files(single) == files(tmp_path)
