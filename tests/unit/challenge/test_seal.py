"""A sealed answer can be neither read, guessed nor exchanged."""

from pathlib import Path

import pytest

from cyclosweep_challenge.trial.seal import SealError, new_passphrase, root_hash, seal, unseal

ANSWER = {"effects": ["creep"], "d": 12.0}


def test_opens_to_what_was_sealed(tmp_path: Path) -> None:
    file = tmp_path / "a.sealed"
    digest = seal(ANSWER, file, "secret")
    assert unseal(file, "secret", digest) == ANSWER
    assert b"creep" not in file.read_bytes()


def test_any_changed_byte_is_noticed(tmp_path: Path) -> None:
    file = tmp_path / "a.sealed"
    digest = seal(ANSWER, file, "secret")
    body = bytearray(file.read_bytes())
    for place in (0, 25, 45, len(body) - 1):
        changed = bytearray(body)
        changed[place] ^= 1
        file.write_bytes(bytes(changed))
        with pytest.raises(SealError):
            unseal(file, "secret", digest)


def test_other_passphrase_is_noticed(tmp_path: Path) -> None:
    file = tmp_path / "a.sealed"
    digest = seal(ANSWER, file, "secret")
    with pytest.raises(SealError, match="passphrase"):
        unseal(file, "other", digest)


def test_an_exchanged_answer_does_not_match_the_published_hash(tmp_path: Path) -> None:
    file = tmp_path / "a.sealed"
    published = seal(ANSWER, file, "secret")
    seal({"effects": []}, file, "secret")
    with pytest.raises(SealError, match="published"):
        unseal(file, "secret", published)


def test_equal_answers_have_unequal_hashes(tmp_path: Path) -> None:
    """Otherwise a table of hashes of likely answers would open every seal."""
    assert seal(ANSWER, tmp_path / "a", "s") != seal(ANSWER, tmp_path / "b", "s")


def test_root_depends_on_every_hash_but_not_on_their_order() -> None:
    pairs = [("case-1", "aa"), ("case-2", "bb")]
    assert root_hash(pairs) == root_hash(reversed(pairs))
    assert root_hash(pairs) != root_hash([("case-1", "aa"), ("case-2", "bc")])


def test_passphrases_are_long_and_new() -> None:
    assert len(new_passphrase()) == 64
    assert new_passphrase() != new_passphrase()
