"""Points and commas that may be decimal signs or divide thousands, told by a whole text."""

import re

__all__ = ["told_apart"]


def told_apart(content: bytes, separator: str) -> tuple[str, str] | None:
    r"""Tell by each other what points and commas mean, in a text that has both.

    Numbers such as 3.333 and 10.000 may be whole ones in groups of three digits. They are where
    all numbers with that sign can be, and numbers with the other sign cannot, as 0,5 beside them.

    Parameters
    ----------
    content : bytes
        Rows of numbers.
    separator : str
        Character between cells; cells that hold it are in quotes.

    Returns
    -------
    tuple of str, or None
        Decimal sign and sign between groups; None where nothing tells.

    Examples
    --------
    >>> told_apart(b"0,5;3.333\n30,0;200.000", ";")
    (',', '.')
    >>> told_apart(b"0,5;3.333\n30,0;200.00", ";") is None
    True
    """
    if b"," not in content or b"." not in content:
        return None
    if separator in ",." and b'"' not in content:  # no number holds it
        return None
    for decimal, group in ((",", "."), (".", ",")):
        if _any_fraction(content, decimal, separator) and _all_groups(content, group, separator):
            return decimal, group
    return None


def _cell(number: str, separator: str, sign: str) -> re.Pattern[bytes]:
    """Pattern of a whole cell with a number.

    Parameters
    ----------
    number : str
        Pattern of the number, in which ``@`` stands for the sign.
    separator : str
        Character between cells.
    sign : str
        Point or comma.

    Returns
    -------
    re.Pattern
    """
    edge = '"' if sign == separator else f'[{re.escape(separator)}"\\n]'
    number = number.replace("@", re.escape(sign))
    return re.compile(f"(?:^|(?<={edge})) *[+-]?(?:{number}) *(?=\\r?{edge}|\\r?$)".encode())


def _any_fraction(content: bytes, sign: str, separator: str) -> bool:
    """Whether a sign is a decimal sign somewhere: behind it are not three digits, or before it 0.

    Parameters
    ----------
    content : bytes
        Rows of numbers.
    sign : str
        Point or comma.
    separator : str
        Character between cells.

    Returns
    -------
    bool
    """
    fraction = r"0*@\d+|\d{4,}@\d*|\d+@(?:\d{0,2}|\d{4,})|\d*@\d+[eE][+-]?\d+"
    return _cell(fraction, separator, sign).search(content) is not None


def _all_groups(content: bytes, sign: str, separator: str) -> bool:
    """Whether numbers have a sign, and all of them can be whole ones in groups of three digits.

    Parameters
    ----------
    content : bytes
        Rows of numbers.
    sign : str
        Point or comma.
    separator : str
        Character between cells.

    Returns
    -------
    bool
    """
    grouped = _cell(r"[1-9]\d{0,2}(?:@\d{3})+", separator, sign)
    return grouped.search(content) is not None and not _any_fraction(content, sign, separator)
