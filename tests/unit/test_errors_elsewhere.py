"""A law that is smaller than what a larger one misses where that is known is not named."""

from types import SimpleNamespace
from typing import Any

import pytest

from cyclosweep.diagnosis.identify.laws.class_check import _smaller_than_errors


def compared(name: str, by_law: float, *missed: float, share: float = 1.0) -> Any:
    """Comparison of one law with its classes, by their log evidence."""
    terms = [SimpleNamespace(name=name)]
    left = [SimpleNamespace(evidence=each) for each in missed]
    fitted = SimpleNamespace(terms=terms, independent_share=share)
    return SimpleNamespace(fitted=fitted, indices=[0], by_law=by_law, left=left)


@pytest.mark.parametrize(("missed", "withdrawn"), [(56.9, {"take-up"}), (15.0, set())])
def test_a_law_is_compared_with_what_a_larger_one_misses(
    missed: float, withdrawn: set[str]
) -> None:
    laws = [
        compared("friction", 4120.0, 15.5),
        compared("side load", 3171.0, 3.0, missed),
        compared("take-up", 19.7, 0.6),
    ]
    assert _smaller_than_errors(laws) == withdrawn


def test_a_smaller_law_is_no_measure_of_a_larger_one() -> None:
    assert _smaller_than_errors([compared("creep", 40.0), compared("drag", 30.0, 60.0)]) == set()


def test_terms_of_a_whole_loop_are_not_measured_so() -> None:
    laws = [
        compared("opening friction", 0.0, 5.0, share=0.1),
        compared("friction", -0.7, share=0.1),
    ]
    assert _smaller_than_errors(laws) == set()
