"""The proof of the diagnosis: independent rig, committed answers, scoring and opponents."""

from __future__ import annotations

from cyclosweep_challenge.rig.aliens import ALIASES, ALIENS
from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.rig.programme import PROGRAMMES
from cyclosweep_challenge.rig.specimen import VOCABULARY
from cyclosweep_challenge.trial.case import Case, make_case
from cyclosweep_challenge.trial.concealment import ConcealmentError
from cyclosweep_challenge.trial.oracle import oracle_power

__all__ = [
    "ALIASES",
    "ALIENS",
    "NOISES",
    "PROGRAMMES",
    "VOCABULARY",
    "Case",
    "ConcealmentError",
    "make_case",
    "oracle_power",
]
