"""What both kinds of fitted structure promise the diagnosis."""

import ast
from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.fitting.fit import ContactFit, fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify_effects import identify
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.diagnosis.whole_loop.known_flank import WholeLoopFit
from cyclosweep.simulation import effects
from tests.support.bench_rig import record
from tests.unit.test_forecast import drive as loop_drive
from tests.unit.test_forecast import measured, truth

KINDS = ("contact", "whole loop")


def searched(recording: cs.Recording, drive: cs.Drive) -> Search:
    line = drive.nominal_line(recording.side)
    problem = prepare(recording, line, int(drive.output_pin_count))
    library = build_library(problem.history, problem.fitted, effects.effects())
    return calibrate(problem, library, 0)


@pytest.fixture(scope="module")
def contact() -> FittedStructure:
    """A kink of the elastic line, fitted to rows in contact."""
    recording = record(21, ("overload_softening",), d=25, kind="medium")
    search = searched(recording, cs.Drive.reference_87())
    effect = effects.find("overload_softening")
    term = Term(effect, effect.shapes(search.problem.history)[0])
    return fit(search.problem, search.noise, (term,), search.baseline.fit)


@pytest.fixture(scope="module")
def whole_loop() -> FittedStructure:
    """Friction and soft contacts, fitted to whole loops."""
    search = searched(measured(truth()), loop_drive())
    chosen = identify(search, lambda text: None).chosen
    assert chosen is not None
    return chosen.fit


@pytest.fixture
def structure(kind: str, request: pytest.FixtureRequest) -> FittedStructure:
    found = request.getfixturevalue(kind.replace(" ", "_"))
    assert isinstance(found, ContactFit if kind == "contact" else WholeLoopFit)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_error_is_that_of_the_prediction(structure: FittedStructure, kind: str) -> None:
    problem, predicted = structure.problem, structure.prediction
    rows = problem.fitted if kind == "contact" else problem.whole_fitted
    assert predicted.error_deg == problem.rms_error(predicted.angle_deg, rows)
    baseline = structure.baseline_prediction(fit(problem, structure.noise, ()))
    assert baseline.error_deg == problem.rms_error(baseline.angle_deg, rows)
    assert predicted.error_deg < 0.9 * baseline.error_deg


@pytest.mark.parametrize("kind", KINDS)
def test_model_is_the_structure_that_was_fitted(structure: FittedStructure, kind: str) -> None:
    problem = structure.problem
    model = structure.model("a drive")
    assert model.drive == "a drive"
    assert tuple(value.name for value in model.effects) == structure.names
    rows = problem.fitted if kind == "contact" else problem.whole_fitted
    simulated = cs.simulate(model, problem.recording).angle_deg
    assert simulated is not None
    predicted = structure.prediction.angle_deg
    # A crossing of the dead zone may come a row later in a simulation, and then by the whole play.
    apart = np.abs(simulated - predicted)[rows]
    assert np.quantile(apart, 0.99) < 0.02 * np.ptp(predicted)
    assert np.median(apart) < 0.1 * structure.prediction.error_deg


@pytest.mark.parametrize("kind", KINDS)
def test_standard_errors_are_of_the_line_that_was_fitted(
    structure: FittedStructure, kind: str
) -> None:
    model = structure.model("")
    found = np.array([model.datum_deg, model.compliance_deg_per_nm, model.free_play_deg])
    errors = structure.line_errors
    assert errors.shape == found.shape
    assert np.all((errors > 0) & (errors < 0.5 * np.abs(found)))
    if kind == "whole loop":
        true = truth()
        line = [true.datum_deg, true.compliance_deg_per_nm, true.free_play_deg]
        assert np.all(np.abs(found - line) < 3 * errors)
    zero = structure.torque_zero
    assert (zero is None) == (kind == "contact")
    if zero is not None:
        assert zero.value_nm == model.torque_zero_nm
        assert zero.value_nm == pytest.approx(0.6, abs=max(3 * zero.std_error_nm, 0.1))


@pytest.mark.parametrize("kind", KINDS)
def test_rows_left_out_are_predicted_once_and_never_fitted(
    structure: FittedStructure, kind: str
) -> None:
    problem = structure.problem
    blocks = structure.predict_left_out()
    count = np.sum([block.rows for block in blocks], axis=0)
    left_out = problem.fitted if kind == "contact" else problem.whole_held_out
    np.testing.assert_array_equal(count, left_out.astype(int))
    assert all(block.kept_runs == (kind == "whole loop") for block in blocks)
    assert all((block.known_flank is None) == (kind == "contact") for block in blocks)
    before = [problem.rms_error(block.baseline_deg, block.rows) for block in blocks]
    after = [problem.rms_error(block.structure_deg, block.rows) for block in blocks]
    assert np.mean(after) < 0.9 * np.mean(before)
    evidence = structure.left_out_evidence(blocks, float(np.mean(before)), float(np.mean(after)))
    assert evidence > 100


@pytest.mark.parametrize("kind", KINDS)
def test_share_of_independent_rows(structure: FittedStructure, kind: str) -> None:
    if kind == "contact":
        assert structure.independent_share == 1.0
    else:
        assert 0 < structure.independent_share < 0.2


@pytest.mark.parametrize("kind", KINDS)
def test_moved_parameter_changes_its_own_term(structure: FittedStructure, kind: str) -> None:
    index = next(k for k, term in enumerate(structure.terms) if not term.slips)
    place = structure.amplitude_places(index)[0]
    step = 0.5 * structure.beta[place]
    moved = structure.moved(place, step)
    np.testing.assert_allclose(
        moved.contribution(index), 1.5 * structure.contribution(index), rtol=1e-12
    )
    assert structure.beta[place] == pytest.approx(2 * step)
    assert structure.follows_path(index) is (kind == "whole loop")


def test_nobody_asks_a_structure_for_its_class() -> None:
    folder = Path(str(cs.__file__)).parent / "diagnosis"
    kinds = {"FittedStructure", ContactFit.__name__, WholeLoopFit.__name__}
    asked = []
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in ("isinstance", "type"):
                names = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
                asked += [f"{path.name}:{node.lineno}"] if names & kinds else []
    assert asked == []
