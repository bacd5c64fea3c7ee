"""What a test engineer sees in a measured loop, in figures."""

import numpy as np

from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.whole_loop.forecast import Forecast
from cyclosweep.result import Finding, Untestable
from cyclosweep.simulation.effects.history import Flags, Floats
from cyclosweep.simulation.simulate import elastic_law

AT_LIMIT = 0.06
"""Share of samples at the largest torque from which the actuator is taken to be at its limit."""
CENSORED = 0.6
"""Share of the nominal dead zone below which friction has held the shaft inside its play."""
STUCK = 0.35
"""Share of the largest torque from which Coulomb friction decides what the loop looks like."""
LEAST_REPEAT = 0.3
"""Correlation between runs from which a residual is worth naming as a staircase."""


def findings(forecast: Forecast, repeats: float | None, *, unsteady: bool) -> tuple[Finding, ...]:
    """Topics and sentences, in the order in which a loop is read.

    Parameters
    ----------
    forecast : Forecast
        The simulation fitted to the loops.
    repeats : float, optional
        Correlation of the residual between runs.
    unsteady : bool
        Whether the loops drift from run to run.

    Returns
    -------
    tuple of Finding
    """
    problem = forecast.problem
    known = forecast.names
    rows = [_play(problem, forecast)]
    if "friction_hysteresis" in known:
        rows.append(_friction(forecast))
    if "load_dependent_friction" in known:
        rows.append(_load_friction(forecast))
    if censored(problem, forecast) is None:
        if known & {"contact_stiffening", "clearance_takeup"}:
            rows.append(_stiffening(problem, forecast))
        rows.append(_stiffness(problem, unsteady=unsteady))
    else:
        rows.append(("stiffness", "Not reported, for the same reason as the play."))
    if repeats is not None and repeats > LEAST_REPEAT and not unsteady:
        rows.append(_staircase(problem, forecast, repeats))
    return tuple(Finding(topic=topic, text=text) for topic, text in rows)


def limits_of(problem: Problem) -> list[Untestable]:
    """What the rig of a recording with structured residual cannot show, besides the aliases."""
    recording = problem.recording
    out = []
    if recording.torque_from == "motor-current":
        out.append(
            _limit(
                "independent_torque",
                "torque is computed from the motor current: drag and friction of the motor and its "
                "torque constant are part of every torque read here",
                "a torque sensor at the output",
            )
        )
    if recording.crank_deg is None or np.ptp(recording.crank_deg) == 0:
        out.append(
            _limit(
                "other_mesh_positions",
                "the output was locked at one position of the mesh; stiffness, play and staircase "
                "of other positions differ",
                "the same ramps at several locking positions",
            )
        )
    if recording.temperature_c is None:
        out.append(
            _limit(
                "temperature",
                "no temperature was recorded, so warming up cannot be told from wear or creep",
                "a temperature column",
            )
        )
    torque = np.abs(recording.torque_nm)
    top = float(torque.max(initial=0.0))
    held = float(np.mean(torque > 0.93 * top)) if len(torque) else 0.0
    turning = float(np.mean((torque > 0.8 * top) & (torque <= 0.93 * top))) if len(torque) else 0.0
    if held > AT_LIMIT and held > 1.5 * turning:
        out.append(
            _limit(
                "loads_beyond_the_limit",
                f"torque stands near {top:.3g} N m for {100 * held:.0f} % of the samples: the "
                "actuator was at its limit, and nothing beyond was applied",
                "a stronger actuator",
            )
        )
    return out


