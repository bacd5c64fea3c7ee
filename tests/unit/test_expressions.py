"""Expressions of columns: the value of a row follows from that row, mistakes are one line."""

from __future__ import annotations

import math

import polars as pl
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import cyclosweep as cs
from cyclosweep.sweep.expressions import condition, expression, names_in, number

SCHEMA: dict[str, pl.DataType] = {
    "eccentricity_mm": pl.Float64(),
    "output_pin_count": pl.UInt32(),
    "statics_applicable": pl.Boolean(),
    "status": pl.Enum(["ok", "holes_overlap"]),
}
ROWS = pl.DataFrame(
    {
        "eccentricity_mm": [0.5, 0.7],
        "output_pin_count": [6, 10],
        "statics_applicable": [True, False],
        "status": ["ok", "holes_overlap"],
    },
    schema=SCHEMA,
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("output_pin_count - 8", [-2.0, 2.0]),  # counts are unsigned: 6 - 8 would be 4294967294
        ("output_pin_count / 4", [1.5, 2.5]),
        ("0.001 * 0.001 * eccentricity_mm", [5e-7, 7e-7]),
        ("power(eccentricity_mm, 2)", [0.25, 0.7**2]),
        ("greatest(eccentricity_mm, output_pin_count, 7.5)", [7.5, 10.0]),
        ("case when output_pin_count > 8 then 1 else 0 end", [0, 1]),
        ("pi() * eccentricity_mm", [math.pi * 0.5, math.pi * 0.7]),
        ("eccentricity_mm between 0.6 and 0.8", [False, True]),
        ("output_pin_count % 4 = 2 and status = 'ok'", [True, False]),
        ("not statics_applicable", [False, True]),
        ('"eccentricity_mm" * 2', [1.0, 1.4]),
    ],
)
def test_values(text: str, expected: list[object]) -> None:
    assert ROWS.select(expression(text, SCHEMA)).to_series().to_list() == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("eccentricty_mm * 2", "x: no column eccentricty_mm, did you mean eccentricity_mm?"),
        ("eccentricity_mm ^ 2", "expected power(a, b)"),
        ("eccentricity_mm ** 2", "expected power(a, b)"),
        ("eccentricity_mm - avg(eccentricity_mm)", "found avg(...)"),
        ("rank() over (order by eccentricity_mm)", "found rank(...)"),
        ("eccentricity_mm -", "which is no expression"),
        ("eccentricity_mm, output_pin_count", "which is no expression"),
        ("", "expected an expression of columns"),
    ],
)
def test_a_mistake_is_one_line(text: str, message: str) -> None:
    with pytest.raises(cs.InputError) as caught:
        expression(text, SCHEMA, where="x")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_numbers_and_conditions() -> None:
    assert number("output_pin_count", SCHEMA).meta.output_name() == "output_pin_count"
    assert ROWS.select(condition("eccentricity_mm < 0.6", SCHEMA)).to_series().to_list() == [
        True,
        False,
    ]
    with pytest.raises(cs.InputError, match="is no number"):
        number("status", SCHEMA)
    with pytest.raises(cs.InputError, match="expected a comparison"):
        condition("eccentricity_mm + 1", SCHEMA)
    assert names_in("sqrt(a_mm) + b_mm > 'c' and a_mm in (1, 2)") == ["a_mm", "b_mm"]


WORDS = [
    *("eccentricity_mm", "output_pin_count", "status", "statics_applicable", "'ok'", "1", "2.5"),
    *("(", ")", "+", "-", "*", "/", "<", "=", ",", "and", "or", "not", "in", "between", "is"),
    *("null", "case", "when", "then", "else", "end", "sqrt(", "least(", "coalesce("),
]


@example("eccentricity_mm and eccentricity_mm")
@example("least()")
@example("not status")
@given(st.one_of(st.text(max_size=30), st.lists(st.sampled_from(WORDS), max_size=8).map(" ".join)))
def test_any_text_is_an_expression_or_an_input_error(text: str) -> None:
    try:
        found = expression(text, SCHEMA)
    except cs.InputError:
        return
    assert ROWS.with_columns(found.alias("value")).height == 2
