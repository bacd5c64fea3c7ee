"""Reading of TOML files: their tables, and one clear line for what is wrong in one."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from cyclosweep.design.numbers import plain
from cyclosweep.errors import InputError, did_you_mean, path_of

__all__ = ["TomlTable", "one_line", "read_as", "read_toml", "refuse_other_kind"]


Table = TypeVar("Table", bound=BaseModel)


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

    if not TYPE_CHECKING:  # a type checker sees the fields

        def __init__(self, **given: Any) -> None:
            try:
                super().__init__(**given)
            except ValidationError as error:
                line = one_line(error, type(self))
                raise InputError(f"{type(self).__name__}: {line}") from None

        # Reading a file does not come through here: pydantic's own mark of a plain constructor.
        __init__.__pydantic_base_init__ = True

        def __setattr__(self, name: str, value: object) -> None:
            if name.startswith("_"):
                super().__setattr__(name, value)
            else:
                kind = type(self).__name__
                raise InputError(f"{name}: a {kind} does not change, expected a new {kind}")


_KINDS = {
    "a drive file": {"eccentricity_mm", "ring_pin_circle_radius_mm", "output_pin_count"},
    "a study": {"axes", "sample", "objective", "limits", "constraints"},
    "an event": {"kind", "duration_s"},
    "tolerances": {"tolerances"},
    "metadata of a recording": {"columns", "history", "merge", "score", "select", "side", "table"},
}
"""Keys at the top of a file that tell its kind from the others."""


def _kind_of(keys: Collection[str]) -> str | None:
    """Kind of a file by its keys, where only one has any of them."""
    kinds = [kind for kind, own in _KINDS.items() if not own.isdisjoint(keys)]
    return kinds[0] if len(kinds) == 1 else None


def refuse_other_kind(found: Collection[str], expected: str, source: str | Path) -> None:
    """Refuse a file whose keys say that it is one of another kind.

    Parameters
    ----------
    found : collection of str
        Keys at the top of the file.
    expected : str
        The kind it is to be, in words; one of those by which files are told apart.
    source : str or Path
        Name of the file.

    Raises
    ------
    InputError
        With both kinds.
    """
    kind = _kind_of(found)
    if kind not in (None, expected):
        raise InputError(f"{source}: this is {kind}, expected {expected}")


def read_as(table: type[Table], expected: str, found: dict[str, Any], source: str | Path) -> Table:
    """Make a table of what a file holds, or say in one line why it is none.

    Parameters
    ----------
    table : type
        What the file is to be.
    expected : str
        Its kind in words; one of those by which files are told apart.
    found : dict
        What the file holds.
    source : str or Path
        Name of the file.

    Returns
    -------
    TomlTable

    Raises
    ------
    InputError
        A key is wrong, or the whole file is one of another kind.
    """
    try:
        return table.model_validate(found)
    except ValidationError as error:
        line = f"{source}: {one_line(error, table)}"
    refuse_other_kind(found, expected, source)
    raise InputError(line)


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
    path = path_of("file", path)
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


_EXPECTED = {
    "float_type": "a number",
    "bool_type": "true or false",
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
}
"""What a key takes, in the words of a TOML file rather than of Python."""


_QUOTE = "'"


def one_line(error: ValidationError, *tables: type[BaseModel]) -> str:
    """Put a validation error into one line: key, what was found, what was expected.

    Parameters
    ----------
    error : pydantic.ValidationError
        What pydantic refused.
    *tables : type
        The table that was read, or all that it could be: by their keys a misspelt one is known.

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
    unknown = [_unknown(other, tables) for other in problems if other["type"] == "extra_forbidden"]
    if kind == "missing":
        missing = [_path(other["loc"]) for other in problems if other["type"] == "missing"]
        # A key is missing because it is misspelt, where an unknown one is close to a known one.
        misspelt = [text for text in unknown if text.endswith("?")]
        text = "; ".join([f"{', '.join(missing)}: missing", *misspelt])
        more = len(problems) - len(missing) - len(misspelt)
    elif kind == "extra_forbidden":
        text = unknown[0]
    elif kind == "value_error":
        text = first["msg"].removeprefix("Value error, ")
        text = f"{where}: {text}" if where else text
    elif kind == "union_tag_not_found":
        text = f"{where}.{first['ctx']['discriminator'].strip(_QUOTE)}: missing"
    elif kind == "union_tag_invalid":
        choices = first["ctx"]["expected_tags"]
        where = f"{where}.{first['ctx']['discriminator'].strip(_QUOTE)}"
        text = f"{where}: {_not_of(first['ctx']['tag'], choices)}"
    elif kind == "too_short":
        least = first["ctx"]["min_length"]
        text = f"{where}: {_not_of(first['input'], f'at least {least} in the list')}"
    else:
        wanted = first["msg"].removeprefix("Input should be ").removeprefix("a valid ")
        wanted = _EXPECTED.get(kind, wanted)
        text = f"{where}: {_not_of(first['input'], wanted)}"
    return f"{text} (and {more} more)" if more else text


def _unknown(problem: ErrorDetails, tables: Sequence[type[BaseModel]]) -> str:
    """What is said of a key that no table has."""
    steps = problem["loc"]
    return f"{_path(steps)}: unknown key{did_you_mean(steps[-1], _keys(tables, steps))}"


def _not_of(found: object, wanted: str) -> str:
    """What was found and what was expected, with the one of several choices that was meant."""
    hint = did_you_mean(found, re.findall(r"'([^']+)'", wanted))
    return f"found {_shortened(repr(found))}, expected {wanted}{hint}"


def _keys(tables: Sequence[type[BaseModel]], steps: tuple[int | str, ...]) -> list[str]:
    """Keys of the table in which the last step of a path stands."""
    for step in steps[:-1]:
        fields = [field for each in tables for key, field in _by_key(each).items() if key == step]
        # An index of a list, or the kind of a segment, stays in the same tables.
        tables = [each for field in fields for each in _tables(field.annotation)] or tables
    return [key for each in tables for key in _by_key(each)]


def _by_key(table: type[BaseModel]) -> dict[str, FieldInfo]:
    return {field.alias or name: field for name, field in table.model_fields.items()}


def _tables(annotation: Any) -> list[type[BaseModel]]:
    """Every kind of table in a type, however deep."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [table for inner in get_args(annotation) for table in _tables(inner)]


def _path(steps: tuple[int | str, ...]) -> str:
    """Key of a problem, parts of a list counted from 1."""
    # Pydantic puts the kind of a shaft segment into the path of its keys.
    kinds = ("keyway", "cylinder", "frustum")
    named = (str(step + 1 if isinstance(step, int) else step) for step in steps)
    return ".".join(step for step in named if step not in kinds)


def _shortened(text: str) -> str:
    """Cut a text that would fill the line."""
    return text if len(text) <= 60 else f"{text[:57]}..."
