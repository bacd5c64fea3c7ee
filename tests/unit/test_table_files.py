"""Tables as CSV, Excel and Parquet: what is written reads back, a damaged file is one line."""

from __future__ import annotations

import gzip
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import cyclosweep as cs
from cyclosweep.sweep.table_files import read_table, row_in_file, write_table

FRAME = pl.DataFrame(
    {
        "label": ["Größe 1", None, "c"],
        "part": ["0012", "0013", None],
        "eccentricity_mm": [0.5, 1.23456789012e-7, None],
        "output_pin_count": [6, 8, 12],
    }
)


@pytest.mark.parametrize("ending", [".csv", ".xlsx", ".parquet"])
def test_what_is_written_reads_back(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"Entwürfe mit Leerzeichen{ending}"
    write_table(FRAME, path)
    assert_frame_equal(read_table(path), FRAME, check_exact=True)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_words_of_a_sweep_are_text_in_excel(tmp_path: Path) -> None:
    frame = cs.sweep(cs.Space.grid(cs.Drive.reference_87(), eccentricity_mm=[0.6, 0.9]))
    write_table(frame, tmp_path / "a.xlsx")
    found = read_table(tmp_path / "a.xlsx")
    assert found["status"].to_list() == ["ok", "eccentricity_too_large_for_ring"]
    stiffness = "output_stiffness_nm_per_arcmin"
    assert found[stiffness][0] == pytest.approx(frame[stiffness][0], rel=1e-15)
    assert found[stiffness][1] is None


def test_semicolons_decimal_commas_and_the_encoding_of_windows(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes("Größe;eccentricity_mm\r\nklein;0,5\r\n\r\ngroß;1,5e-1\r\n".encode("cp1252"))
    expected = {"Größe": ["klein", "groß"], "eccentricity_mm": [0.5, 0.15]}
    assert read_table(path).to_dict(as_series=False) == expected
    # A line of a CSV file that is counted: the blank one is row 3.
    kept = read_table(path, keep_blank_rows=True)
    assert row_in_file(path, kept["Größe"].to_list().index("groß")) == 4
    (tmp_path / "b.csv.gz").write_bytes(gzip.compress(b"a,b\n1,2\n"))
    assert read_table(tmp_path / "b.csv.gz").rows() == [(1, 2)]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", b"", "empty"),
        ("a.csv", b"a,b\n1,2\n1,2,3\n", "row 3: found 3 cells, expected 2"),
        ("a.csv", b"a,b\n1,2\n\n1\n", "row 4: found 1 cells, expected 2"),
        ("a.csv", b"a,a\n1,2\n", "the column a twice"),
        ("a.csv.gz", b"\x1f\x8b broken", "damaged"),
        ("a.xlsx", b"a,b\n", "not a workbook"),
        ("a.parquet", b"a,b\n", "not a table"),
        ("a.doc", b"", "expected .csv, .xlsx or .parquet"),
        ("a.csv", None, "No such file"),
        ("a.xlsx", None, "No such file"),
        ("a.parquet", None, "No such file"),
    ],
)
def test_a_file_that_is_no_table(
    tmp_path: Path, name: str, content: bytes | None, message: str
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(cs.InputError) as caught:
        read_table(path)
    assert str(caught.value).startswith(str(path))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_cannot_be_written_is_refused_and_leaves_the_file(tmp_path: Path) -> None:
    with pytest.raises(cs.InputError, match=r"expected .csv, .xlsx or .parquet"):
        write_table(FRAME, tmp_path / "a.doc")
    path = tmp_path / "a.xlsx"
    path.write_text("before")
    with pytest.raises(cs.InputError, match="at most 1,048,575 for Excel"):
        write_table(pl.select(x=pl.int_range(0, 2**20)), path)
    assert path.read_text() == "before"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "eccentricity_mm,output_pin_count\n0.5,8\n\n0.6,x\n",
            "row 4, output_pin_count: found 'x'",
        ),
        ("eccentricity_mm,criterion\n0.5,insid\n", "row 2, criterion: found 'insid', expected one"),
        ("eccentricity_mm,output_pin_count\n0.5,8\n0.6\n", "row 3: found 1 cells, expected 2"),
        ("eccentricity_mm,output_pin_count\n", "no rows below the header"),
    ],
)
def test_a_study_names_the_row_of_its_table(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "variants.csv").write_text(text)
    study = tmp_path / "study.toml"
    study.write_text('[sample]\nmethod = "table"\nfile = "variants.csv"\n')
    with pytest.raises(cs.InputError) as caught:
        cs.Study.from_toml(study)
    assert f"{tmp_path / 'variants.csv'}" in str(caught.value)
    assert message in str(caught.value)
