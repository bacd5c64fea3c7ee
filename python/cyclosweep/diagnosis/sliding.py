"""Recordings in which friction slides all the way, so that the torque does not fix the twist."""

from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.diagnosis.plausibility import doubts_where_it_slides, with_remarks
from cyclosweep.diagnosis.provenance import provenance_of
from cyclosweep.diagnosis.strokes import LOOP_SHARE, strokes_of
from cyclosweep.recording import Recording
from cyclosweep.report.summary import do_now
from cyclosweep.result import (
    Answer,
    EffectParameter,
    FoundEffect,
    NextExperiment,
    NoiseEstimate,
    Remainder,
    Repair,
    SelfCheck,
    Size,
    Untestable,
)
from cyclosweep.result.part import NORMAL_95
from cyclosweep.result.statement import doubt_sentences
from cyclosweep.result.words import degrees, telling_digits
from cyclosweep.simulation.effects import Effect
from cyclosweep.simulation.effects.history import Flags, Floats

FEWEST_READINGS = 20
"""Readings from which the shape of a loop is looked at."""
PLATEAU_WIDTH = 0.25
"""Half width of the torque that counts as the limit, as a share of the limit: a brake's own
fluctuation, and far less than a spring takes over the same angle."""
PLATEAU_SHARE = 0.5
"""Share of the travel of each direction at the limit from which friction slides fully."""
AS_DENSELY_READ = 0.5
"""Readings on the travel at the limit over those on all travel, each counted by the cells of the
angle in which one stands, from which the shaft was turned there. Where the torque is set, it falls
through its play within a few readings while friction holds the torque, which is no sliding."""
FRICTION = "friction_hysteresis"
"""Effect that is named."""


@dataclass(frozen=True)
class Limit:
    """Torque at which one direction of motion slides.

    Attributes
    ----------
    torque_nm, std_error_nm : float
        Median over the strokes, and its standard error [N m].
    share : float
        Share of the motion in this direction that goes on at this torque.
    read_share : float
        Share of the readings of this direction that stand there.
    range_deg : float
        Angle over which it does [deg].
    """

    torque_nm: float
    std_error_nm: float
    share: float
    read_share: float
    range_deg: float


@dataclass(frozen=True)
class Sliding:
    """Friction that slides fully in both directions.

    Attributes
    ----------
    rising, falling : Limit
        Limits while the angle rises and while it falls.
    loop_share : float
        Area of the loop over that of the rectangle around it.
    """

    rising: Limit
    falling: Limit
    loop_share: float

    @property
    def friction_nm(self) -> float:
        """Friction limit, the mean of both directions [N m]."""
        return (self.rising.torque_nm - self.falling.torque_nm) / 2.0

    @property
    def std_error_nm(self) -> float:
        """Standard error of the friction limit [N m]."""
        return float(np.hypot(self.rising.std_error_nm, self.falling.std_error_nm)) / 2.0


def find_sliding(recording: Recording) -> Sliding | None:
    """Find out whether the angle takes any value at the same torque, in both directions.

    The torques of both directions are compared at equal angles. A spring, however soft or played
    out, has the same torque there; a spring with friction differs by twice the friction; only a
    friction that slides fully has one torque per direction whatever the angle.

    Parameters
    ----------
    recording : Recording
        With an angle.

    Returns
    -------
    Sliding or None
        None where the torque fixes the twist, up to a loop.
    """
    strokes = strokes_of(recording)
    if strokes is None or len(recording) < FEWEST_READINGS:
        return None
    share = strokes.loop_share
    if share < LOOP_SHARE:
        return None
    up = _limit(strokes.rising, strokes.rising_read, strokes.cell_deg)
    down = _limit(strokes.falling, strokes.falling_read, strokes.cell_deg)
    if not up.torque_nm > 0 > down.torque_nm:
        return None
    if min(up.share, down.share) < PLATEAU_SHARE:
        return None
    if any(each.read_share < AS_DENSELY_READ * each.share for each in (up, down)):
        return None
    return Sliding(rising=up, falling=down, loop_share=share)


def _limit(torque: Floats, read: Flags, cell_deg: float) -> Limit:
    """Torque at which one direction slides, by the travel of its strokes.

    Parameters
    ----------
    torque : ndarray, shape (strokes, cells)
        Torque of each stroke in each cell of the angle [N m]; NaN where it does not pass.
    read : ndarray of bool, shape (strokes, cells)
        Cells in which a reading stands.
    cell_deg : float
        Width of a cell [deg].

    Returns
    -------
    Limit
    """
    passed = np.isfinite(torque)
    level = float(np.median(torque[passed]))
    sliding = passed & (np.abs(torque - level) <= PLATEAU_WIDTH * abs(level))
    if not sliding.any():
        return Limit(torque_nm=level, std_error_nm=0.0, share=0.0, read_share=0.0, range_deg=0.0)
    ranges = cell_deg * np.count_nonzero(sliding, axis=1)
    slid = ranges > 0
    medians = np.array(
        [float(np.median(row[at])) for row, at in zip(torque[slid], sliding[slid], strict=True)]
    )
    weight = ranges[slid] / ranges.sum()
    spread = float(np.std(torque[sliding]))
    if len(medians) > 1:
        spread = float(np.sqrt(weight @ (medians - level) ** 2))
    return Limit(
        torque_nm=level,
        std_error_nm=spread * float(np.sqrt(weight @ weight)),
        share=float(np.count_nonzero(sliding) / np.count_nonzero(passed)),
        read_share=float(np.mean(sliding[read])) if np.any(read) else 0.0,
        range_deg=float(ranges.max()),
    )


