"""Reading of recordings: formats, metadata, recognition, and one clear line for bad input."""

import gzip
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.recording.signals import angle_lattice
from tests.support.arrays import present

ROWS = [
    (0.0, 0.5, 29.5, 1),
    (1.0, 4.0, 39.25, 1),
    (2.0, 8.0, 50.0, 1),
    (3.0, 4.0, 39.75, 1),
    (4.0, 0.5, 30.0, 1),
    (5.0, -4.0, -39.0, 1),
    (6.0, -8.0, -50.5, 2),
    (7.0, -4.0, -39.5, 2),
    (8.0, -0.5, -29.0, 2),
]
HEADER = "time_s,torque_nm,angle_deg,run"
TEXT = HEADER + "\n" + "".join(",".join(map(str, row)) + "\n" for row in ROWS)


def write(folder: Path, content: str | bytes, name: str = "loop.csv", meta: str = "") -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    if meta:
        (folder / "loop.toml").write_text(meta)
    return path


def assert_is_the_loop(recording: cs.Recording) -> None:
    table = np.array(ROWS)
    np.testing.assert_allclose(present(recording.time_s), table[:, 0])
    np.testing.assert_allclose(recording.torque_nm, table[:, 1])
    np.testing.assert_allclose(present(recording.angle_deg), table[:, 2])
    np.testing.assert_array_equal(recording.run, table[:, 3])
    assert recording.runs == (1, 2)


def complaint(path: Path, meta: Path | None = None) -> str:
    with pytest.raises(cs.InputError) as caught:
        cs.Recording.read(path, meta)
    text = str(caught.value)
    assert "\n" not in text
    return text


GERMAN = TEXT.replace(",", ";").replace(".", ",")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("loop.csv", TEXT.encode()),
        ("loop.csv.gz", gzip.compress(TEXT.encode())),
        ("loop.csv", gzip.compress(TEXT.encode())),
        ("loop.csv", b"\xef\xbb\xbf" + TEXT.encode()),
        ("loop.csv", TEXT.encode("utf-16")),
        ("loop.csv", GERMAN.encode()),
        ("loop.csv", TEXT.replace(",", "\t").encode()),
        ("loop.csv", TEXT.replace("\n", "\r\n").encode()),
        ("loop.csv", TEXT.replace("\n", "\r").encode()),
        ("loop.csv", ("# rig 3\n\n" + TEXT.replace("\n2.0", "\n# a pause\n2.0") + "\n\n").encode()),
        ("loop.csv", TEXT.replace(",", " , ").encode()),
        ("loop.csv", ('"' + TEXT[:-1].replace(",", '","').replace("\n", '"\n"') + '"\n').encode()),
        ("loop.csv", TEXT.replace("run\n", "run,temp °C\n").encode("latin-1")),
        ("loop.csv", TEXT.replace("\n", ",\n").encode()),
    ],
    ids=[
        "plain", "gzip", "gzip-by-content", "byte-order-mark", "utf-16", "decimal-comma", "tab",
        "crlf", "cr", "comments", "blanks", "quoted", "latin-1", "trailing-separator",
    ],
)  # fmt: skip
def test_every_dialect_reads_the_same(tmp_path: Path, name: str, content: bytes) -> None:
    assert_is_the_loop(cs.Recording.read(write(tmp_path, content, name)))


def test_parquet(tmp_path: Path) -> None:
    path = tmp_path / "loop.parquet"
    pl.DataFrame(ROWS, schema=HEADER.split(","), orient="row").write_parquet(path)
    recording = cs.Recording.read(path)
    assert_is_the_loop(recording)
    assert recording.name == "loop"


