"""What of a study decides its numbers beside its space: parts, train, own columns, conditions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cyclosweep.design.drive import Drive
from cyclosweep.design.parts import TRAIN_INPUTS
from cyclosweep.sweep.own_columns import Column, digest

__all__ = ["own_definition", "part_definition", "train_definition"]


def part_definition(drive: Drive, model: str, solver: str) -> dict[str, Any]:
    """Return what else decides the numbers of the component model; nothing without it.

    Parameters
    ----------
    drive : Drive
        What does not vary.
    model, solver : str
        Of the study.

    Returns
    -------
    dict
    """
    if model == "published":
        return {}
    return {"model": model, "solver": solver, "parts": drive.part_definition()}


def train_definition(drive: Drive) -> dict[str, Any]:
    """Return what else decides the numbers of the torsional train.

    Parameters
    ----------
    drive : Drive
        What does not vary.

    Returns
    -------
    dict
    """
    return {"train": {name: repr(getattr(drive, name)) for name in TRAIN_INPUTS}}


def own_definition(
    constraints: Mapping[str, Column],
    columns: Mapping[str, Column],
    keep: tuple[str, ...] | None,
    only_ok: bool,
) -> dict[str, Any]:
    """Return own columns, conditions and what is kept; nothing where there is none of them.

    Parameters
    ----------
    constraints, columns : mapping of str to Column
        Of the user's own.
    keep : tuple of str or None
        Columns that a sweep gives.
    only_ok : bool
        Whether it gives only variants that can be built.

    Returns
    -------
    dict
    """
    found: dict[str, Any] = {}
    for key, own in (("constraints", constraints), ("own_columns", columns)):
        if own:
            found[key] = [[name, digest(column)] for name, column in own.items()]
    if keep is not None:
        found["keep"] = list(keep)
    return {**found, "only_ok": True} if only_ok else found