def censored(problem: Problem, forecast: Forecast) -> str | None:
    """Reason why play and stiffness cannot be read: friction hardly let the shaft go."""
    rows = problem.whole_fitted | problem.whole_held_out
    moved = float(np.ptp(problem.angle_deg[rows]))
    nominal = 2.0 * problem.nominal_free_play
    top = float(np.abs(problem.history.applied_nm[rows]).max())
    limit = sum(t.amplitude for t in forecast.terms if t.name == "friction_hysteresis")
    if limit > STUCK * top:
        sign = f"Coulomb friction of {limit:.3g} N m takes {100 * limit / top:.0f} % of"
    elif moved < CENSORED * nominal:
        sign = f"the shaft moved {moved:.3g} deg only, its play is nominally {nominal:.3g}, under"
    else:
        return None
    return (
        f"{sign} the largest torque of {top:.3g} N m. Friction that does not break away fully "
        "looks like a smaller play and a stiffer drive; larger ramps are needed"
    )


def _limit(name: str, reason: str, needs: str) -> Untestable:
    return Untestable(name=name, reason=reason, needs=needs)


def _angle(value_deg: float) -> str:
    return f"{value_deg:.3g} deg ({60 * value_deg:.3g} arcmin)"


def _spread(forecast: Forecast, kind: str, name: str = "") -> float:
    """Half width of the 95 % interval of a parameter, in its own unit."""
    for k, parameter in enumerate(forecast.parameters):
        if parameter.kind == kind and (
            not name or (parameter.term >= 0 and _name(forecast, k) == name)
        ):
            error = float(np.sqrt(max(forecast.covariance[k, k], 0.0)))
            value = float(np.exp(forecast.values[k])) if parameter.logarithmic else 1.0
            return 1.96 * error * value
    return float("nan")


def _name(forecast: Forecast, parameter: int) -> str:
    known = forecast.parameters[parameter]
    return forecast.terms[known.term].name if known.name == "amplitude" else ""


def _play(problem: Problem, forecast: Forecast) -> tuple[str, str]:
    reason = censored(problem, forecast)
    if reason is not None:
        return "play", f"Not reported, friction-censored: {reason}."
    model = forecast.model
    dead = 2.0 * model.free_play_deg
    if problem.one_sided:
        return "play", "Not reported: only one flank was loaded."
    law = elastic_law(model, problem.history.largest_torque_nm)
    text = f"Dead zone of {_angle(dead)} ± {2 * _spread(forecast, 'play'):.2g} deg in all."
    if law is not None:
        level = 0.03 * problem.history.largest_torque_nm
        soft = float(np.interp(level, law.torque_nm, law.twist_deg))
        soft -= float(np.interp(-level, law.torque_nm, law.twist_deg))
        text += (
            f" With the soft start of the contacts the elastic line spans {_angle(dead + soft)} "
            f"between ±{level:.2g} N m, which a gauge reads as play."
        )
    return "play", text


def _friction(forecast: Forecast) -> tuple[str, str]:
    limit = next(t.amplitude for t in forecast.terms if t.name == "friction_hysteresis")
    half = _spread(forecast, "nonlinear", "friction_hysteresis")
    return (
        "friction hysteresis",
        f"Coulomb friction of {limit:.3g} ± {half:.2g} N m at the measured shaft: the "
        f"loop is {2 * limit:.3g} N m wide where the shaft leaves a flank.",
    )


def _load_friction(forecast: Forecast) -> tuple[str, str]:
    share = next(t.amplitude for t in forecast.terms if t.name == "load_dependent_friction")
    half = _spread(forecast, "nonlinear", "load_dependent_friction")
    return (
        "friction that grows with load",
        f"{100 * share:.0f} ± {100 * half:.0f} % of the transmitted torque on top of it: the loop "
        "opens with load, and unloading starts with a stretch on which the shaft stands still.",
    )


