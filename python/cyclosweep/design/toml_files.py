"""Reading of TOML files: their tables, and one clear line for what is wrong in one."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from cyclosweep.design.numbers import plain
from cyclosweep.errors import InputError

__all__ = ["TomlTable", "one_line", "read_toml"]


class TomlTable(BaseModel):
    """One table of a file: frozen, no unknown key, no value of another type.

    A NumPy scalar counts as the number it holds.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    @model_validator(mode="before")
    @classmethod
    def _numpy_scalars_are_numbers(cls, table: object) -> object:
        if isinstance(table, dict):
            return {key: plain(value) for key, value in table.items()}
        return table


def read_toml(path: str | Path) -> dict[str, Any]:
    """Read a TOML file.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        When it is not there, not text or not TOML.
    """
    try:
        return tomllib.loads(Path(path).read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8, expected TOML") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}") from None
    except RecursionError:
        raise InputError(f"{path}: nested too deeply, expected a flat TOML file") from None


def one_line(error: ValidationError) -> str:
    """Put a validation error into one line: key, what was found, what was expected.

    Parameters
    ----------
    error : pydantic.ValidationError
        What pydantic refused.

    Returns
    -------
    str
        The first problem, and how many more there are; every missing key is named at once.
    """
    problems = error.errors(include_url=False)
    first = problems[0]
    where = _path(first["loc"])
    kind = first["type"]
    more = len(problems) - 1
    if kind == "missing":
        missing = [_path(other["loc"]) for other in problems if other["type"] == "missing"]
        text = f"{', '.join(missing)}: missing"
        more = len(problems) - len(missing)
    elif kind == "extra_forbidden":
        text = f"{where}: unknown key"
    elif kind == "value_error":
        text = first["msg"].removeprefix("Value error, ")
        text = f"{where}: {text}" if where else text
    else:
        wanted = first["msg"].removeprefix("Input should be ").removeprefix("a valid ")
        text = f"{where}: found {_shortened(repr(first['input']))}, expected {wanted}"
    return f"{text} (and {more} more)" if more else text


def _path(steps: tuple[int | str, ...]) -> str:
    """Key of a problem, parts of a list counted from 1."""
    # Pydantic puts the kind of a shaft segment into the path of its keys.
    kinds = ("keyway", "cylinder", "frustum")
    named = (str(step + 1 if isinstance(step, int) else step) for step in steps)
    return ".".join(step for step in named if step not in kinds)


def _shortened(text: str) -> str:
    """Cut a text that would fill the line."""
    return text if len(text) <= 60 else f"{text[:57]}..."
