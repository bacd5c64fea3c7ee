"""All that a structure misses, where no shape tells it: its size and its place."""

from collections.abc import Sequence
from dataclasses import replace

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.result import Region, Remainder
from cyclosweep.result.words import place_of

ALL_ALONG = "all along"
"""Place of what is everywhere."""
CONCENTRATED = 0.25
"""Share of the mean square of a misfit in one region, from which it is not all along."""
MISFIT = "misfit of the model"
"""What is left where no shape tells it."""


def at_its_place(found: Remainder, regions: Sequence[Region]) -> Remainder:
    """Say where a misfit lies that is concentrated in one region of the repaired model.

    Parameters
    ----------
    found : Remainder
        What is left.
    regions : sequence of Region
        Where model and recording differ, the strongest first.

    Returns
    -------
    Remainder
    """
    if found.shape != MISFIT or found.place != ALL_ALONG or not regions:
        return found
    share = regions[0].share_of_excess or 0.0
    if not regions[0].repaired or share < CONCENTRATED:
        return found
    place = f"{100 * share:.0f} % of its mean square in {place_of(regions)}"
    return replace(found, place=place)


def misfit_of(named: FittedStructure, shape: str, place: str) -> Remainder:
    """Describe all that a structure misses, by the same measure as the error of its fit.

    Parameters
    ----------
    named : FittedStructure
        The structure of the named effects.
    shape, place : str
        What it looks like, and where it is.

    Returns
    -------
    Remainder
    """
    error = named.prediction.error_deg
    return Remainder(shape=shape, place=place, size_deg=error, measure="root mean square")