def _stiffening(problem: Problem, forecast: Forecast) -> tuple[str, str]:
    model = forecast.model
    top = float(np.abs(problem.history.applied_nm[problem.fitted]).max())
    law = elastic_law(model, top)
    assert law is not None

    def slope(low: float, high: float) -> float:
        ends = [
            float(np.interp(s * t, law.torque_nm, law.twist_deg))
            for s in (1, -1)
            for t in (high, low)
        ]
        return 0.5 * ((ends[0] - ends[1]) + (ends[3] - ends[2])) / (high - low)

    soft, stiff = slope(0.0, 0.1 * top), slope(0.5 * top, top)
    return (
        "stiffening",
        f"The elastic line is {soft / max(stiff, 1e-12):.2g} times steeper up to {0.1 * top:.2g} "
        f"N m ({soft:.3g} deg/(N m)) than from {0.5 * top:.3g} to {top:.3g} N m "
        f"({stiff:.3g} deg/(N m)).",
    )


def stiffnesses(problem: Problem) -> Floats:
    """Secant stiffness between half and full torque, by run and flank, loading [N m/arcmin]."""
    history = problem.history
    rows = (problem.fitted | problem.held_out) & (history.sense * history.side > 0)
    values = []
    top = float(np.abs(history.applied_nm[problem.fitted]).max(initial=0.0))
    for run in np.unique(history.run[rows]):
        for side in (1.0, -1.0):
            here: Flags = rows & (history.run == run) & (history.side == side)
            load = np.abs(history.applied_nm)
            here &= (load > 0.5 * top) & (load <= top)
            if np.count_nonzero(here) < 5 or np.ptp(history.applied_nm[here]) < 0.2 * top:
                continue
            slope = np.polyfit(history.applied_nm[here], problem.angle_deg[here], 1)[0]
            if slope > 0:
                values.append(1.0 / (60.0 * slope))
    return np.array(values)


def _stiffness(problem: Problem, *, unsteady: bool) -> tuple[str, str]:
    if unsteady:
        return (
            "stiffness",
            "Not reported: the loops drift from run to run, so a slope mixes stiffness with "
            "creep, warming or wear. Let the drive settle and repeat.",
        )
    values = stiffnesses(problem)
    if len(values) < 2:
        return "stiffness", "Not reported: too few loading branches reach half of the torque."
    mean = float(values.mean())
    half = _student(len(values)) * float(values.std(ddof=1)) / np.sqrt(len(values))
    low, high = max(mean - half, 0.0), mean + half
    return (
        "stiffness",
        f"Secant between 50 and 100 % of the torque, loading: {mean:.2g} N m/arcmin, 95 % interval "
        f"{low:.2g} to {high:.2g} ({60 * 180 / np.pi * mean:.3g} N m/rad); single branches from "
        f"{values.min():.2g} to {values.max():.2g}. It contains what friction that grows with load "
        "takes of the torque.",
    )


def _student(count: int) -> float:
    from scipy.stats import t

    return float(t.ppf(0.975, count - 1))


def _staircase(problem: Problem, forecast: Forecast, repeats: float) -> tuple[str, str]:
    rows = problem.whole_fitted
    left = (problem.angle_deg - forecast.angle_deg)[rows]
    period = step_period(problem.angle_deg[rows], left)
    spaced = "" if period is None else f", spaced about {_angle(period)} at the measured shaft"
    return (
        "staircase",
        f"Steps of about {_angle(float(np.quantile(np.abs(left), 0.9)))} remain that no effect "
        f"explains{spaced}. They repeat at the same positions from run to run (correlation "
        f"{repeats:.2f}): they are tied to the position of mesh and motor, not to noise.",
    )


def step_period(angle: Floats, left: Floats) -> float | None:
    """Period in the angle that explains most of a residual [deg]; None where none stands out."""
    span = float(np.ptp(angle))
    periods = span / np.geomspace(3.0, 40.0, 120)
    clean = left - left.mean()
    total = float(clean @ clean)
    best, gain = None, 0.0
    for period in periods:
        phase = 2 * np.pi * angle / period
        basis = np.linalg.qr(np.column_stack([np.ones_like(phase), np.cos(phase), np.sin(phase)]))[
            0
        ]
        value = float(np.sum((basis.T @ clean) ** 2)) / max(total, 1e-300)
        if value > gain:
            best, gain = float(period), value
    return best if gain > 0.1 else None
