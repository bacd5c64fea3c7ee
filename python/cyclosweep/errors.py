"""Errors that a user can act on."""


class InputError(ValueError):
    """Bad input, said in one line.

    The message names the file, the row or key, what was found and what was expected. The command
    line prints it without a traceback and ends with exit status 2.
    """