def test_metadata_rename_scale_select_and_merge(tmp_path: Path) -> None:
    text = "TIME,TORQUE,POSITION,COMMAND,PHASE,test_nr\n"
    for k in range(40):
        # two rows a tick; the position in revolutions, folded into 1/13 of a turn
        angle = (0.004 * k + 0.001) % (1 / 13)
        phase, test = "ramp" if k < 36 else "park", 7 if k > 3 else 6
        text += f"{k // 2},{1000 * k},{angle:.9f},{k},{phase},{test}\n"
    meta = """
side = "output"
history = "continuous"
conditioning_runs = [6]
holdout_runs = [7]
reset_between_runs = true
angle_resolution_deg = 0.25
[columns]
time_s = "TIME"
torque_nm = { column = "TORQUE", scale = 0.001 }
angle_deg = { column = "POSITION", scale = 360, modulo = 27.6923077 }
run = "test_nr"
[select]
run = [7]
PHASE = ["ramp"]
abs_max = { COMMAND = 30 }
[merge]
same_time = true
"""
    recording = cs.Recording.read(write(tmp_path, text, meta=meta))
    counts = np.arange(4, 31)
    expected = np.array([pair.mean() for pair in np.split(counts, range(2, len(counts), 2))])
    np.testing.assert_allclose(recording.torque_nm, expected)
    np.testing.assert_allclose(
        present(recording.angle_deg), 360 * (0.004 * expected + 0.001), atol=1e-5
    )
    assert recording.side == "output"
    assert recording.history == "continuous"
    assert recording.reset_between_runs
    assert recording.conditioning_runs == (6,)
    assert recording.holdout_runs == (7,)
    assert recording.angle_resolution_deg == 0.25
    assert any("wraps" in note for note in recording.notes)
    assert any("clock tick" in note for note in recording.notes)
    assert any("Selection keeps 27 of 40" in note for note in recording.notes)


def test_merge_does_not_reach_across_runs(tmp_path: Path) -> None:
    text = "time_s,torque_nm,run\n0,1,1\n0,3,1\n0,10,2\n1,20,2\n"
    recording = cs.Recording.read(write(tmp_path, text, meta="[merge]\nsame_time = true\n"))
    np.testing.assert_allclose(recording.torque_nm, [2, 10, 20])
    np.testing.assert_array_equal(recording.run, [1, 2, 2])


def test_given_metadata_win_over_those_beside(tmp_path: Path) -> None:
    path = write(tmp_path, TEXT, meta='side = "output"\n')
    other = tmp_path / "other.toml"
    other.write_text('side = "input"\ndrive = "reference-87"\n')
    assert cs.Recording.read(path).side == "output"
    assert cs.Recording.read(path, other).side == "input"
    assert cs.Recording.read(path, other).drive == "reference-87"


def test_drive_file_beside_the_metadata(tmp_path: Path) -> None:
    path = write(tmp_path, TEXT, meta='drive = "mine.toml"\n')
    assert "mine.toml" in complaint(path)
    (tmp_path / "mine.toml").write_text("")
    assert cs.Recording.read(path).drive == str(tmp_path / "mine.toml")


def test_program_without_metadata_is_canonical(tmp_path: Path) -> None:
    recording = cs.Recording.read(write(tmp_path, "torque_nm\n"[:-1] + ",run\n1,1\n2,1\n3,1\n"))
    assert recording.is_program
    assert recording.angle_deg is None
    assert recording.time_s is None
    assert recording.faults == ()
    assert recording.notes == ()


def test_dial_that_wraps_and_reversed_sign_are_recognised(tmp_path: Path) -> None:
    torque = np.r_[np.linspace(1, 8, 8), np.linspace(-1, -8, 8)]
    twist = 28 * np.sign(torque) + 2.73 * torque
    text = "torque_nm,angle_deg\n" + "".join(
        f"{t},{(-a) % 360:.4f}\n" for t, a in zip(torque, twist, strict=True)
    )
    recording = cs.Recording.read(write(tmp_path, text))
    np.testing.assert_allclose(present(recording.angle_deg), twist, atol=1e-3)
    assert any("wraps at 360" in note for note in recording.notes)
    assert any("sign is reversed" in note for note in recording.notes)


def test_a_wide_twist_is_not_a_wrap(tmp_path: Path) -> None:
    torque = np.r_[np.linspace(1, 30, 30), np.linspace(-1, -30, 30)]
    twist = 28 * np.sign(torque) + 2.73 * torque
    text = "torque_nm,angle_deg\n" + "".join(
        f"{t},{a:.4f}\n" for t, a in zip(torque, twist, strict=True)
    )
    recording = cs.Recording.read(write(tmp_path, text))
    np.testing.assert_allclose(present(recording.angle_deg), twist, atol=1e-3)
    assert not any("wraps" in note for note in recording.notes)


def test_steps_of_the_dial_are_recognised_unless_told(tmp_path: Path) -> None:
    torque = np.linspace(0.3, 20, 60)
    text = "torque_nm,angle_deg\n" + "".join(
        f"{t:.4f},{round(2 * (28 + 2.73 * t)) / 2}\n" for t in torque
    )
    assert cs.Recording.read(write(tmp_path, text)).angle_resolution_deg == 0.5
    fine = "torque_nm,angle_deg\n" + "".join(f"{t:.4f},{28 + 2.73 * t:.5f}\n" for t in torque)
    assert cs.Recording.read(write(tmp_path, fine)).angle_resolution_deg == 0


