"""Shapes without a name are printed in words that the documentation explains."""

from pathlib import Path

import pytest

from cyclosweep.diagnosis.hypotheses.sinusoid import FAMILIES
from cyclosweep.diagnosis.hypotheses.unnamed_shapes import FAMILIES_ALIKE
from cyclosweep.report.summary import summary_of
from cyclosweep.result import Answer, Explanation, Mismatch, Remainder
from cyclosweep.result.shape_words import PHRASES, cause_in_words, shape_of_size
from cyclosweep.simulation.effects import VOCABULARY

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis.md"


def test_every_shape_has_words_and_every_word_a_line_in_the_documentation() -> None:
    families = {effect.family for effect in VOCABULARY}
    assert {*FAMILIES_ALIKE, *FAMILIES, *families} <= set(PHRASES)
    text = PAGE.read_text(encoding="utf-8")
    for shape, words in PHRASES.items():
        assert f"| {words} | `{shape}` |" in text


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (
            "torque and direction",
            "a misfit that depends on torque and direction of loading, 0.65 deg",
        ),
        ("step of the angle", "a step of the angle of 0.65 deg"),
        ("creep_like", "something like creep like of 0.65 deg"),
    ],
)
def test_a_shape_is_described_with_its_size(shape: str, words: str) -> None:
    assert shape_of_size(shape, "0.65 deg") == words
    answer = Answer(
        verdict="UNKNOWN_PHYSICS",
        mismatch=Mismatch(p_value=0.001),
        unknown=Remainder(shape=shape, size_deg=0.65),
    )
    assert words in summary_of(answer)


def test_lists_of_explanations_use_the_same_words() -> None:
    names = Explanation(effects=("creep",), without_name=("torque and direction",), probability=1.0)
    told = summary_of(Answer(verdict="AMBIGUOUS", explanation_set=(names,)))
    assert "creep + a misfit that depends on torque and direction of loading (100 %)" in told
    assert cause_in_words("viscous_drag") == "viscous drag"
