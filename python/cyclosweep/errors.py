"""Errors that end in one clear line: bad input, a design that cannot be built, a failed sweep."""

import contextlib
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from difflib import SequenceMatcher, get_close_matches
from importlib import import_module
from pathlib import Path
from typing import TypeVar

from cyclosweep._core import DesignError

__all__ = [
    "DesignError",
    "InputError",
    "SweepError",
    "did_you_mean",
    "instance_of",
    "names_of",
    "naming",
    "one_of",
    "path_of",
    "refuse_no_file",
    "require_matplotlib",
]

Name = TypeVar("Name", bound=object)

_LINE_BREAK = re.compile(r"\s*\n\s*")

_SHORTEST_PART = 4
"""Letters of a name that is looked for inside known ones: three are in too many of them."""


class InputError(ValueError):
    """Bad input: one line that names the file, the row or key, what was found and expected.

    The command line turns it into exit status 2.
    """

    def __str__(self) -> str:
        """The message in one line, also where what was found has several."""
        return _LINE_BREAK.sub(" ", super().__str__())


class SweepError(RuntimeError):
    """A sweep that could not finish: a full disk, a lost worker, another sweep at work.

    What was whole stays; the same command goes on from there. The command line turns it into
    exit status 1.
    """


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """End of a message about an unknown name: the known one that was most likely meant.

    Parameters
    ----------
    name : object
        What was found.
    known : iterable of str
        Names that exist.

    Returns
    -------
    str
        ``", did you mean NAME?"``; empty where no known name is close. Capitals, hyphens and
        blanks do not count but between names that differ in nothing else, and part of a name finds
        the shortest one that holds it.

    Examples
    --------
    >>> did_you_mean("eccentricty_mm", ["eccentricity_mm", "ratio"])
    ', did you mean eccentricity_mm?'
    >>> did_you_mean("frequency", ["ratio", "natural_frequency_hz"])
    ', did you mean natural_frequency_hz?'
    >>> did_you_mean("E halvd", ["E halved", "e halved"])
    ', did you mean E halved?'
    >>> did_you_mean("colour", ["ratio"])
    ''
    """
    written: dict[str, list[str]] = {}
    for each in known:
        written.setdefault(_plain(each), []).append(each)
    found = str(name)
    wanted = _plain(found)
    close = get_close_matches(wanted, written, n=1)
    if not close and len(wanted) >= _SHORTEST_PART:
        close = sorted((each for each in written if wanted in each), key=len)
    if not close:
        return ""
    meant = max(written[close[0]], key=lambda each: SequenceMatcher(None, each, found).ratio())
    return f", did you mean {meant}?"


def one_of(what: str, found: Name, known: Collection[object]) -> Name:
    """Return a name that has to be one of several, and refuse another.

    Parameters
    ----------
    what : str
        What is chosen, as a message calls it.
    found : object
        The name.
    known : collection
        Names that exist.

    Returns
    -------
    object
        The name as it was found.

    Raises
    ------
    InputError
        With all names, and the one that was most likely meant.

    Examples
    --------
    >>> one_of("side", "input", ("input", "output"))
    'input'
    """
    # A list or an array is no name, and could not be looked for in a dictionary.
    if not isinstance(found, (str, int, type(None))) or found not in known:
        names = [str(name) for name in known]
        raise InputError(
            f"{what}: found {_short(found)}, expected one of {', '.join(names)}"
            f"{did_you_mean(found, names)}"
        )
    return found


def instance_of(what: str, found: object, *kinds: type) -> None:
    """Refuse an argument of another kind than those that a function takes.

    Parameters
    ----------
    what : str
        Name of the argument.
    found : object
        What was given.
    *kinds : type
        Kinds that it may have.

    Raises
    ------
    InputError
        With what was found and what was expected.

    Examples
    --------
    >>> instance_of("folder", "study", str)
    """
    if not isinstance(found, kinds):
        names = " or ".join(kind.__name__ for kind in kinds)
        raise InputError(f"{what}: found {_short(found)}, expected {names}")


def names_of(what: str, found: object, *, or_one: bool = False) -> list[str]:
    """Return names as a list, and refuse what is no list of names.

    Parameters
    ----------
    what : str
        Name of the argument.
    found : iterable of str
        At least one name, each once.
    or_one : bool
        Whether a text alone is a name.

    Returns
    -------
    list of str

    Raises
    ------
    InputError
        For none, one twice, a text alone unless it may be a name, or anything else.

    Examples
    --------
    >>> names_of("outputs", ("twist_1tn_deg",))
    ['twist_1tn_deg']
    """
    if or_one and isinstance(found, str):
        return [found]
    is_list = isinstance(found, Iterable) and not isinstance(found, (str, bytes, Mapping))
    names = list(found) if is_list else []  # type: ignore[call-overload]
    if not names or not all(isinstance(name, str) for name in names):
        raise InputError(f"{what}: found {_short(found)}, expected a list of names")
    if len(set(names)) < len(names):
        raise InputError(f"{what}: found {_short(names)}, expected each name once")
    return names


@contextlib.contextmanager
def naming(source: str | Path) -> Iterator[None]:
    """Put the file or folder of which something is refused before what is said of it.

    Parameters
    ----------
    source : str or Path
        Where it stands.

    Raises
    ------
    InputError
        The same one; its text begins with the source.

    Examples
    --------
    >>> with naming("study.toml"):
    ...     raise InputError("axes: none, expected at least one")
    Traceback (most recent call last):
        ...
    cyclosweep.errors.InputError: study.toml: axes: none, expected at least one
    """
    try:
        yield
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(str(source)) else f"{source}: {text}") from None


def path_of(what: str, found: object) -> Path:
    """Return the path that an argument says, and refuse what is none.

    Parameters
    ----------
    what : str
        Name of the argument.
    found : object
        A text or a path.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> path_of("folder", "study").name
    'study'
    """
    if not isinstance(found, (str, Path)):
        raise InputError(f"{what}: found {_short(found)}, expected a path")
    return Path(found)


_LONGEST_VALUE = 60
"""Characters of a value that a message repeats."""


def _short(found: object) -> str:
    """A value as a message shows it, in one line of bounded length."""
    text = " ".join(repr(found).split())
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 3]}..."


def _plain(name: str) -> str:
    """A name as it is compared: small letters, one sign between words."""
    return name.strip().lower().replace("-", "_").replace(" ", "_")


def refuse_no_file(path: Path) -> None:
    """Refuse a path at which there is no file to read.

    Parameters
    ----------
    path : Path
        Where a file is expected.

    Raises
    ------
    InputError
        With what is there instead.
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder, expected a file")
    if not path.is_file():
        raise InputError(f"{path}: no such file")


def require_matplotlib() -> None:
    """Refuse to draw a picture where matplotlib is not installed.

    Raises
    ------
    InputError
        With the extra that brings it.
    """
    try:
        import_module("matplotlib")
    except ImportError:
        raise InputError("pictures need matplotlib: pip install 'cyclosweep[report]'") from None
