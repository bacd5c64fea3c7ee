"""Natural frequencies and shocks of torsional trains beside textbooks and closed forms."""

from __future__ import annotations

import math
from collections.abc import Iterator

import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.dynamics.holzer import holzer_table
from cyclosweep.dynamics.train import Train
from cyclosweep.dynamics.transient import Transient
from cyclosweep.errors import InputError
from cyclosweep.reference.facts import Fact, Kind, Mark
from cyclosweep.reference.model import Model
from cyclosweep.reference.sources import TEXTBOOK, THOMSON, TRAIN

__all__ = ["facts"]

GROUP = "torsional dynamics"

_THREE = "J 5, 11, 22 kg m^2; 1e5, 2e5 N m/rad"
_HOLZER = (
    (20.0, (0.980, 5e-4), (0.9484, 5e-5), 14.66e3),
    (40.0, (0.920, 5e-4), (0.799, 5e-4), 52.32e3),
)
"""Angular frequency; angles 2 and 3 with half of their last digit; torque 3."""
_GAP = math.radians(28.0)
_TORQUE = 7.2575
"""Nominal torque of the 87:1 case as printed [N m]."""
_LOCKED = ((0.0035,), (21.0,), (_GAP,), True)
_BACKBONE = {0.1: 2.998724, 0.3456: 6.487765, 1.0: 9.402780}
"""Amplitude beyond the play [rad]: frequency [Hz] by 2 pi / w + 4 gamma / (w a)."""
_REVERSALS = {1.0: 4.107449, 2.0: 3.613067, 2.5: 3.502498, 4.0: 3.326813}
"""Load [T_N]: peak over static torque by 1 + 2 sqrt(1 + K gamma / T)."""
_MOTOR_ALONE = {0.0026: 2.534543, 0.00066: 1.655270}
"""Inertia of the load [kg m^2]: the same when the motor's torque reverses and the load's ends."""
_FIVE = (
    (0.0035, 4e-4, 2.1e-6, 1.6e-6, 5 / 87**2),
    (2e4, 84.0, 28.0, 132.0),
    (0.0, _GAP, 0.0, 0.0),
    False,
)
_FIVE_HZ = (28.471089, 1102.075993, 1199.088620, 1628.626210)
_FIVE_ENDS = (0.7472377735, 0.7471891356, 0.8369558652, 0.8339017317, 0.8369273420)


def facts(model: Model) -> Iterator[Fact]:
    """Compare modes and transients with printed numbers and closed forms.

    Parameters
    ----------
    model : Model
        The package, or the package with one error put in.

    Yields
    ------
    Fact
        Rows of kind ``evidence`` for printed numbers, ``identity`` for closed forms and
        ``independent solution`` for others.
    """
    yield from _textbooks(model)
    yield from _play(model)
    yield from _five_inertias(model)
    yield from _the_87_1_drive(model)


def _row(
    fact: str,
    expected: float,
    computed: float,
    unit: str,
    tolerance: float,
    note: str,
    mark: Mark = "identity",
    kind: Kind = "identity",
    source: str = "",
) -> Fact:
    return Fact(GROUP, fact, expected, computed, unit, mark, kind, tolerance, note, source=source)


def _train(
    model: Model,
    inertias: tuple[float, ...],
    stiffnesses: tuple[float, ...],
    gaps: tuple[float, ...] | None = None,
    grounded: bool = False,
) -> Train:
    return model.change_train(Train(inertias, stiffnesses, gaps, grounded))


def _textbooks(model: Model) -> Iterator[Fact]:
    thomson = _train(model, (5.0, 11.0, 22.0), (1e5, 2e5))
    for mode, root in ((1, 123.66580), (2, 202.65835)):
        found = math.tau * float(thomson.modes().frequencies_hz[mode])
        yield _row(
            f"three inertias: angular frequency of mode {mode + 1}", root, found, "rad/s", 1e-5,
            f"{_THREE}; closed form of the characteristic equation",
        )  # fmt: skip
    for omega, second, third, torque in _HOLZER:
        table = holzer_table(thomson, omega)
        for place, (angle, rounding) in ((1, second), (2, third)):
            yield _row(
                f"Holzer's table at {omega:g} rad/s: angle {place + 1}", angle,
                table["angle_rad"][place], "rad", rounding, _THREE, "published", "evidence",
                THOMSON,
            )  # fmt: skip
        yield _row(
            f"Holzer's table at {omega:g} rad/s: torque 3", torque, table["torque_nm"][2], "N m",
            5.0, _THREE, "published", "evidence", THOMSON,
        )  # fmt: skip
    shaft = math.pi * 0.07**4 / 32 * 84e9
    engine = _train(model, (0.15, 0.3, 0.09), (shaft / 1.5, shaft / 1.0))
    for mode, printed_hz in ((1, 171.0), (2, 277.0)):
        yield _row(
            f"oil engine and pump: natural frequency {mode}", printed_hz,
            float(engine.modes().frequencies_hz[mode]), "Hz", 0.5,
            "J .15 .3 .09 kg m^2, shaft of 70 mm, 1.5 and 1.0 m, G 84 GPa; to 1 Hz",
            "published", "independent solution", TEXTBOOK,
        )  # fmt: skip
    two = _train(model, (0.0035, 0.0026), (21.0,)).modes().frequencies_hz[1]
    yield _row(
        "two inertias: sqrt(k (1 / J1 + 1 / J2))", 118.64621, math.tau * float(two), "rad/s", 1e-5,
        "J .0035, .0026 kg m^2; 21 N m/rad",
    )  # fmt: skip


