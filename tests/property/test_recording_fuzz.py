"""Whatever the bytes, reading ends in a recording or in one line of `cs.InputError`."""

import gzip
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import cyclosweep as cs
from tests.unit.test_recording_formats import WRITERS

FUZZ = settings(
    max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)

VALID = b"time_s,torque_nm,angle_deg,run\n" + b"".join(
    f"{k},{k - 8}.5,{3 * k - 20}.25,{1 + k // 9}\n".encode() for k in range(18)
)

cells = st.one_of(
    st.floats().map(repr),
    st.integers().map(str),
    st.sampled_from(
        ["", "NaN", "-", "1,5", "1e400", '"', "0x1F", "１", "#", "1 2", "\0", ";", "é"]
    ),
    st.text(max_size=4),
)
names = st.sampled_from(["torque_nm", "angle_deg", "time_s", "run", "crank_deg", "x", "", " run"])
tables = st.tuples(
    st.lists(names, max_size=5),
    st.lists(st.lists(cells, max_size=6), max_size=12),
    st.sampled_from([",", ";", "\t"]),
    st.sampled_from(["\n", "\r\n", "\r"]),
).map(
    lambda table: (
        table[3]
        .join(table[2].join(row) for row in [table[0], *table[1]])
        .encode("utf-8", "replace")
    )
)
mangled = st.lists(
    st.tuples(st.integers(0, len(VALID) - 1), st.integers(0, 255)), min_size=1, max_size=6
).map(lambda edits: bytes(dict(edits).get(i, byte) for i, byte in enumerate(VALID)))
zipped = st.tuples(st.integers(0, 90), st.integers(0, 255)).map(
    lambda edit: (lambda raw: raw[: edit[0]] + bytes([edit[1]]) + raw[edit[0] + 1 :])(
        gzip.compress(VALID, mtime=0)
    )
)
scalars = st.one_of(st.booleans(), st.integers(), st.floats(), st.text(max_size=5))
values = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["column", "scale", "modulo", "run", "abs_max", "TEXT"]), inner
        )
    ),
    max_leaves=6,
)
keys = st.sampled_from(
    [
        "side", "drive", "angle_resolution_deg", "history", "reset_between_runs",
        "conditioning_runs", "holdout_runs", "columns", "select", "merge", "columns.angle_deg",
        "columns.torque_nm.column", "columns.torque_nm.scale", "select.run", "select.abs_max.run",
        "merge.same_time", "other",
    ]
)  # fmt: skip


def toml(value: object) -> str:
    """Write a value as TOML does, text unescaped on purpose."""
    match value:
        case bool():
            return str(value).lower()
        case str():
            return f'"{value}"'
        case list():
            return "[" + ", ".join(map(toml, value)) + "]"
        case dict():
            return "{" + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + "}"
    return repr(value)


metadata = st.dictionaries(keys, values, max_size=4).map(
    lambda table: "\n".join(f"{key} = {toml(item)}" for key, item in table.items())
)


def read_or_refuse(content: bytes, meta: bytes | None = None, name: str = "loop.csv") -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        if meta is not None:
            path.with_name("loop.toml").write_bytes(meta)
        complaint = None
        try:
            recording = cs.Recording.read(path)
        except cs.InputError as error:
            complaint = str(error)
        if complaint is not None:
            assert len(complaint.splitlines()) == 1
            return
        assert len(recording.structure.loading) == len(recording)
        assert all(fault.reason for fault in recording.faults)


@FUZZ
@given(st.binary(max_size=300))
def test_random_bytes(content: bytes) -> None:
    read_or_refuse(content)
    read_or_refuse(b"PAR1" + content)
    read_or_refuse(b"\x1f\x8b\x08" + content)


@FUZZ
@given(mangled)
def test_damaged_csv(content: bytes) -> None:
    read_or_refuse(content)


@FUZZ
@given(zipped)
def test_damaged_gzip(content: bytes) -> None:
    read_or_refuse(content, name="loop.csv.gz")


@FUZZ
@given(tables)
def test_made_up_tables(content: bytes) -> None:
    read_or_refuse(content)


@FUZZ
@given(
    st.one_of(metadata.map(lambda text: text.encode("utf-8", "replace")), st.binary(max_size=80))
)
def test_made_up_metadata(meta: bytes) -> None:
    read_or_refuse(VALID, meta)


@pytest.mark.parametrize("kind", ["mat5", "mat7.3", "tdms", "json", "labview", "excel", "german"])
def test_damaged_files_of_laboratory_programs(tmp_path: Path, kind: str) -> None:
    name, write = WRITERS[kind]
    write(tmp_path / name)
    content = (tmp_path / name).read_bytes()
    meta = b'[columns]\ntorque_nm = "Torque"\nangle_deg = "Angle"\n'
    rng = np.random.default_rng(7)
    for _ in range(60):
        damaged = bytearray(content)
        for place in rng.integers(0, len(content), rng.integers(1, 8)):
            damaged[place] = int(rng.integers(0, 256))
        cut = int(rng.integers(1, len(content))) if rng.random() < 0.3 else len(content)
        read_or_refuse(bytes(damaged[:cut]), meta, name)
