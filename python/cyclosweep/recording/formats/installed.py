"""Libraries that only some formats need."""

import importlib
from pathlib import Path
from typing import Any

from cyclosweep.errors import InputError

__all__ = ["needs"]


def needs(module: str, path: Path, otherwise: str) -> Any:
    """Import a library of ``cyclosweep[formats]``.

    Parameters
    ----------
    module : str
        Its name.
    path : Path
        File that needs it.
    otherwise : str
        What to do without it.

    Returns
    -------
    module

    Raises
    ------
    InputError
        When it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        raise InputError(
            f"{path}: {module} is not installed, expected: pip install 'cyclosweep[formats]' "
            f"(or {otherwise})"
        ) from None
