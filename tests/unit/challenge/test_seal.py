"""An answer that was committed to cannot be exchanged, nor guessed from its hash."""

import hashlib
from pathlib import Path

import pytest

from cyclosweep_challenge.trial.seal import (
    SealError,
    commit_answer,
    reveal_answer,
    root_hash,
)

ANSWER = {"effects": ["creep"], "d": 12.0}


def test_what_is_revealed_is_what_was_committed(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    digest = commit_answer(ANSWER, file)
    assert reveal_answer(file, digest) == ANSWER
    # Anyone can check it with sha256sum.
    assert hashlib.sha256(file.read_bytes()).hexdigest() == digest


def test_any_changed_byte_is_noticed(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    digest = commit_answer(ANSWER, file)
    body = file.read_bytes()
    for place in (0, 5, body.index(b"creep"), len(body) - 1):
        changed = bytearray(body)
        changed[place] ^= 1
        file.write_bytes(bytes(changed))
        with pytest.raises(SealError, match="published"):
            reveal_answer(file, digest)


def test_an_exchanged_answer_does_not_match_the_published_hash(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    published = commit_answer(ANSWER, file)
    commit_answer(ANSWER, file)
    with pytest.raises(SealError, match="published"):
        reveal_answer(file, published)


def test_equal_answers_have_unequal_hashes(tmp_path: Path) -> None:
    """Otherwise a table of hashes of likely answers would tell which one is committed to."""
    assert commit_answer(ANSWER, tmp_path / "a") != commit_answer(ANSWER, tmp_path / "b")


def test_an_answer_encrypted_by_an_earlier_version_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "a.sealed").write_bytes(b"cyclosweep.sealed/1\n")
    with pytest.raises(SealError, match="sealed: encrypted by an earlier version"):
        reveal_answer(tmp_path / "a.json", "0" * 64)


def test_root_depends_on_every_hash_but_not_on_their_order() -> None:
    pairs = [("case-1", "aa"), ("case-2", "bb")]
    assert root_hash(pairs) == root_hash(reversed(pairs))
    assert root_hash(pairs) != root_hash([("case-1", "aa"), ("case-2", "bc")])
