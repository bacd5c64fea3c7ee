"""Hereditary memory: the zero moves from run to run."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.datum_laws import (
    NUMBER,
    PUSH_NAMES,
    PUSHES,
    DatumLaw,
    Explanation,
    best_laws,
    left_out_share,
    pairs_of_laws,
    runs_of,
    single_laws,
)
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.mesh_range import mesh_positions

__all__ = ["PUSHES", "PUSH_NAMES", "DatumDrift"]

FEWEST_RUNS, MOST_RUNS = 4, 60
"""Runs between which a datum without a law is looked for."""
FEWEST_FOR_LAW = 8
"""Runs from which a law is believed of free offsets that go to and fro."""
UNEXPLAINED = 0.1
"""Share of the offsets of the runs up to which the laws that explain the rest are believed."""
TO_AND_FRO, OF_MANY = 1.0, 0.5
"""Mean square of the steps from run to run over that of the offsets (von Neumann's ratio) from
which a datum goes to and fro, and from which where the runs are enough for a law; 2 where every run
has an offset of its own, near zero for a drift."""
LEAST_SWING = 0.3
"""Share of the range of the offsets by which the datum must both rise and fall."""
OTHER_CAUSE = 0.25
"""Share of the offsets below which temperature or mesh position leaves too little unexplained to
call the datum erratic."""


class DatumDrift(Effect):
    """Datum that differs from run to run.

    Either by a law: `push` says what moves it (see `PUSH_NAMES`), `memory` is the part kept from
    run to run, below zero where the datum turns back, and with `reset` a run at full load in both
    directions wipes what was kept. Or without one: with `each_run` the offset of every run is free.
    Such a datum is put down to a law where one explains it on runs left out, and called erratic
    where it goes to and fro and neither temperature nor mesh position explains it.

    Two more shapes stand in files only: `erratic`, which gives no run an offset, and `free`, as
    written before, with offsets from the first run on.
    """

    name = "datum_drift"
    physics = (
        "Rollers, bushes and pins do not return to where they were: the zero remembers what the "
        "runs before have done. Turning the rig beyond both dead centres resets it."
    )
    source = "Kumar et al. 2016 (datum drift of up to 1 deg over repeated runs)"
    tell_tale = "offset differs by run, tied to what the last run did"
    shown_by = "three or more runs without a reset between them"
    family = "run offsets"
    shape_parameters = (
        Parameter("memory", "", "part of the shift kept to the next run", -1.0, 1.0),
    )
    forms = (
        ShapeForm(("push", "memory"), ("push_2", "memory_2", "reset")),
        ShapeForm(("each_run",)),
        ShapeForm(("erratic",)),
        ShapeForm(("free",)),
    )

    def untestable(self, history: History) -> str | None:
        """Need at least three runs without a reset in between."""
        if history.resets_datum:
            return "the rig was reset between runs, so the datum cannot remember"
        if history.run_count < 3:
            return "it takes at least three runs to see the datum move"
        return super().untestable(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Every law with several memories, every two pushes, and free offsets."""
        few = (0.4, 0.9)
        grid = [
            _shape(law)
            for law in single_laws(history)
            if not (law.push == NUMBER and law.memory in few)
        ]
        if FEWEST_RUNS <= history.run_count <= MOST_RUNS:
            grid += [_shape(*pair) for pair in pairs_of_laws(history, (0.0, 0.4, 0.7))]
            grid.append({"each_run": 1.0})
        return grid

    def columns(self, history: History, shape: Shape) -> Floats:
        """Shift of the datum for a unit push, or for the offset of each run [deg]."""
        if "erratic" in shape:
            return np.zeros((len(history), 1))
        if "free" in shape or "each_run" in shape:
            own = np.asarray(history.run[:, None] == np.arange(1, history.run_count), np.float64)
            # Offsets from the mean of all runs add up to nothing.
            return np.asarray(own - (history.run == 0)[:, None]) if "each_run" in shape else own
        length = np.diff(np.r_[history.run_starts, len(history)])
        return np.column_stack(
            [np.repeat(law.shifts_deg(history), length) for law in DatumLaw.all_of(shape)]
        )

    def penalty(self, shape: Shape) -> float:
        """Free offsets hold whatever differs from run to run."""
        return 6.0 if "each_run" in shape else 0.0

    def is_recognised(self, history: History, shape: Shape, amplitudes: Floats) -> bool:
        """Free offsets are drift of the datum if a law explains them, or if they are erratic."""
        if "each_run" not in shape:
            return True
        offsets = _offsets(amplitudes)
        return _law_of(history, offsets) is not None or _erratic(history, offsets)

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Free offsets hold every law."""
        return dict(found) if "each_run" in found and "each_run" not in shape else None

    def found_law(self, history: History, shape: Shape, amplitudes: Floats) -> str:
        """Say which law fits, or by how much the datum moves without one."""
        if "each_run" not in shape:
            return f"Found: {'; '.join(map(str, DatumLaw.all_of(shape)))}."
        offsets = _offsets(amplitudes)
        law = _believed_law(history, offsets)
        if law is not None:
            laws = "; ".join(map(str, law.laws))
            return f"Found: {laws}; {100 * law.left:.2g} % of the offsets are left."
        return (
            "Found: no law of the runs before explains the offsets, the datum is erratic. It moves "
            f"from run to run by {np.std(offsets, ddof=1):.2g} deg (standard deviation), between "
            f"{offsets.min():.2g} and {offsets.max():.2g} deg from its mean."
        )

    def notes(self, history: History, shape: Shape, amplitudes: Floats) -> tuple[str, ...]:
        """Say that an erratic datum is not predicted."""
        if "each_run" not in shape or _believed_law(history, _offsets(amplitudes)) is not None:
            return ()
        return (
            "datum_drift: the datum is erratic, so that a prediction gives no run an offset; expect"
            f" the offset of a new run within {2 * np.std(_offsets(amplitudes), ddof=1):.2g} deg.",
        )

    def fewer_amplitudes(self, shape: Shape) -> bool:
        """Free offsets: one a run after the first, up to sixty."""
        return "free" in shape or "each_run" in shape

    def portable(
        self, history: History, shape: Shape, amplitudes: Floats
    ) -> tuple[Shape, Sequence[float]]:
        """Laws that explain free offsets, or their spread where none does."""
        if "each_run" not in shape:
            return shape, amplitudes.tolist()
        offsets = _offsets(amplitudes)
        law = _believed_law(history, offsets)
        if law is not None:
            return _shape(*law.laws), law.shifts_deg.tolist()
        return {"erratic": 1.0}, [float(np.std(offsets, ddof=1))]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Shift by one push, or the offset of each run after the first."""
        if "erratic" in shape:
            return (Parameter("spread_deg", "deg", "standard deviation of the runs' offsets", 0.0),)
        if "free" in shape or "each_run" in shape:
            since = "mean of all runs" if "each_run" in shape else "first run"
            return tuple(
                Parameter(f"shift_{k}_deg", "deg", f"shift of run {k + 1} from the {since}")
                for k in range(1, MOST_RUNS + 1)
            )
        return tuple(
            Parameter(
                f"shift{'' if k == 1 else f'_{k}'}_deg",
                "deg",
                f"shift a unit ({law.unit}) of {PUSH_NAMES[law.push]}",
            )
            for k, law in enumerate(DatumLaw.all_of(shape), 1)
        )


def _shape(*laws: DatumLaw) -> dict[str, float]:
    """Shape of one law, or of two with one memory."""
    shape = {"push": float(laws[0].push), "memory": laws[0].memory}
    if len(laws) > 1:
        shape["push_2"] = float(laws[1].push)
    return shape | ({"reset": 1.0} if laws[0].resets else {})


def _offsets(amplitudes: Floats) -> Floats:
    """Offset of every run from the mean of all, shape (runs,) [deg]."""
    return np.asarray(np.r_[-np.sum(amplitudes), amplitudes])


def _law_of(history: History, offsets: Floats) -> Explanation | None:
    """Laws that explain the offsets of the runs; None where none does."""
    best = best_laws(history, offsets)
    return best if best is not None and best.left < UNEXPLAINED else None


def _believed_law(history: History, offsets: Floats) -> Explanation | None:
    """Laws that explain the offsets, and do so by more than chance; None where none does.

    With few runs some law fits a quarter of all offsets drawn at random.
    """
    law = _law_of(history, offsets)
    few = history.run_count < FEWEST_FOR_LAW
    return None if law is not None and few and _erratic(history, offsets) else law


def _erratic(history: History, offsets: Floats) -> bool:
    """Whether the datum goes to and fro, and neither temperature nor place explains it."""
    centred = offsets - offsets.mean()
    total = float(centred @ centred)
    span = float(np.ptp(offsets))
    rise = float(np.max(offsets - np.minimum.accumulate(offsets)))
    fall = float(np.max(np.maximum.accumulate(offsets) - offsets))
    if not total > 0 or min(rise, fall) < LEAST_SWING * span:
        return False
    least = OF_MANY if len(offsets) >= FEWEST_FOR_LAW else TO_AND_FRO
    if float(np.sum(np.diff(offsets) ** 2)) < least * total:
        return False
    return not _by_temperature(history, centred) and not _by_place(history, centred)


def _by_temperature(history: History, centred: Floats) -> bool:
    """Whether the temperature of the runs explains most of their offsets."""
    if history.temperature_c is None:
        return False
    warm = np.array([float(np.mean(history.temperature_c[run])) for run in runs_of(history)])
    fitted = left_out_share(np.column_stack([np.ones(len(warm)), warm]), centred)
    return fitted is not None and fitted[0] < OTHER_CAUSE


def _by_place(history: History, centred: Floats) -> bool:
    """Whether the mesh positions of the runs explain their offsets, or may well do so."""
    if history.crank_deg is None:
        return False
    place = mesh_positions(history.crank_deg[history.run_starts])
    _, which = np.unique(place, return_inverse=True)
    count, places = len(which), int(which.max()) + 1
    if places == 1:
        return False
    if places == count:
        return True
    mean = np.bincount(which, centred) / np.bincount(which)
    within = float(np.sum((centred - mean[which]) ** 2)) / (count - places)
    return within < OTHER_CAUSE * float(centred @ centred) / (count - 1)
