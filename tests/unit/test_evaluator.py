"""The evaluator gives the columns of a sweep, design by design and many at once."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cyclosweep as cs

DRIVE = cs.Drive.reference_87().replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
INPUTS = ["eccentricity_mm", "output_pin_count", "ring_clearance_mm"]
OUTPUTS = ["ring_contact_pressure_max_mpa", "twist_1tn_deg", "hole_web_mm", "active_pins_max"]

designs = st.lists(
    st.tuples(st.floats(0.2, 1.2), st.sampled_from([6.0, 8.0, 8.5, 12.0]), st.floats(0.0, 0.05)),
    min_size=1,
    max_size=5,
)


@given(designs)
def test_values_are_those_of_a_sweep_bit_for_bit(rows: list[tuple[float, float, float]]) -> None:
    results = cs.Evaluator(DRIVE, INPUTS, OUTPUTS)
    frame = pl.DataFrame(rows, schema=dict.fromkeys(INPUTS, pl.Float64), orient="row")
    table = cs.sweep(cs.Space.table(DRIVE, frame), model="components")
    expected = table.select(pl.col(OUTPUTS).cast(pl.Float64).fill_null(np.nan)).to_numpy()
    np.testing.assert_array_equal(results(rows), expected)
    assert results.status(rows) == table["status"].to_list()
    for row, values in zip(rows, expected, strict=True):
        np.testing.assert_array_equal(results(row), values)


def test_one_result_alone_has_no_dimension_of_its_own() -> None:
    web = cs.Evaluator(DRIVE, ["eccentricity_mm"], "hole_web_mm")
    assert web([0.62]) == DRIVE.evaluate()["hole_web_mm"]
    assert isinstance(web([0.62]), float)
    assert web(np.array([[0.62], [0.7]])).shape == (2,)
    assert web.status([0.62]) == "ok"


def test_the_drive_of_a_design_has_whole_pins() -> None:
    results = cs.Evaluator(DRIVE, ["output_pin_count", "eccentricity_mm"], ["hole_web_mm"])
    found = results.drive_at(np.array([9.0, 0.6]))
    assert (found.output_pin_count, found.eccentricity_mm) == (9, 0.6)
    assert results([9, 0.6])[0] == found.evaluate()["hole_web_mm"]


def test_an_evaluator_survives_pickling_after_use() -> None:
    results = cs.Evaluator(DRIVE, INPUTS, OUTPUTS, solver="full", loads_tn=[1.0, 2.0])
    there = results([0.62, 8, 0.01])
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(results))([0.62, 8, 0.01]), there)
    assert repr(results).startswith("<Evaluator of reference-87: ring_contact")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ((DRIVE, ["ecentricity_mm"], "hole_web_mm"), r"did you mean eccentricity_mm\?"),
        ((DRIVE, ["eccentricity_mm"], "hole_wb_mm"), r"did you mean hole_web_mm\?"),
        ((DRIVE, ["criterion"], "hole_web_mm"), "criterion: found as an input"),
        ((DRIVE, [], "hole_web_mm"), r"inputs: found \[\], expected a list of names"),
        ((DRIVE, ["eccentricity_mm"], []), "outputs: found"),
        ((DRIVE, "eccentricity_mm", "hole_web_mm"), "inputs: found 'ecc"),
        ((DRIVE, ["eccentricity_mm"] * 2, "hole_web_mm"), "each name once"),
        ((5, ["eccentricity_mm"], "hole_web_mm"), "drive: found 5"),
        ((DRIVE, ["eccentricity_mm"], "solver_status"), "no result"),
    ],
)
def test_wrong_arguments_are_one_line(arguments: Any, line: str) -> None:
    with pytest.raises(cs.InputError, match=line):
        cs.Evaluator(*arguments)


@pytest.mark.parametrize("x", [0.62, [0.62, 8], [[[0.62]]], ["a"], None, [], [[]], [[0.6], [1, 2]]])
def test_wrong_designs_are_one_line(x: Any) -> None:
    web = cs.Evaluator(DRIVE, ["eccentricity_mm"], "hole_web_mm")
    with pytest.raises(cs.InputError, match="x: found"):
        web(x)


def test_several_designs_are_no_drive() -> None:
    web = cs.Evaluator(DRIVE, ["eccentricity_mm"], "hole_web_mm")
    with pytest.raises(cs.InputError, match="2 designs, expected one"):
        web.drive_at([[0.6], [0.7]])


def test_no_designs_are_said_to_be_none() -> None:
    web = cs.Evaluator(cs.Drive.reference_87(), ["eccentricity_mm"], "hole_web_mm")
    with pytest.raises(
        cs.InputError, match=r"x: found no designs, shape \(0, 1\), expected at least"
    ):
        web(np.empty((0, 1)))
