"""A proposed metadata file as text, with the reason of each part beside it."""

import json
from typing import Any

from cyclosweep.recording.proposed import Proposal

__all__ = ["to_toml", "toml_value"]


def to_toml(made: Proposal, name: str) -> str:
    """Write a proposal as a metadata file with its reasons.

    Parameters
    ----------
    made : Proposal
        The proposal.
    name : str
        Name of the recording's file.

    Returns
    -------
    str
    """
    lines = [f"# How {name} is read; proposed by cyclosweep inspect."]
    lines += [f"# Check: {text}" for text in made.checks]
    lines += [f"# Assumed: {text}" for text in made.assumed]
    plain = {k: v for k, v in made.meta.items() if not isinstance(v, dict)}
    for key, value in plain.items():
        lines.append(f"{key} = {toml_value(value)}{_comment(made, key)}")
    for key, value in made.meta.items():
        if isinstance(value, dict):
            lines += ["", f"[{key}]{_comment(made, key)}"]
            lines += [
                f"{_key(k)} = {toml_value(v)}{_comment(made, f'{key}.{k}')}"
                for k, v in value.items()
            ]
    return "\n".join(lines) + "\n"


def _comment(made: Proposal, key: str) -> str:
    """Mark a key that the file does not state, with the reason where it does not stand above.

    Parameters
    ----------
    made : Proposal
        With the remarks.
    key : str
        The key.

    Returns
    -------
    str
        Empty where there is none.
    """
    if key not in made.remarks:
        return ""
    return f"  # Assumed: {made.remarks[key]}" if made.remarks[key] else "  # Assumed, see above"


def _key(key: str) -> str:
    """Key of a table, quoted where it needs to be."""
    plain = key.replace("_", "").replace("-", "")
    return key if plain.isascii() and plain.isalnum() else json.dumps(key, ensure_ascii=False)


def toml_value(value: Any) -> str:
    """Value in the form of TOML, tables on one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {toml_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
