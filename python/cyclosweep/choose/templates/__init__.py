"""Commented files to begin with: a drive, a study, a recording's description, an event."""

from __future__ import annotations

from importlib import resources
from typing import Literal, get_args

from cyclosweep.errors import one_of

__all__ = ["Kind", "template"]

Kind = Literal["drive", "study", "recording", "event"]
"""What there is a template of."""


def template(kind: Kind) -> str:
    """Text of a file to begin with, which is valid as it is.

    Parameters
    ----------
    kind : {"drive", "study", "recording", "event"}
        What the file describes.

    Returns
    -------
    str
        TOML with comments.

    Raises
    ------
    InputError
        For another kind.

    Examples
    --------
    >>> print(template("study").splitlines()[2].split("#")[0].strip())
    drive = "reference-87"
    """
    one_of("template", kind, get_args(Kind))
    file = resources.files("cyclosweep.choose.templates").joinpath(f"{kind}.toml")
    return file.read_text(encoding="utf-8")
