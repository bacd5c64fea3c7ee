"""Origin of a page's figures: command, seed, machine, code, and the record's parts."""

from __future__ import annotations

from collections.abc import Sequence

from cyclosweep_challenge.record.markdown import Plain, table
from cyclosweep_challenge.record.parts import Size


def origin(content: Plain, log: Sequence[Plain], name: str, command: str) -> str:
    """Tables of a record's origin and parts, and where its numbers and its log are.

    Parameters
    ----------
    content : mapping
        What ``<name>.json`` holds.
    log : sequence of mapping
        Lines of the record's log.
    name : str
        Name of the page.
    command : str
        Command that makes the record.
    """
    about, done = content["record"], content["about"]["parts"]
    machine = about["machine"]
    parts = [part for part in Size(**about["size"]).parts() if part.cases]
    rows = [
        ("command", command),
        (
            "seed",
            f"{about['seed']}, plus "
            + ", ".join(str(part.offset) for part in parts)
            + " for the parts below",
        ),
        ("begun, ended", f"{log[0]['time'][:16]}, {log[-1]['time'][:16]} UTC" if log else "–"),
        (
            "machine",
            f"{machine['processor']}, {machine['cores']} cores, {machine['memory_gb']} GB, "
            f"{machine['system']}, Python {machine['python']}",
        ),
        ("libraries", ", ".join(f"{k} {v}" for k, v in machine["libraries"].items() if v)),
        ("commit", f"`{about['commit'] or 'unknown'}`"),
        ("code that diagnoses, SHA-256", f"`{about['diagnosis']}`"),
        ("code that makes recordings, SHA-256", f"`{about['rig']}`"),
        ("head of the log, SHA-256", f"`{content['about']['root']}`"),
    ]
    counted = [(p.name, f"{done.get(p.name, 0):,}", f"{p.cases:,}", p.what) for p in parts]
    return (
        table(("", ""), rows)
        + "\n\n"
        + table(("part", "done", "planned", "what"), counted)
        + f"\n\nAll numbers are in [{name}.json]({name}.json), the root over the answers "
        f"of every slice with the time of its publication in "
        f"[{name}-published.jsonl]({name}-published.jsonl)."
    )
