"""The real drive's part of the page of record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from cyclosweep_challenge.record.markdown import Plain, table
from cyclosweep_challenge.scoring.intervals import share


def real_drive(rows: Sequence[Plain]) -> str:
    """Tables of the measured loops, or a line that says why there are none."""
    head = "## A real drive\n\n"
    if not rows:
        return (
            head + "The measured loops were not there when this was made. "
            "`examples/measured-13-to-1/README.md` says where the public data are; "
            "`--measured DIR --drive FILE` or `CYCLOSWEEP_MEASURED` shows them to the record."
        )
    kinds = {kind: [r for r in rows if r["kind"] == kind] for kind in {r["kind"] for r in rows}}

    def of(kind: str) -> list[Plain]:
        return list(kinds.get(kind, []))

    return "\n\n".join(
        (
            head + "Torque ramps of a 3D-printed 13:1 drive with its output locked "
            "([examples/measured-13-to-1](../examples/measured-13-to-1/README.md)): real noise, "
            "real stick-slip, and nobody knows the true list of causes. Errors are those on "
            "readings above 1 N m; the crossing of the play, where timing looks like angle, is "
            "left out.",
            _unseen(of("predicted")),
            _nulls(of("repeated loops")),
            _terms(of("one term missing"), of("no term missing"), of("both ramps")),
            _library(of("term taken out of the library")),
            _injected(of("effect injected")),
            _confounded(of("several causes at once")),
        )
    )


def _number(value: object) -> str:
    """Number to three digits, or a dash."""
    return f"{value:.3g}" if isinstance(value, (int, float)) else "–"


def _names(row: Plain) -> str:
    """Named effects, or a dash."""
    return ", ".join(row["named"]).replace("_", " ") or "–"


def _unseen(rows: Sequence[Plain]) -> str:
    """Table of predictions of ramps that were not fitted."""
    return (
        "### One ramp diagnosed, another predicted\n\n"
        "The diagnosis sees ramp 101 (100 conditions the drive) and its model predicts ramp 102 "
        "of the same file, or of the file taken at another locking position with the datum free. "
        "Before: the published model, calibrated alone. Floor: ramp 101 itself as the prediction "
        "of that ramp.\n\n"
        + table(
            ("file", "predicted", "before [deg]", "after [deg]", "floor [deg]", "named"),
            (
                (
                    r["file"],
                    r["detail"],
                    _number(r["numbers"]["before_deg"]),
                    _number(r["numbers"]["after_deg"]),
                    _number(r["numbers"]["floor_deg"]),
                    _names(r),
                )
                for r in rows
            ),
        )
    )


def _nulls(rows: Sequence[Plain]) -> str:
    """Table of repeated loops."""
    alarms = sum(not r["good"] for r in rows)
    bound = share(alarms, len(rows)).high if rows else float("nan")
    by_file = {file: [r for r in rows if r["file"] == file] for file in {r["file"] for r in rows}}
    return (
        "### Repeated loops: the real null\n\n"
        "What differs between two repeats, laid over the line that fits the first: nothing is "
        f"missing but noise as it really is. {alarms} false alarms in {len(rows)} recordings "
        f"(upper bound {100 * bound:.0f} % if they were independent; those of one file share "
        "their noise and are not).\n\n"
        + table(
            ("file", "nulls", "false alarms", "what was said"),
            (
                (
                    file,
                    len(some),
                    sum(not r["good"] for r in some),
                    ", ".join(
                        f"{k} {v.lower()}" for v, k in Counter(r["verdict"] for r in some).items()
                    )
                    + "".join(f"; {r['detail']}: {_names(r)}" for r in some if not r["good"]),
                )
                for file, some in sorted(by_file.items())
            ),
        )
    )


def _terms(single: Sequence[Plain], none: Sequence[Plain], both: Sequence[Plain]) -> str:
    """Tables of terms removed from the recording."""
    back = sum(bool(r["good"]) for r in single)
    return (
        "### A term removed from the accepted model, and restored\n\n"
        "Of the measured ramps all that the accepted model adds is taken away but one term, so "
        "that the recording lacks that term alone and keeps everything the model does not "
        f"explain. {back} of {len(single)} terms were named again. With no term left in, whatever "
        "is still named is named on what the model does not explain.\n\n"
        + table(
            ("file", "missing", "said", "named", "restored"),
            (
                (
                    r["file"],
                    r["detail"].replace("_", " ") or "nothing",
                    r["verdict"],
                    _names(r),
                    "" if r["good"] is None else "yes" if r["good"] else "no",
                )
                for r in sorted([*single, *none], key=lambda r: (r["file"], r["detail"]))
            ),
        )
        + "\n\nBoth ramps as measured:\n\n"
        + table(
            ("file", "said", "named", "left over [deg]"),
            ((r["file"], r["verdict"], _names(r), _number(r["rmse_deg"])) for r in both),
        )
    )


def _library(rows: Sequence[Plain]) -> str:
    """Table of terms removed from the library."""
    return (
        "### A term taken out of the library\n\n"
        "The ramps as measured, diagnosed without one of the effects it had accepted.\n\n"
        + table(
            (
                "file",
                "may not be used",
                "said",
                "named instead",
                "left over [deg]",
                "with it [deg]",
                "unseen ramp [deg]",
            ),
            (
                (
                    r["file"],
                    r["detail"].replace("_", " "),
                    r["verdict"],
                    _names(r),
                    _number(r["rmse_deg"]),
                    _number(r["numbers"]["rmse_with_it_deg"]),
                    _number(r["numbers"]["held_out_deg"]),
                )
                for r in rows
            ),
        )
    )


def _injected(rows: Sequence[Plain]) -> str:
    """Table of injected effects."""
    body = []
    for name in sorted({r["detail"] for r in rows}):
        for size in sorted({r["size_deg"] for r in rows}):
            here = [r for r in rows if r["detail"] == name and r["size_deg"] == size]
            fair = [r for r in here if r["good"] is not None]
            taken = [
                r["numbers"]["share_taken_up"]
                for r in here
                if r["numbers"]["share_taken_up"] is not None
            ]
            body.append(
                (
                    name.replace("_", " "),
                    f"{size:g}",
                    f"{sum(bool(r['good']) for r in fair)} of {len(fair)}",
                    _number(float(np.median(taken))) if taken else "–",
                    ", ".join(_number(t) for t in sorted(taken)),
                )
            )
    return (
        "### Signatures injected into measured ramps\n\n"
        "The size is the rms after re-calibration. Named counts the files whose ramps as measured "
        "do not show the effect already; taken up is the part of the injected signature by which "
        "the repaired model's prediction changed.\n\n"
        + table(("effect", "size [deg]", "named", "taken up, median", "taken up, each file"), body)
    )


def _confounded(rows: Sequence[Plain]) -> str:
    """Table of recordings with several causes at once."""
    return (
        "### Several causes at once\n\n"
        "A file that warmed up while it was taken, and the same kind of drive cold at another "
        "locking position, as one recording: temperature, run-in, reaming and position differ "
        "together and none was recorded. Right is AMBIGUOUS or UNKNOWN_PHYSICS without a "
        "name that these files cannot show.\n\n"
        + table(
            ("recording", "said", "named", "right"),
            (
                (
                    r["file"] + (f", {r['detail']}" if r["detail"] else ""),
                    r["verdict"],
                    _names(r),
                    "yes" if r["good"] else "no",
                )
                for r in rows
            ),
        )
    )
