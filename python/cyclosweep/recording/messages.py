"""Text from files in messages: short, printable, on one line."""


def one_line(text: str) -> str:
    r"""Collapse a message to one printable line.

    Examples
    --------
    >>> one_line("first\n  second\x0b")
    'first second'
    """
    return printable(" ".join(text.split()))


def printable(text: str) -> str:
    r"""Escape what is not printable, as line breaks in a column name are not.

    Examples
    --------
    >>> printable("a\nb")
    'a\\nb'
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def shown(text: str) -> str:
    """Quote text from a file, shortened."""
    return repr(text if len(text) <= 40 else text[:37] + "...")
