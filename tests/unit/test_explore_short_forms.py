"""The short forms answer as the functions they stand for."""

import pytest

import cyclosweep as cs


@pytest.fixture(scope="module")
def space() -> cs.Space:
    return cs.Space.sobol(
        cs.Drive.reference_87(), 256, eccentricity_mm=(0.4, 0.7), output_pin_diameter_mm=(12, 18)
    )


def test_pareto_is_the_front_of_the_same_objectives(space: cs.Space) -> None:
    short = cs.pareto(
        space, minimise="twist_1tn_deg", maximise=["hole_web_mm"], limits="variant > 7"
    )
    senses = {"twist_1tn_deg": "min", "hole_web_mm": "max"}
    assert short.equals(cs.pareto_front(space, senses, "variant > 7"))
    assert short.height > 1
    with pytest.raises(cs.InputError, match="found neither"):
        cs.pareto(space)


def test_sensitivity_is_that_of_the_same_outputs(space: cs.Space) -> None:
    pytest.importorskip("SALib")
    short = cs.sensitivity(space, outputs=["hole_web_mm"], half_width=0.2)
    assert short.equals(cs.sobol_indices(space, ["hole_web_mm"], half_width=0.2))


def test_tolerances_go_by_keyword_or_mapping() -> None:
    drive = cs.Drive.reference_87()
    by_keyword = cs.Space.around(drive, eccentricity_mm=0.01)
    assert by_keyword == cs.Space.around(drive, {"eccentricity_mm": 0.01})
    with pytest.raises(cs.InputError, match="one of the two"):
        cs.Space.around(drive)
    with pytest.raises(cs.InputError, match="one of the two"):
        cs.Space.around(drive, {"eccentricity_mm": 0.01}, eccentricity_mm=0.02)
