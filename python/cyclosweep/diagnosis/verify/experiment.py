"""The next experiment: the load programme from a menu that best separates what is left."""

from itertools import pairwise
from typing import get_args

import numpy as np

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.diagnosis.verify.menu import STEP_S, Plan, Varied, able_to_show
from cyclosweep.recording import Recording
from cyclosweep.result import NextExperiment
from cyclosweep.result.contradictions import NONE_NEEDED
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Floats, History

BETTER = 1.05
"""Factor of detectability by which a programme has to be better than one before it on the menu."""
CAN_DECIDE = 2.0
"""Signal-to-noise ratio from which a programme shows anything."""
SHOWS = 3.9
"""Ratio from which an effect is found nine times in ten, beyond what noise does once in a hundred.
Below it a programme is to be repeated: the ratio grows with the root of the passes."""
RATES, RATE_RANGE = 3, 10.0
"""Rates of the loops of the menu, and the largest over the smallest."""
POSITIONS = 8
"""Positions of the mesh on the menu."""
SAME_RATE = 1.2
"""Rates nearer to each other than this factor are one."""
FINER = (
    "the same programme once more, read more finely or several times: whatever the loads, the "
    "effect that is asked for would stay below the noise of a recording like this one"
)
"""Next experiment where no programme shows what is asked."""


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
    most = CAN_DECIDE / BETTER
    for plan in able_to_show(_effects_of(terms) or names):
        history = _history(search, plan)
        value = _detectability(search, history, terms, weakest, tolerance_deg)
        if value > BETTER * most:
            best, most = (value, plan, len(history)), value
    if best is None:
        return NextExperiment(program=FINER)
    value, plan, rows = best
    passes = int(np.ceil((SHOWS / value) ** 2)) if value < SHOWS else 1
    words = plan.once_more if _is_recorded(search.problem.history, plan) else plan.words
    top = search.problem.largest_torque_nm
    return NextExperiment(
        program=words if passes == 1 else f"{words}; all of it {passes} times",
        separates=tuple(names),
        loads_nm=tuple(float(f"{share * top:.3g}") for share in plan.shares),
        rig_programme=rig_programme(search.problem.recording, plan),
        detectability=round(float(value * np.sqrt(passes)), 2),
        minutes=int(np.ceil(passes * rows * STEP_S / 60.0)) + 5,
    )


def _is_recorded(history: History, plan: Plan) -> bool:
    """Whether a recording has the rates, or the positions, of a programme already.

    Parameters
    ----------
    history : History
        Of the recording.
    plan : Plan
        The programme.

    Returns
    -------
    bool
    """
    if not plan.once_more:
        return False
    runs = [history.run == run for run in np.unique(history.run)]
    if plan.varies == "positions":
        crank = history.crank_deg
        if crank is None:
            return False
        return len({round(float(np.median(crank[rows]))) for rows in runs}) >= POSITIONS
    if history.time_s is None:
        return False
    rates = []
    for rows in runs:
        lapse = np.diff(history.time_s[rows])
        rate = np.abs(np.diff(history.applied_nm[rows])[lapse > 0] / lapse[lapse > 0])
        if np.any(rate > 0):
            rates.append(float(np.median(rate[rate > 0])))
    rates.sort()
    apart = [high > SAME_RATE * low for low, high in pairwise(rates)]
    return 1 + sum(apart) >= RATES and rates[-1] >= RATE_RANGE * rates[0]


RIGS: dict[str, frozenset[Varied]] = {
    "weights-and-protractor": frozenset({"loads", "positions"}),
    "motor-current": frozenset({"loads", "rates"}),
    "torque-sensor-and-encoder": frozenset(get_args(Varied)),
}
"""What the programmes of ``examples/rigs`` change, or have a column for."""


def rig_programme(recording: Recording, plan: Plan) -> str:
    """Name the programme of ``examples/rigs`` that is like a plan, for a rig like a recording's.

    Parameters
    ----------
    recording : Recording
        Says at which shaft was measured, and whence the torque is.
    plan : Plan
        What is to be done.

    Returns
    -------
    str
        As it is called in docs/rigs.md; empty where that of the rig cannot do it.
    """
    if recording.side == "output":
        name = "torque-sensor-and-encoder"
    elif recording.torque_from == "motor-current" or plan.varies == "rates":
        name = "motor-current"
    else:
        name = "weights-and-protractor"
    return name if plan.varies in RIGS[name] else ""


def _effects_of(terms: list[tuple[str, list[Term], Candidate]]) -> list[str]:
    """Names of the effects in which two explanations differ.

    Parameters
    ----------
    terms : list of (str, list of Term, Candidate)
        Two names, each with the terms that only this explanation has; may be empty.

    Returns
    -------
    list of str
    """
    return [term.name for _, own, _ in terms for term in own]


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
