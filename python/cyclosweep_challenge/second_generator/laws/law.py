"""What a law is: the effect it stands for, where it comes from, and how it acts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.path import Path

Array = NDArray[np.float64]
Parameters = Mapping[str, float]


@dataclass(frozen=True)
class State:
    """What a law that adds to the angle sees of the drive; each array has shape (N,).

    Attributes
    ----------
    path : Path
        Load programme.
    twist : array
        Elastic torque in rated torques, friction taken off [-].
    side : array
        Side of the play on which the flanks touch: -1, 0 (in the play) or 1.
    angle_deg : array
        Angle that dead zone and line alone would show [deg].
    twist_deg : float
        Elastic twist at the rated torque [deg].
    mesh_per_deg : float
        Travel of the mesh zone per degree of measured angle [-].
    """

    path: Path
    twist: Array
    side: Array
    angle_deg: Array
    twist_deg: float
    mesh_per_deg: float


Addition = Callable[[State, Parameters], Array]
Draw = Callable[[np.random.Generator, float, float], dict[str, float]]


@dataclass(frozen=True)
class Law:
    """One law for one effect.

    Attributes
    ----------
    effect : str
        Name of the vocabulary, or of the cause where it is outside it.
    name : str
        Name of the law, unique within its effect.
    source : str
        Where the law is published.
    draw : callable
        Draws shape parameters from a source of chance, the largest load [rated torques] and the
        duration of the programme [s].
    adds : callable or None
        Angle added per unit of size [deg]; None for a law of the torque balance.
    needs : frozenset of str
        What a programme must have to show it: clock, runs, crank, temperature, input.
    random : bool
        Whether its course is chance, so that no law predicts it on another programme.
    """

    effect: str
    name: str
    source: str
    draw: Draw
    adds: Addition | None = None
    needs: frozenset[str] = field(default_factory=frozenset)
    random: bool = False


@dataclass(frozen=True)
class Cause:
    """A law at work in one specimen.

    Attributes
    ----------
    law : Law
        The law.
    size : float
        Share of the largest torque where the law is one of the balance [-]; else the factor on
        the angle that it adds [deg].
    shape : mapping
        Its shape parameters.
    """

    law: Law
    size: float
    shape: Parameters
