"""What a campaign is made of: the parts of both generators, and how many recordings of each."""

from __future__ import annotations

from dataclasses import replace

from cyclosweep_challenge.campaign.item import Foreign, Part
from cyclosweep_challenge.trial.plan import concealed, in_the_open, nothing_missing
from cyclosweep_challenge.trial.tiers import Stratum

STEPS = 10
"""Steps in which all parts grow together, so that a part of a campaign is a balanced sample."""
TINY = 0.02
"""Scale of a trial run: at least one recording of every part."""
CORRELATED = ("ar0.9", "ar0.95", "ar0.97", "ar0.99")
"""Noise so correlated that error of the model looks like it."""
FOREIGN_CORRELATED = (0.9, 0.95, 0.97, 0.99)
"""The same for the second generator [-]."""
TORQUE_NOISE = (1.0, 3.0)
"""Noise of the torque reading over that of the angle reading, as elastic twist [-]."""
LOUD_FRICTION = (
    (300.0,),
    (1000.0,),
    (3000.0,),
    (300.0, 60.0),
    (1000.0, 100.0),
    (1000.0, 30.0),
    (3000.0, 300.0, 100.0),
    (1000.0, 200.0, 100.0, 50.0),
)
"""Signal-to-noise of loud friction and of what acts beside it [-]."""


def _first() -> list[Part]:
    """Parts of the first generator, whose laws the library nearly holds."""
    return [
        Part(
            "null",
            "nothing missing, ten families of noise and nuisance",
            "all families together: one alarm in 320 bounds the share below 1.8 %, two below 2.3; "
            "a single family of 32 decides nothing",
            320,
            0,
            tuple(nothing_missing()),
            predicted=False,
            opponents=40,
        ),
        Part(
            "correlated-null",
            "nothing missing, autocorrelation 0.9 to 0.99",
            "with the second generator's 120: two alarms in 360 still bound the share below 2 %",
            240,
            1,
            tuple(
                Stratum("C6", programme, noise, (), weight)
                for noise in CORRELATED
                for programme, weight in (("rich", 3), ("poor", 1))
            ),
            predicted=False,
        ),
        Part(
            "correlated",
            "single effects of d = 20, autocorrelation 0.9 to 0.99, rich programme",
            "power to about 0.15 at each autocorrelation",
            104,
            2,
            tuple(Stratum("C0", "rich", noise, (20.0,), 1) for noise in CORRELATED),
        ),
        Part(
            "open",
            "single effects in the open, d = 3 to 20, rich and poor programmes",
            "shares to about 0.1 at each d on rich, 0.25 on poor programmes",
            390,
            3,
            tuple(replace(s, weight=4 if s.programme == "rich" else 1) for s in in_the_open()),
            opponents=60,
        ),
        Part(
            "concealed",
            "the tiers C1 to C5 and C7",
            "shares to about 0.2",
            138,
            4,
            tuple(concealed()),
        ),
        Part(
            "loud",
            "C8: friction of the library's family at d = 300 to 3,000, up to three effects on it",
            "with all loud recordings: a share of 0.98 to about 0.04; one of 0.90 to about 0.1",
            48,
            5,
            tuple(Stratum("C8", "rich", "white", d, 1) for d in LOUD_FRICTION),
        ),
        Part(
            "loud-single",
            "C8: one effect of any kind at d = 300 or 1,000",
            "a share of 0.98 to about 0.08",
            39,
            6,
            tuple(Stratum("C8-single", "rich", "white", (d,), 1) for d in (300.0, 1000.0)),
        ),
    ]


def _second() -> list[Part]:
    """Parts of the second generator, whose laws are not the library's."""
    return [
        Part(
            "foreign",
            "single effects of foreign laws, d = 10, 20 and 60, rich programme",
            "a share of 0.9 to about 0.1 at each d",
            150,
            10,
            (Foreign("single", rich=True),),
            opponents=30,
        ),
        Part(
            "foreign-loud",
            "C8: d = 100 to 3,000, one to four effects; half of it friction of another family",
            "shares to about 0.08, of friction of another family to about 0.13",
            80,
            11,
            (Foreign("C8"),),
        ),
        Part(
            "few",
            "C9: a dozen to sixty readings on a dial of half a degree",
            "a share of 0.95 to about 0.06; that false names lie below 0.02 not even with none",
            80,
            12,
            (Foreign("C9"),),
            predicted=False,
        ),
        Part(
            "strangers",
            "causes on nobody's list, faint and loud",
            "a share of 0.9 to about 0.15 each",
            50,
            13,
            (Foreign("stranger"),),
        ),
        Part(
            "deleted",
            "the cause is taken out of the library, faint (d = 15 to 30) and loud (150 to 1,000)",
            "a share of 0.1 to about 0.1 each",
            90,
            14,
            (Foreign("deleted"),),
        ),
        Part(
            "foreign-null",
            "nothing missing, white noise, rich and poor programmes and weights by hand",
            "whether alarms lie below 2 % only together with the part of autocorrelated noise",
            80,
            15,
            (Foreign("nothing", autocorrelation=0.0),),
            predicted=False,
            opponents=20,
        ),
        Part(
            "foreign-correlated-null",
            "nothing missing, autocorrelation 0.9 to 0.99, rich and poor programmes",
            "with the first generator's 240: as there",
            120,
            16,
            tuple(Foreign("nothing", rho) for rho in FOREIGN_CORRELATED),
            predicted=False,
        ),
        Part(
            "foreign-correlated",
            "single effects of foreign laws at d = 20, autocorrelation 0.9 to 0.99, rich programme",
            "power to about 0.18 at each autocorrelation",
            80,
            17,
            tuple(Foreign("single", rho, 20.0, rich=True) for rho in FOREIGN_CORRELATED),
        ),
        Part(
            "torque-noise-null",
            "nothing missing, the torque reading as noisy as that of the angle or three times so, "
            "noise of the angle white or of autocorrelation 0.9",
            "no alarm in 80 bounds the share below 4.6 %",
            80,
            18,
            tuple(
                Foreign("nothing", rho, torque_noise=noise)
                for rho in (0.0, 0.9)
                for noise in TORQUE_NOISE
            ),
            predicted=False,
        ),
        Part(
            "torque-noise",
            "single effects of foreign laws at d = 20 and 60, the torque reading as noisy as that "
            "of the angle or three times so, rich programme",
            "a share of 0.9 to about 0.15 at each d",
            60,
            19,
            tuple(
                Foreign("single", d=d, rich=True, torque_noise=noise)
                for d in (20.0, 60.0)
                for noise in TORQUE_NOISE
            ),
        ),
    ]


def parts(scale: float = 1.0) -> list[Part]:
    """Parts of a campaign in the order in which a step runs through them.

    Parameters
    ----------
    scale : float
        Factor on the number of recordings of every part, of which each keeps at least one [-].
    """
    return [
        replace(
            part,
            cases=max(1, round(scale * part.cases)),
            opponents=round(scale * part.opponents),
        )
        for part in (*_first(), *_second())
    ]