def sliding_diagnosis(
    recording: Recording,
    drive: Drive,
    found: Sliding,
    effects: tuple[Effect, ...],
    seed: int,
) -> Diagnosis:
    """Return the result for a recording in which friction slides fully: no stiffness, no model.

    Parameters
    ----------
    recording : Recording
        What was diagnosed.
    drive : Drive
        The drive it was taken on.
    found : Sliding
        Friction limits and the share of the loop.
    effects : tuple of Effect
        Effects that may be named.
    seed : int
        Seed of the diagnosis, for the record.

    Returns
    -------
    Diagnosis
    """
    friction = next((effect for effect in effects if effect.name == FRICTION), None)
    named = () if friction is None else (_named(found, friction),)
    nominal = drive.nominal_line(recording.side).compliance_deg_per_nm
    remarks = doubts_where_it_slides(recording, nominal, float(drive.ratio))
    said = _statement(found, named=bool(named))
    answer = Answer(
        verdict="UNKNOWN_PHYSICS",
        statement=f"{doubt_sentences(remarks)}{said}",
        summary=said,
        noise=NoiseEstimate(resolution_deg=recording.angle_resolution_deg),
        effects=named,
        not_testable=(
            Untestable(
                name="compliance",
                reason="while friction slides, the angle changes at one and the same torque",
                needs="small loops about one torque, below the friction limit, torque controlled",
            ),
        ),
        repaired=Repair(holdout="nothing"),
        self_check=SelfCheck(),
        next_experiment=NextExperiment(
            program="torque controlled loops below the friction limit of "
            f"{found.friction_nm:.3g} N m, where the parts stick and the torque fixes the twist"
        ),
        notes=(*recording.notes, *(fault.reason for fault in recording.faults)),
        unknown=Remainder(
            shape="twist that the torque does not determine",
            place=f"at {found.rising.torque_nm:.3g} and {found.falling.torque_nm:.3g} N m",
            size_deg=max(found.rising.range_deg, found.falling.range_deg),
        ),
    )
    answer = with_remarks(answer, remarks)
    return Diagnosis(
        recording=recording,
        answer=replace(answer, do_now=do_now(answer)),
        ratio=float(drive.ratio),
        provenance=provenance_of(recording, drive, seed),
    )


def _named(found: Sliding, effect: Effect) -> FoundEffect:
    """Friction with its limit in N m and the angle over which it slides.

    Parameters
    ----------
    found : Sliding
        Friction limits.
    effect : Effect
        The effect that is named.

    Returns
    -------
    FoundEffect
    """
    ranges = sorted((found.rising.range_deg, found.falling.range_deg))
    return FoundEffect(
        name=effect.name,
        physics=effect.physics,
        source=effect.source,
        parameters={
            "friction_torque_nm": EffectParameter(
                estimate=found.friction_nm,
                std_error=found.std_error_nm,
                unit="N m",
                meaning="Coulomb friction torque, mean of both directions of motion",
            ),
            "rising_limit_nm": EffectParameter(
                estimate=found.rising.torque_nm,
                std_error=found.rising.std_error_nm,
                unit="N m",
                meaning="torque at which it slides while the angle rises",
            ),
            "falling_limit_nm": EffectParameter(
                estimate=found.falling.torque_nm,
                std_error=found.falling.std_error_nm,
                unit="N m",
                meaning="torque at which it slides while the angle falls",
            ),
        },
        size_deg=Size(estimate=sum(ranges) / 2.0, ci95=(ranges[0], ranges[1])),
        size_arcmin=30.0 * sum(ranges),
        size_nm=found.friction_nm,
    )


def _statement(found: Sliding, *, named: bool) -> str:
    """Say what was found, in a paragraph.

    Parameters
    ----------
    found : Sliding
        Friction limits and the share of the loop.
    named : bool
        Whether friction may be named.

    Returns
    -------
    str
    """
    half, limit = NORMAL_95 * found.std_error_nm, found.friction_nm
    digits = telling_digits(limit, (limit - half, limit + half))
    first = "Missing physics: friction that slides fully (friction hysteresis)."
    if not named:
        first = "Unknown physics: a loop that takes the whole torque."
    return (
        f"{first} Twist is not determined by torque: the angle takes any value over "
        f"{degrees(found.rising.range_deg)} at {found.rising.torque_nm:.3g} N m while it rises "
        f"and over {degrees(found.falling.range_deg)} at {found.falling.torque_nm:.3g} N m while "
        f"it falls, {100 * found.rising.share:.0f} % and {100 * found.falling.share:.0f} % of all "
        f"motion in these directions. The friction limit is {limit:.{digits}g} N m (95 %: "
        f"{limit - half:.{digits}g} to {limit + half:.{digits}g}); the loop fills "
        f"{100 * found.loop_share:.0f} % of the rectangle around it. No stiffness can be read "
        "from this recording, and no model is given that would compute a twist from a torque; "
        "loops below the friction limit would show the stiffness."
    )
