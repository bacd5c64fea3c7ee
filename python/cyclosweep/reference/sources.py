"""Where the numbers come from that the package is compared with, as far as it is known."""

from __future__ import annotations

__all__ = [
    "CYCLOIDGEN",
    "HUTCHINSON",
    "KROL",
    "KROL_FORMULA",
    "KUMAR",
    "MCIVER",
    "PROTOTYPE",
    "PUBLISHED",
    "RATIO_29",
    "SINE_LIMIT",
    "TEXTBOOK",
    "THOMSON",
    "TORSION",
    "TRAIN",
    "UNIT_CASE",
    "WANG",
]

KUMAR = "Kumar, Kosse and Oloyede, Mech. Mach. Theory 105 (2016) 185-198"
MCIVER = f"McIver, as cited in section 5 of {KUMAR}"
KROL = "Krol et al. 2019, doi 10.1007/978-3-030-20131-9_103"
WANG = "Wang et al., Mech. Mach. Theory 102 (2016) 135-148"
THOMSON = "Thomson, Theory of Vibration, Table 12.4-1"
HUTCHINSON = "J. R. Hutchinson, J. Appl. Mech. 68 (2001) 87-92"
PUBLISHED = (KUMAR, MCIVER, KROL, WANG, THOMSON, HUTCHINSON)
"""Publications in which a number can be looked up: what a row of evidence comes from."""

PROTOTYPE = (
    "a prototype of this project, published nowhere; SciPy agreed to 3e-10 on a residual written "
    "anew in the housing's frame"
)
SINE_LIMIT = "a prototype of this project, published nowhere"
TORSION = (
    "solved numerically by this project, published nowhere; solved again by "
    "tests/validation/test_torsion_problems.py"
)
TRAIN = "a prototype of this project, published nowhere; SciPy's DOP853 agreed to 1.2e-9"
CYCLOIDGEN = "run of cycloidgen 8.0.0, a program on PyPI; the numbers are published nowhere"
KROL_FORMULA = f"worked out for a design of {KROL}; not noted as printed there"
UNIT_CASE = "another program, not named in the notes of this project, which work it out again"
RATIO_29 = "noted as printed; the source is not named in the notes of this project"
TEXTBOOK = "answer of a textbook that is not named in the notes of this project"
