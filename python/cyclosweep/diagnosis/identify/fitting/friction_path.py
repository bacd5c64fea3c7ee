"""Path of the shaft under the friction terms of a structure."""

from collections.abc import Sequence

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.slip import Friction


def friction_path(terms: Sequence[Term], history: History, mean_deg: Floats) -> History:
    """Path of the shaft with these friction terms, everything else held.

    Parameters
    ----------
    terms : sequence of Term
        All terms of a structure, at least one of them friction; all friction terms share the slip
        elements of the first.
    history : History
        All rows with the calibrated line, and the elastic law and torque of the round before.
    mean_deg : ndarray, shape (n,)
        Modelled twist of all rows in the round before [deg].

    Returns
    -------
    History
        With the new elastic torque [N m] and twist [deg].
    """
    friction = Friction.of(
        (term.effect, term.shape, term.amplitude)
        for term in terms
        if term.effect is not None and term.slips
    )
    law = history.elastic_law
    if law is None:
        twist, points = history.compliance_deg_per_nm * history.elastic_nm, None
    else:
        twist, points = law.twist_at(history.elastic_nm), (law.torque_nm, law.twist_deg)
    offset = mean_deg - history.beyond_deg - twist
    path = friction.solve(history, offset, 0.0, points)
    return history.with_state(
        elastic_nm=history.applied_nm - path.friction_nm,
        angle_deg=path.angle_deg + history.beyond_deg,
        corner_deg=path.corner_deg,
        corner_nm=path.corner_nm,
    )
