"""Independent rig, sealed answers, scoring and opponents: the proof of the diagnosis."""

from __future__ import annotations

from cyclosweep.challenge.aliens import ALIASES, ALIENS
from cyclosweep.challenge.case import Case, make_case
from cyclosweep.challenge.concealment import ConcealmentError
from cyclosweep.challenge.noise import NOISES
from cyclosweep.challenge.oracle import oracle_power
from cyclosweep.challenge.programme import PROGRAMMES
from cyclosweep.challenge.specimen import VOCABULARY

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
