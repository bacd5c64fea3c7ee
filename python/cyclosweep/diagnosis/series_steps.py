"""Order that the staircases of several recordings share.

One recording passes a few steps only, of which chance makes a clear order too often. Recordings
of one rig pass the same motor and the same mesh at other places, and what pulsates with these has
one order in all of them.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.diagnosis.series import Row
from cyclosweep.diagnosis.whole_loop.staircase_found import are_tied_steps
from cyclosweep.diagnosis.whole_loop.step_order import apart
from cyclosweep.diagnosis.whole_loop.step_spectrum import (
    Leg,
    StepSpectrum,
    enough,
    from_one_place,
    legs_in,
    length_deg,
    orders_in,
    step_spectrum,
)
from cyclosweep.recording import Recording
from cyclosweep.result.series import OwnOrder, StepsInCommon
from cyclosweep.simulation.effects.history import Floats

FEWEST = 2
"""Recordings with steps from which an order is looked for that they share."""
MOST_UNLIKE = 1.6
"""Length of a recording's legs over the usual one, or the other way round, beyond which it is left
out: it shows other orders."""
CERTAIN_IN_COMMON = 0.01
"""Share of random staircases of at least as clear an order up to which an order that recordings
share is stated."""


def steps_of(found: Diagnosis) -> dict[str, Any] | None:
    """Torque along the legs of a recording in which steps repeat at the same positions, as data.

    Parameters
    ----------
    found : Diagnosis

    Returns
    -------
    dict or None
        None where no steps repeat, or where the ratio of the drive is not known; see
        `legs_as_data`.
    """
    if found.ratio is None or not any(map(are_tied_steps, found.answer.findings)):
        return None
    return legs_as_data(found.recording, found.ratio)


def legs_as_data(recording: Recording, ratio: float) -> dict[str, Any] | None:
    """Torque along the legs of a recording, whether or not steps repeat in it.

    Parameters
    ----------
    recording : Recording
    ratio : float
        Reduction of the drive.

    Returns
    -------
    dict or None
        None where the recording has no angle, or no legs of two kinds.
    """
    if recording.angle_deg is None:
        return None
    run = np.unique(recording.run, return_inverse=True)[1]
    legs = list(legs_in(recording.torque_nm, recording.angle_deg, run))
    if not enough(legs):
        return None
    return {
        "turns_of_input": float(ratio) if recording.side == "output" else 1.0,
        "legs": [
            {
                "angle_deg": leg.angle_deg.tolist(),
                "torque_nm": leg.torque_nm.tolist(),
                "rising": leg.rising,
                "side": leg.side,
            }
            for leg in legs
        ],
    }


def steps_kept(files: Mapping[str, Path]) -> dict[str, Any]:
    """What `steps_of` returned, of the recordings whose files hold it under ``steps``, by name."""
    kept = {name: json.loads(file.read_text(encoding="utf-8")) for name, file in files.items()}
    return {name: each["steps"] for name, each in kept.items() if each.get("steps")}


def own_order(steps: StepsInCommon | None, name: str) -> Row:
    """Columns of a recording in the table of a series; none where it has no steps.

    Parameters
    ----------
    steps : StepsInCommon or None
    name : str
        Name of the recording.

    Returns
    -------
    dict
        ``step_order``, its clearest order, and ``step_order_chance``.
    """
    own = None if steps is None else steps.own.get(name)
    return {} if own is None else {"step_order": own.order, "step_order_chance": own.chance}


def steps_in_common(steps: Mapping[str, Mapping[str, Any]], seed: int = 0) -> StepsInCommon | None:
    """Look for the order that staircases share.

    The clearness of each order is the mean over the recordings, and so is that of random
    staircases. All recordings pass the same random staircase, so that a place that was recorded
    several times is no further evidence: once each at its own angles, and once as if all were made
    at one place, because the angle at which a sensor reads zero may differ between recordings. The
    larger of both chances is stated.

    Parameters
    ----------
    steps : mapping of str to mapping
        What `steps_of` returned, by the name of the recording.
    seed : int
        Seed of the random staircases.

    Returns
    -------
    StepsInCommon or None
        None of fewer than two recordings of alike legs.
    """
    legs = {name: _legs_of(each) for name, each in steps.items()}
    turns_a_deg = {name: each["turns_of_input"] / 360.0 for name, each in steps.items()}
    lengths = {name: turns_a_deg[name] * length_deg(each) for name, each in legs.items()}
    usual = float(np.median(list(lengths.values()))) if lengths else 0.0
    alike = [n for n, one in lengths.items() if max(one / usual, usual / one) <= MOST_UNLIKE]
    if len(alike) < FEWEST:
        return None
    orders = orders_in(usual)

    def spectrum(name: str, placed: Sequence[Leg]) -> StepSpectrum:
        cycles = orders * turns_a_deg[name]
        return step_spectrum(placed, cycles, np.random.default_rng(seed))

    spectra = {name: spectrum(name, legs[name]) for name in alike}
    at_one_place = [spectrum(name, from_one_place(legs[name])) for name in alike]
    common = _mean(list(spectra.values()))
    chance = max(common.chance, _mean(at_one_place).chance)
    order = float(orders[common.clearest])
    return StepsInCommon(
        order=order,
        apart=order * apart(usual, order),
        chance=chance,
        certain=chance <= CERTAIN_IN_COMMON,
        own={n: _own(own, common, len(spectra), orders) for n, own in spectra.items()},
        left_out=tuple(name for name in legs if name not in spectra),
    )


def _own(own: StepSpectrum, common: StepSpectrum, count: int, orders: Floats) -> OwnOrder:
    """Order of one recording, and how clear that of the others is in it.

    Parameters
    ----------
    own : StepSpectrum
        Of the recording.
    common : StepSpectrum
        Mean of all recordings.
    count : int
        How many they are.
    orders : ndarray, shape (k,)
        Cycles a turn of the input.

    Returns
    -------
    OwnOrder
    """
    others = int(np.argmax(count * common.clearness - own.clearness))
    return OwnOrder(
        order=float(orders[own.clearest]),
        chance=own.chance,
        order_of_others=float(orders[others]),
        chance_of_others=own.chance_at(others),
    )


def _legs_of(steps: Mapping[str, Any]) -> list[Leg]:
    """Legs from plain data."""
    return [
        Leg(
            np.array(leg["angle_deg"]),
            np.array(leg["torque_nm"]),
            bool(leg["rising"]),
            int(leg["side"]),
        )
        for leg in steps["legs"]
    ]


def _mean(spectra: Sequence[StepSpectrum]) -> StepSpectrum:
    """Mean clearness of several recordings, drawn staircase by drawn staircase."""
    return StepSpectrum(
        spectra[0].cycles_per_deg,
        np.mean([each.clearness for each in spectra], axis=0),
        np.mean([each.drawn for each in spectra], axis=0),
    )