def _play(model: Model) -> Iterator[Fact]:
    locked = _train(model, *_LOCKED)
    omega = math.sqrt(21.0 / 0.0035)
    for amplitude, hertz in _BACKBONE.items():
        # A blow from the middle of the play at the speed that reaches this amplitude.
        run = locked.transient({}, 3.0 / hertz, 2, speeds_rad_per_s=omega * amplitude)
        contacts = run.impacts.filter(pl.col("twist_rad") > 0)["time_s"]
        found = 1 / (contacts[1] - contacts[0]) if len(contacts) > 1 else math.nan
        yield _row(
            f"frequency through the play at {amplitude:g} rad beyond it", hertz, found, "Hz", 1e-6,
            "J .0035 kg m^2, 21 N m/rad, 28 deg; period 2 pi / w + 4 gamma / (w a)",
        )  # fmt: skip
    for load, factor in _REVERSALS.items():
        yield _row(
            f"reversal of {load:g} T_N through the play: peak over static torque", factor,
            _peak(locked, load * _TORQUE, -load * _TORQUE) / (load * _TORQUE), "1", 1e-6,
            "the same, locked; 1 + 2 sqrt(1 + K gamma / T)",
        )  # fmt: skip
    stiff = _train(model, (0.0035,), (21.0,), None, True)
    yield _row(
        "reversal without play: peak over static torque", 3.0,
        _peak(stiff, _TORQUE, -_TORQUE) / _TORQUE, "1", 1e-9, "1 + 2",
    )  # fmt: skip
    for inertia, factor in _MOTOR_ALONE.items():
        free = _train(model, (0.0035, inertia), (21.0,), (_GAP,))
        run = free.transient({0: -_TORQUE}, 0.5, 2, preload_nm={0: _TORQUE, 1: -_TORQUE})
        yield _row(
            f"the motor alone reverses, load of {inertia:g} kg m^2: peak over static torque",
            factor, _largest(run) / _TORQUE, "1", 1e-6, "closed form of the energy",
        )  # fmt: skip


def _peak(train: Train, before: float, after: float) -> float:
    """Largest torque of a reversal [N m]; NaN where an error put in leaves nothing that holds."""
    try:
        return _largest(train.transient({0: after}, 1.0, 2, preload_nm={0: before}))
    except InputError:
        return math.nan


def _largest(run: Transient) -> float:
    return max(abs(torque) for torque in run.peak_torques_nm.values())


def _five_inertias(model: Model) -> Iterator[Fact]:
    train = _train(model, *_FIVE)

    def row(
        fact: str, expected: float, computed: float, unit: str, tolerance: float, note: str = ""
    ) -> Fact:
        return _row(
            f"five inertias{fact}", expected, computed, unit, tolerance,
            f"87:1 with play of 28 deg, assumed inertias{note}", "derived", "independent solution",
            TRAIN,
        )  # fmt: skip

    for mode, hertz in enumerate(_FIVE_HZ, 1):
        found = float(train.modes().frequencies_hz[mode])
        yield row(f": natural frequency {mode}", hertz, found, "Hz", 1e-6)
    ends = {0: _TORQUE, 4: -_TORQUE}
    run = train.transient({0: -_TORQUE, 4: _TORQUE}, 0.1, 2, preload_nm=ends)
    yield row(", both ends reversed: events in 0.1 s", 9, len(run.events), "1", 0)
    peak = abs(run.peak_torques_nm[train.spring_names[1]])
    yield row(
        ", both ends reversed: largest torque of the spring with play", 30.4575, peak, "N m", 1e-3,
        "; theirs is the largest of samples",
    )  # fmt: skip
    for name, angle in zip(train.names, _FIVE_ENDS, strict=True):
        found = run.table[f"angle_{name}_rad"][-1]
        yield row(f": angle of {name} after 0.1 s", angle, found, "rad", 1e-9)


def _the_87_1_drive(model: Model) -> Iterator[Fact]:
    drive = model.change_drive(Drive.reference_87()).replace(input_inertia_kg_m2=0.0035)
    locked = _first(model, drive.train(eccentric_inertia_kg_m2=4e-4))
    yield Fact(
        GROUP, "87:1, output locked: first natural frequency", 11.7, locked, "Hz",
        "assumed", "comparison", 0.3,
        "assumed inertias; the published line of .0500 to .0452 rad/(N m) gives 11.4 to 12.0 Hz",
    )  # fmt: skip
    for load, low, high in ((1.0, 58.0, 61.0), (5.0, 28.0, 29.0), (20.0, 16.7, 17.4)):
        train = drive.train(
            load_inertia_kg_m2=load,
            eccentric_inertia_kg_m2=4e-4,
            flange_inertia_kg_m2=0.012,
            coupling_stiffness_nm_per_rad=132.0 * 87**2,
        )
        yield Fact(
            GROUP, f"87:1, load of {load:g} kg m^2: first natural frequency", 0.5 * (low + high),
            _first(model, train), "Hz", "assumed", "comparison", 0.5 * (high - low),
            "assumed inertias; the published line behind a coupling of 132 N m/rad at the input",
        )  # fmt: skip
    eta = model.evaluate(Drive.reference_87())["compliance_factor"]
    without = _first(model, drive.train(with_efficiency=False, eccentric_inertia_kg_m2=4e-4))
    moved = locked / without if without else math.nan
    yield _row(
        "87:1: what eta moves every low frequency by, times the root of eta", 1.0,
        moved * math.sqrt(eta), "1", 1e-9, "1 / sqrt(eta) whatever the inertias",
    )  # fmt: skip


def _first(model: Model, train: Train) -> float:
    """First frequency that is not zero, NaN where there is none [Hz]."""
    found = model.change_train(train).modes().frequencies_hz
    return next((float(frequency) for frequency in found if frequency > 0), math.nan)