def test_missing_samples_are_dropped_and_said(tmp_path: Path) -> None:
    text = TEXT + "9.0,NaN,-28.0,2\n10.0,-0.2,,2\n11.0,inf,-28,2\n12.0,-0.3"
    recording = cs.Recording.read(write(tmp_path, text.replace("0.3", "0.3,,2")))
    assert_is_the_loop(recording)
    assert any("4 of 13 samples without a finite value" in note for note in recording.notes)


def test_repeated_rows_are_dropped_only_with_a_clock(tmp_path: Path) -> None:
    repeated = TEXT.replace("2.0,8.0,50.0,1\n", "2.0,8.0,50.0,1\n" * 3)
    recording = cs.Recording.read(write(tmp_path, repeated))
    assert_is_the_loop(recording)
    assert any("2 rows that repeat" in note for note in recording.notes)
    held = "torque_nm,angle_deg\n8,50\n8,50\n8,50\n"
    assert len(cs.Recording.read(write(tmp_path, held))) == 3


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", ["empty"]),
        ("\n \n", ["empty"]),
        ("# only a comment\n", ["only comments"]),
        ("angle_deg\n1\n2\n", ["line 1", "one column"]),
        ("1,2\n3,4\n", ["line 1", "header"]),
        ("1.5 2.5\n3 4\n", ["line 1", "numbers", "header"]),
        ("torque,angle\n1,2\n", ["no column torque_nm", "torque, angle", "[columns]"]),
        (TEXT.replace("50.0", "fifty"), ["line 4", "angle_deg", "'fifty'", "number"]),
        ("# c\n" + TEXT.replace("50.0", "50.0 deg"), ["line 5", "angle_deg", "'50.0 deg'"]),
        (TEXT.replace("50.0", "50,0"), ["line 4", "5 cells", "4"]),
        (TEXT.replace("angle_deg", "torque_nm"), ["line 1", "more than once"]),
        (TEXT.replace("50.0,1", "50.0,1.5"), ["data row 3", "run", "1.5", "integer"]),
        (b"PK\x03\x04\0\0\0\0" + bytes(range(256)), ["binary"]),
        (b"PAR1" + bytes(64), ["Parquet"]),
        (gzip.compress(TEXT.encode())[:-20], ["truncated gzip"]),
        (b"\x1f\x8b" + bytes(40), ["gzip"]),
    ],
)
def test_bad_input_is_one_line(tmp_path: Path, content: str | bytes, words: list[str]) -> None:
    path = write(tmp_path, content)
    text = complaint(path)
    assert str(path) in text
    for word in words:
        assert word in text


@pytest.mark.parametrize(
    ("meta", "words"),
    [
        ("sides = 'input'", ["sides", "unknown key"]),
        ("side = 'left'", ["side", "'left'", "input"]),
        ("side = ", ["TOML"]),
        ("angle_resolution_deg = '0.5'", ["angle_resolution_deg", "'0.5'", "number"]),
        ("angle_resolution_deg = -1", ["angle_resolution_deg", "-1"]),
        ("[columns]\ntorque = 'T'", ["columns.torque", "'torque'"]),
        ("[columns]\ntorque_nm = 'T'", ["columns.torque_nm", "'T'", "found time_s"]),
        ("[columns]\ntorque_nm = {column = 'run', scale = 0}", ["scale", "0"]),
        ("[columns]\ntorque_nm = {column = 'run', factor = 2}", ["factor", "unknown key"]),
        ("[select]\nrun = [17]", ["select.run", "17"]),
        ("[select]\nrun = 17", ["select.run", "list"]),
        ("[select]\nnothing = [1]", ["select.nothing"]),
        ("[select]\nabs_max = {nothing = 1}", ["select.abs_max.nothing"]),
        ("[select]\nrun = ['one']", ["select.run", "numbers"]),
        ("conditioning_runs = [1]\nholdout_runs = [1]", ["run 1", "both"]),
        ("conditioning_runs = [1.5]", ["conditioning_runs", "1.5", "integer"]),
        ("[merge]\nsame_times = true", ["same_times", "unknown key"]),
    ],
)
def test_bad_metadata_is_one_line(tmp_path: Path, meta: str, words: list[str]) -> None:
    text = complaint(write(tmp_path, TEXT, meta=meta))
    assert "loop.toml" in text
    for word in words:
        assert word in text


