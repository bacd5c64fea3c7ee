"""Sealed answers: encrypted, with a hash that is public before any diagnosis runs."""

from __future__ import annotations

import hashlib
import hmac
import json
import secrets
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

MAGIC = b"cyclosweep.sealed/1\n"
SALT, TAG = 16, 32


class SealError(ValueError):
    """An answer is not the one that was sealed."""


def _keys(passphrase: str, salt: bytes) -> tuple[bytes, bytes]:
    """Keys for hiding and for authenticating, from a passphrase and one answer's salt."""
    # The passphrase is 256 random bits unless the scorer gives one; a single hash is enough.
    root = hashlib.sha256(passphrase.encode() + salt).digest()
    return hashlib.sha256(root + b"hide").digest(), hashlib.sha256(root + b"tag").digest()


def _veil(data: bytes, key: bytes) -> bytes:
    """Exclusive-or of the data with the key's SHAKE-256 stream; its own inverse."""
    stream = hashlib.shake_256(key).digest(len(data))
    return (int.from_bytes(data, "big") ^ int.from_bytes(stream, "big")).to_bytes(len(data), "big")


def new_passphrase() -> str:
    """Return 256 random bits as text."""
    return secrets.token_hex(32)


def seal(answer: dict[str, Any], path: Path, passphrase: str) -> str:
    """Write an answer so that it can be neither read nor exchanged.

    Parameters
    ----------
    answer : dict
        The answer; anything JSON can hold.
    path : pathlib.Path
        File to write.
    passphrase : str
        Kept by whoever scores.

    Returns
    -------
    str
        SHA-256 of the plain answer [hex]. The answer is salted with random bits first, so that
        guessing answers and hashing them leads nowhere.
    """
    salted = {"nonce": secrets.token_hex(16), "answer": answer}
    plain = json.dumps(salted, sort_keys=True, separators=(",", ":")).encode()
    salt = secrets.token_bytes(SALT)
    hide, tag = _keys(passphrase, salt)
    hidden = _veil(zlib.compress(plain, 6), hide)
    body = MAGIC + salt + hmac.new(tag, salt + hidden, hashlib.sha256).digest() + hidden
    partial = path.with_suffix(".tmp")
    partial.write_bytes(body)
    partial.replace(path)
    return hashlib.sha256(plain).hexdigest()


def unseal(path: Path, passphrase: str, expected_hash: str) -> dict[str, Any]:
    """Open an answer and check that it is the one whose hash was published.

    Raises
    ------
    SealError
        If the file was changed, the passphrase is another, or the hash does not match.
    """
    body = path.read_bytes()
    if not body.startswith(MAGIC):
        raise SealError(f"{path.name}: not a sealed answer")
    rest = body[len(MAGIC) :]
    salt, mac, hidden = rest[:SALT], rest[SALT : SALT + TAG], rest[SALT + TAG :]
    hide, tag = _keys(passphrase, salt)
    if not hmac.compare_digest(mac, hmac.new(tag, salt + hidden, hashlib.sha256).digest()):
        raise SealError(f"{path.name}: changed since it was sealed, or another passphrase")
    plain = zlib.decompress(_veil(hidden, hide))
    found = hashlib.sha256(plain).hexdigest()
    if found != expected_hash:
        raise SealError(f"{path.name}: hash is {found}, published was {expected_hash}")
    answer: dict[str, Any] = json.loads(plain)["answer"]
    return answer


def root_hash(hashes: Iterable[tuple[str, str]]) -> str:
    """One hash over all answers' hashes, in the order of their keys [hex]."""
    lines = "".join(f"{key} {digest}\n" for key, digest in sorted(hashes))
    return hashlib.sha256(lines.encode()).hexdigest()
