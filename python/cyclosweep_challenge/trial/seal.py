"""Commit and reveal: the hash of an answer is published before any diagnosis runs.

An answer is written with a random nonce as canonical JSON; its commitment is the SHA-256 of that
file, so that ``sha256sum`` checks it. The file stays in a folder that the diagnosis is not shown,
and is compared with its commitment when the answers are revealed. Nothing is encrypted: what is
proved is that an answer was not changed after its hash was published.
"""

from __future__ import annotations

import hashlib
import json
import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import Any

LAST_ENCRYPTED = "c770241"
"""Last commit that can open the encrypted answers (``.sealed``) of earlier records."""


class SealError(ValueError):
    """An answer is not the one whose hash was published."""


def commit_answer(answer: dict[str, Any], path: Path) -> str:
    """Write an answer and return the hash that commits to it.

    Parameters
    ----------
    answer : dict
        The answer; anything JSON can hold.
    path : pathlib.Path
        JSON file to write, whole or not at all.

    Returns
    -------
    str
        SHA-256 of the file [hex]. The 256 random bits of its nonce keep anyone from finding the
        answer by hashing likely ones.
    """
    content = {"nonce": secrets.token_hex(32), "answer": answer}
    plain = json.dumps(content, sort_keys=True, separators=(",", ":")).encode()
    partial = path.with_suffix(".tmp")
    partial.write_bytes(plain)
    partial.replace(path)
    return hashlib.sha256(plain).hexdigest()


def reveal_answer(path: Path, published: str) -> dict[str, Any]:
    """Read an answer back and check that it is the one that was committed to.

    Parameters
    ----------
    path : pathlib.Path
        File that `commit_answer` wrote.
    published : str
        Its published hash [hex].

    Raises
    ------
    SealError
        If the file's hash is another, or if an earlier version encrypted the answer.
    OSError
        If there is no such file.
    """
    if not path.exists() and path.with_suffix(".sealed").exists():
        raise SealError(
            f"{path.with_suffix('.sealed').name}: encrypted by an earlier version; "
            f"commit {LAST_ENCRYPTED} can open it"
        )
    plain = path.read_bytes()
    found = hashlib.sha256(plain).hexdigest()
    if found != published:
        raise SealError(f"{path.name}: hash is {found}, published was {published}")
    answer: dict[str, Any] = json.loads(plain)["answer"]
    return answer


def root_hash(hashes: Iterable[tuple[str, str]]) -> str:
    """One hash over all answers' hashes, in the order of their keys [hex]."""
    lines = "".join(f"{key} {digest}\n" for key, digest in sorted(hashes))
    return hashlib.sha256(lines.encode()).hexdigest()