def test_files_that_are_not_there(tmp_path: Path) -> None:
    assert "no such file" in complaint(tmp_path / "nothing.csv")
    assert "is a folder, expected a file" in complaint(tmp_path)
    assert "gone.toml" in complaint(write(tmp_path, TEXT), tmp_path / "gone.toml")


def test_arrays_cannot_be_changed(tmp_path: Path) -> None:
    recording = cs.Recording.read(write(tmp_path, TEXT))
    with pytest.raises(ValueError, match="read-only"):
        recording.torque_nm[0] = 1.0


def test_from_arrays_take_and_frame() -> None:
    torque = np.linspace(1, 10, 20)
    recording = cs.Recording.from_arrays(
        torque, 2 * torque, run=np.repeat([3, 1], 10), side="output"
    )
    assert recording.runs == (3, 1)
    part = recording.take(recording.in_runs([1]))
    np.testing.assert_allclose(part.torque_nm, torque[10:])
    assert part.side == "output"
    assert recording.to_frame().columns == ["torque_nm", "angle_deg", "run"]
    torque[0] = 99.0
    assert recording.torque_nm[0] == 1.0
    with pytest.raises(ValueError, match="angle_deg"):
        cs.Recording.from_arrays(torque, torque[:3])


@pytest.mark.parametrize("step", [0.5, 0.25, 1.0, 360 / 1024, 0.3, 0.9, 4.0, 1.8, 0.716, 1 / 60])
@pytest.mark.parametrize("noise", [0.0, 0.6])
def test_steps_of_an_angle_are_its_resolution(step: float, noise: float) -> None:
    rng = np.random.default_rng(2)
    torque = np.concatenate([np.linspace(0, 30, 200), np.linspace(30, -30, 400)])
    angle = 2.7 * torque + noise * step * rng.standard_normal(600)
    if step < 0.1:
        angle /= 50.0
    assert angle_lattice(step * np.rint(angle / step), torque) == pytest.approx(step, rel=1e-5)


@pytest.mark.parametrize(
    ("step", "decimals"), [(0.164265, 5), (0.018893, 5), (360 / 8192, 4), (360 / 8192, 3)]
)
def test_steps_that_were_rounded_as_they_were_printed_are_a_resolution(
    step: float, decimals: int
) -> None:
    rng = np.random.default_rng(4)
    torque = np.concatenate([np.linspace(0, 30, 200), np.linspace(30, -30, 400)])
    angle = 0.1 * torque + 0.3 * step * rng.standard_normal(600)
    printed = np.round(step * np.rint(angle / step), decimals)
    assert angle_lattice(printed, torque) == pytest.approx(step, rel=1e-4)


def test_readings_of_a_continuous_angle_lie_on_no_steps() -> None:
    rng = np.random.default_rng(5)
    for count in range(4, 60):
        torque = rng.uniform(-10, 10, count)
        angle = np.round(0.3 * torque + 0.01 * rng.standard_normal(count), 5)
        assert angle_lattice(angle, torque) == 0.0


@pytest.mark.parametrize("readings", [1, 4])
def test_angles_that_are_prescribed_have_no_resolution(readings: int) -> None:
    rng, place = np.random.default_rng(3), np.repeat(np.arange(-4.0, 5.0), readings)
    angle, run = np.tile(18.0 * place, 6), np.repeat(np.arange(6.0), len(place))
    torque = angle / 2.7 + 0.05 * rng.normal(size=len(angle))
    assert angle_lattice(angle, torque, run) == 0.0


@pytest.mark.parametrize("step", [0.3, 0.9, 4.0])
def test_even_steps_of_torque_on_a_straight_line_are_no_resolution(step: float) -> None:
    place = np.concatenate([np.arange(0, 40), np.arange(40, -40, -1), np.arange(-40, 0)])
    assert angle_lattice(step * place, 0.7 * place) == 0.0


def test_a_true_half_turn_is_not_a_wrap(tmp_path: Path) -> None:
    torque = np.tile([30.0, -30.0, 25.0, -25.0], 5)
    twist = 28 * np.sign(torque) + 2.73 * torque
    text = "torque_nm,angle_deg\n" + "".join(
        f"{t},{a:.4f}\n" for t, a in zip(torque, twist, strict=True)
    )
    recording = cs.Recording.read(write(tmp_path, text))
    np.testing.assert_allclose(present(recording.angle_deg), twist, atol=1e-3)


