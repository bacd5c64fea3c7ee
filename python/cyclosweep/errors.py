"""Errors that end in one clear line: bad input, a design that cannot be built, a failed sweep."""

from cyclosweep._core import DesignError

__all__ = ["DesignError", "InputError", "SweepError"]


class InputError(ValueError):
    """Bad input: one line that names the file, the row or key, what was found and expected.

    The command line turns it into exit status 2.
    """


class SweepError(RuntimeError):
    """A sweep that could not finish: a full disk, a lost worker, another sweep at work.

    What was whole stays; the same command goes on from there. The command line turns it into
    exit status 1.
    """
