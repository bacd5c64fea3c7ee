"""A friction that stood in for what was found after it is left out of the structure."""

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.worth import without_unseen_friction
from cyclosweep.simulation.effects import find
from tests.support.long_recording import friction
from tests.support.searches import search_of
from tests.unit.test_one_class import CREEP, fitted


def rubbing() -> Term:
    """Friction as the recordings here have it."""
    return Term(find("friction_hysteresis"), friction().shape, None, 0.1)


def test_a_friction_is_left_out_only_where_the_other_effects_fit_as_well_alone() -> None:
    terms = [rubbing(), Term(find("creep"), dict(CREEP.shape))]
    without, beside = search_of(CREEP), search_of(friction(0.3), CREEP)
    found = fitted(without, terms)
    assert without_unseen_friction(without, found).names == {"creep"}
    both = fitted(beside, terms)
    assert without_unseen_friction(beside, both) is both


def test_friction_alone_is_kept_however_faint() -> None:
    search = search_of(CREEP)
    alone = fitted(search, [rubbing()])
    assert without_unseen_friction(search, alone) is alone