def test_mostly_missing_is_a_data_fault(tmp_path: Path) -> None:
    text = "torque_nm,angle_deg\n" + "".join(
        f"{k},{28 + 2.7 * k if k % 2 else ''}\n" for k in range(1, 41)
    )
    fault = cs.Recording.read(write(tmp_path, text)).blocking_fault
    assert fault is not None
    assert (fault.kind, fault.verdict) == ("missing_values", "DATA_FAULT")
    assert "20 of 40" in fault.reason


@pytest.mark.parametrize("head", ["sep=;\n", "\ufeffsep=;\r\n"])
def test_a_spreadsheets_separator_line_is_passed_over(tmp_path: Path, head: str) -> None:
    assert_is_the_loop(cs.Recording.read(write(tmp_path, (head + GERMAN).encode())))


def test_semicolons_with_decimal_points(tmp_path: Path) -> None:
    text = TEXT.replace(",", ";").replace("run\n", 'run;"note, free"\n')
    assert_is_the_loop(cs.Recording.read(write(tmp_path, text)))
    mixed = text.replace("29.5;1\n", "29.5;1;warm, dry\n")
    assert_is_the_loop(cs.Recording.read(write(tmp_path, mixed)))


def test_rows_of_a_clock_that_is_rounded_are_spread_over_its_ticks(tmp_path: Path) -> None:
    torque = 2.0 * np.r_[np.arange(10), np.arange(8, -1, -1)]
    time_s = np.floor(np.arange(19) / 3.0)
    time_s[14:] += 30.0
    rows = [f"{t:g},{m:g},{28 + 2.7 * m:.2f}" for t, m in zip(time_s, torque, strict=True)]
    text = "time_s,torque_nm,angle_deg\n" + "\n".join(rows) + "\n"
    found = cs.Recording.read(write(tmp_path, text))
    assert found.time_s is not None
    steps = np.diff(found.time_s)
    assert steps[:9] == pytest.approx(1 / 3)
    assert found.time_s[14:18] == pytest.approx([34.0, 35.0, 35.0 + 1 / 3, 35.0 + 2 / 3])
    assert any("rounded to 1 s while the torque moves" in note for note in found.notes)
    assert not any(fault.kind == "clock_ticks" for fault in found.faults)


def test_rows_of_a_rounded_clock_stay_before_the_next_run(tmp_path: Path) -> None:
    torque = 2.0 * np.tile(np.arange(9), 2)
    time_s = np.r_[np.repeat([0.0, 1.0, 2.0], 3), np.repeat([2.4, 3.4, 4.4], 3)]
    rows = [
        f"{k // 9},{t:g},{m:g},{28 + 2.7 * m:.2f}"
        for k, (t, m) in enumerate(zip(time_s, torque, strict=True))
    ]
    text = "run,time_s,torque_nm,angle_deg\n" + "\n".join(rows) + "\n"
    found = cs.Recording.read(write(tmp_path, text))
    assert found.time_s is not None
    assert np.all(np.diff(found.time_s) > 0)


def test_rows_of_one_reading_keep_their_time(tmp_path: Path) -> None:
    torque = np.repeat(2.0 * np.arange(8), 3)
    rows = [f"{k // 3},{m:g},{28 + 2.7 * m + 0.01 * (k % 2):.2f}" for k, m in enumerate(torque)]
    text = "time_s,torque_nm,angle_deg\n" + "\n".join(rows) + "\n"
    found = cs.Recording.read(write(tmp_path, text))
    assert found.time_s is not None
    assert len(np.unique(found.time_s)) == 8


@pytest.mark.parametrize("last", ["9.0,0.5,", "9.0,0.5,29.5", "9.0,0.5,29.5,", "9.0"])
def test_a_last_row_that_the_logger_did_not_finish_is_passed_over(
    tmp_path: Path, last: str
) -> None:
    recording = cs.Recording.read(write(tmp_path, TEXT + last))
    assert_is_the_loop(recording)
    (note,) = [note for note in recording.notes if "incomplete" in note]
    assert "data row 10" in note
    assert "run" in note


def test_a_row_without_its_run_elsewhere_is_refused(tmp_path: Path) -> None:
    text = TEXT.replace("2.0,8.0,50.0,1", "2.0,8.0,50.0,")
    said = complaint(write(tmp_path, text))
    assert "data row 3, column run: found no number, expected an integer" in said
