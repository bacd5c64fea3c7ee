"""The next experiment: the load programme from a menu that best separates what is left."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.recording import Recording
from cyclosweep.result import NextExperiment
from cyclosweep.result.contradictions import NONE_NEEDED
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Floats, History

Load = tuple[Floats, Floats, Floats, Floats]
"""Torque [N m], run, position [deg] and temperature [degC]."""

STEP_S = 1.0


@dataclass(frozen=True, slots=True)
class Plan:
    """A load programme in words and the history it makes, for a largest torque.

    Attributes
    ----------
    words : str
        What to do.
    make : callable
        History of a largest torque [N m].
    shares : tuple of float
        Torques between which one run is ramped, over the largest torque.
    """

    words: str
    make: Callable[[float], Load]
    shares: tuple[float, ...]


def _line(points: Sequence[float], seconds: float) -> Floats:
    """Torque along straight ramps of equal duration.

    Parameters
    ----------
    points : sequence of float
        Torques at the ends of the ramps [N m].
    seconds : float
        Duration of all ramps [s].

    Returns
    -------
    ndarray, shape (n,)
        In N m.
    """
    count = max(int(seconds / STEP_S / max(len(points) - 1, 1)), 4)
    parts = [np.linspace(a, b, count, endpoint=False) for a, b in pairwise(points)]
    return np.concatenate([*parts, [points[-1]]])


def _runs(torques: Sequence[Floats], cranks: Sequence[float], warm: float = 0.0) -> Load:
    """Torque, run, position and temperature of consecutive runs.

    Parameters
    ----------
    torques : sequence of ndarray
        Torque of each run [N m].
    cranks : sequence of float
        Position of the mesh in each run [deg].
    warm : float
        Rise of temperature over all runs [K].

    Returns
    -------
    Load
    """
    run = np.concatenate([np.full(len(t), k, dtype=np.float64) for k, t in enumerate(torques)])
    crank = np.concatenate([np.full(len(t), c) for t, c in zip(torques, cranks, strict=True)])
    share = np.arange(len(run)) / max(len(run) - 1, 1)
    return np.concatenate(torques), run, crank, 20.0 + warm * share


LOOP = (0.0, 1.0, -1.0, 0.0)
"""Ends of the ramps of a loop, over the largest torque."""
NESTED = (0.0, 1.0, -1.0, 0.6, -0.4, 1.0, 0.4, 0.8, 0.0)
"""Ends of the ramps of nested loops, over the largest torque."""
LADDER = (0.2, 0.4, 0.7, 1.0, 1.2, 0.3)
"""Amplitudes of a ladder of loops, over the largest torque."""


def _nested(top: float) -> Load:
    """Nested and biased loops, twice."""
    points = [share * top for share in NESTED]
    return _runs([_line(points, 500), _line(points, 500)], [0, 0])


def _rates(top: float) -> Load:
    """The same loop at three rates."""
    points = [share * top for share in LOOP]
    return _runs([_line(points, s) for s in (60, 200, 700)], [0, 0, 0])


def _holds(top: float) -> Load:
    """Holds at full load and without load, both directions."""
    up, down = _line([0, top], 40), _line([top, 0], 40)
    path = np.concatenate([up, np.full(300, top), down, np.full(200, 0.02 * top)])
    return _runs([path, -path], [0, 0])


def _places(top: float) -> Load:
    """The same loop at eight positions of the mesh."""
    points = [share * top for share in LOOP]
    spots = [0, 45, 90, 135, 180, 225, 270, 315]
    return _runs([_line(points, 120) for _ in spots], spots)


def _returns(top: float) -> Load:
    """Small loops returning to three positions while the rig warms up by 4 K."""
    points = [0, 0.5 * top, -0.5 * top, 0]
    spots = [0, 120, 240, 0, 120, 240, 0, 120]
    return _runs([_line(points, 120) for _ in spots], spots, warm=4.0)


def _soak(top: float) -> Load:
    """Small loops at one position while the rig warms up by 10 K."""
    points = [0, 0.3 * top, -0.3 * top, 0]
    return _runs([_line(points, 120) for _ in range(8)], [0] * 8, warm=10.0)


def _ladder(top: float) -> Load:
    """Loops of growing amplitude, then a small one."""
    return _runs([_line([0, s * top, -s * top, 0], 150) for s in LADDER], [0] * len(LADDER))


def _wide(top: float) -> Load:
    """Two loops to 1.4 times the largest torque."""
    return _runs([_line([0, 1.4 * top, -1.4 * top, 0], 600) for _ in range(2)], [0, 0])


MENU: tuple[Plan, ...] = (
    Plan("nested and biased loops to the largest torque, twice", _nested, NESTED),
    Plan("the same loop at three rates, one to ten", _rates, LOOP),
    Plan(
        "holds of five minutes at full load and without load, both directions",
        _holds,
        (0.0, 1.0, 0.0, -1.0, 0.0),
    ),
    Plan("the same loop at eight positions of the mesh zone", _places, LOOP),
    Plan(
        "small loops returning to three positions while the rig warms up by 4 K",
        _returns,
        tuple(0.5 * share for share in LOOP),
    ),
    Plan(
        "small loops at one position while the rig warms up by 10 K",
        _soak,
        tuple(0.3 * share for share in LOOP),
    ),
    Plan(
        "loops of growing amplitude, then a small one again",
        _ladder,
        (0.0, *(sign * share for share in LADDER for sign in (1.0, -1.0)), 0.0),
    ),
    Plan(
        "two loops to 1.4 times the largest torque, if the drive may be loaded so far",
        _wide,
        tuple(1.4 * share for share in LOOP),
    ),
)

USUAL: dict[str, Callable[[float], Load]] = {
    "creep": _holds,
    "viscous_drag": _rates,
    "transmission_error": _places,
    "phase_dependent_compliance": _places,
    "thermal_drift": _soak,
    "overload_softening": _wide,
}
"""Programme by which an effect is usually told, by name of the effect."""
PREFERENCE = 3.0
"""Factor of detectability by which another programme has to be better than the usual one."""


def next_experiment(
    search: Search, rivals: list[Candidate], weakest: str | None, tolerance_deg: float
) -> NextExperiment:
    """Choose the programme that separates the best two explanations, or shows the weakest effect.

    Parameters
    ----------
    search : Search
        Calibrated search on the recording.
    rivals : list of Candidate
        Explanations, the most probable first.
    weakest : str or None
        Effect to show or rule out where there are no two explanations to separate.
    tolerance_deg : float
        Size at which that effect is to be seen [deg].

    Returns
    -------
    NextExperiment
        Its detectability is the projected signal-to-noise of what tells the two apart.
    """
    terms = _contested(rivals)
    if terms:
        first, second = terms
        names = [first[0], second[0]]
    elif weakest is not None:
        names = [weakest]
    else:
        return NextExperiment(program=NONE_NEEDED, minutes=0)
    best: tuple[float, Plan, int] | None = None
    most = 0.0
    for plan in MENU:
        history = _history(search, plan)
        value = _detectability(search, history, terms, weakest, tolerance_deg)
        if not np.isfinite(value):
            continue
        usual = not terms and weakest is not None and USUAL.get(weakest) is plan.make
        weight = value * (PREFERENCE if usual else 1.0)
        if weight > 1.05 * most:
            best, most = (value, plan, len(history)), weight
    if best is None:
        value, plan, rows = 0.0, MENU[0], 900
    else:
        value, plan, rows = best
    top = search.problem.largest_torque_nm
    return NextExperiment(
        program=plan.words,
        separates=tuple(names),
        loads_nm=tuple(float(f"{share * top:.3g}") for share in plan.shares),
        rig_programme=rig_programme(search.problem.recording),
        detectability=None if best is None else round(float(value), 2),
        minutes=int(np.ceil(rows * STEP_S / 60.0)) + 5,
    )


def rig_programme(recording: Recording) -> str:
    """Name the programme of ``examples/rigs`` for a rig like that of a recording.

    Parameters
    ----------
    recording : Recording
        Says at which shaft was measured, whether with a clock, and whence the torque is.

    Returns
    -------
    str
        As it is called in docs/rigs.md.
    """
    if recording.torque_from == "motor-current":
        return "motor-current"
    if recording.side == "output":
        return "torque-sensor-and-encoder"
    return "weights-and-protractor"


def _contested(rivals: list[Candidate]) -> list[tuple[str, list[Term], Candidate]]:
    """Terms in which the two best explanations differ."""
    if len(rivals) < 2:
        return []
    out = []
    for candidate, other in ((rivals[0], rivals[1]), (rivals[1], rivals[0])):
        own = [t for t in candidate.fit.terms if t.name not in other.names]
        if any(t.effect is None for t in own):
            return []
        out.append(("+".join(t.name for t in own) or "nothing more", own, candidate))
    return out


def _history(search: Search, plan: Plan) -> History:
    """Load history of a programme, with the path of the calibrated line alone.

    Parameters
    ----------
    search : Search
    plan : Plan

    Returns
    -------
    History
    """
    base = search.baseline.fit.history
    torque, run, crank, warm = plan.make(search.problem.largest_torque_nm)
    side = np.where(torque < 0, -1.0, 1.0)
    angle = base.datum_deg + side * base.free_play_deg + base.compliance_deg_per_nm * torque
    index = run.astype(np.int64)
    return base.with_state(
        applied_nm=torque,
        elastic_nm=torque,
        angle_deg=angle,
        side=side,
        run=index,
        restart=np.r_[True, np.diff(index) != 0],
        time_s=np.arange(len(torque)) * STEP_S + 200.0 * index,
        crank_deg=crank,
        temperature_c=warm,
        resets_datum=False,
    )


def _detectability(
    search: Search,
    history: History,
    terms: list[tuple[str, list[Term], Candidate]],
    weakest: str | None,
    tolerance_deg: float,
) -> float:
    """Signal-to-noise ratio of what separates two explanations, or of the weakest effect.

    Parameters
    ----------
    search : Search
    history : History
        Load history of a programme.
    terms : list of (str, list of Term, Candidate)
        Two names, each with the terms that only this explanation has; may be empty.
    weakest : str or None
        Effect to show where there are no two explanations.
    tolerance_deg : float
        Size of that effect [deg].

    Returns
    -------
    float
        -inf where the programme cannot show it.
    """
    base = np.column_stack([np.ones(len(history)), history.applied_nm, history.side])
    sigma = search.noise.sigma_deg
    if terms:
        first = np.zeros(len(history))
        for term in terms[0][1]:
            first += _twist(terms[0][2], term, history)
        second = [t.columns(history) for t in terms[1][1]]
        known = orthonormal(np.column_stack([base, *second]), 1e-9)
        return float(np.linalg.norm(first - known @ (known.T @ first)) / sigma)
    assert weakest is not None
    effect = find(weakest)
    if effect.untestable(history) is not None:
        return -np.inf
    known = orthonormal(base, 1e-9)
    values = []
    for shape in effect.shapes(history):
        column = effect.columns(history, shape)[:, 0]
        left = column - known @ (known.T @ column)
        peak = float(np.max(np.abs(left)))
        if peak > 0:
            values.append(np.linalg.norm(left) / peak * tolerance_deg / sigma)
    return float(np.median(values)) if values else -np.inf


def _twist(candidate: Candidate, term: Term, history: History) -> Floats:
    """Twist of a fitted term on another history.

    Parameters
    ----------
    candidate : Candidate
        The fitted structure of the term.
    term : Term
    history : History
        The other load history.

    Returns
    -------
    ndarray, shape (n,)
        In deg.
    """
    columns = term.columns(history)
    if term.slips:
        return np.asarray(columns[:, 0] * term.amplitude)
    index = next(k for k, t in enumerate(candidate.fit.terms) if t.name == term.name)
    beta = candidate.fit.beta[candidate.fit.column_range(index)]
    width = min(columns.shape[1], len(beta))
    return np.asarray(columns[:, :width] @ beta[:width])
