"""The score of a challenge, to be shown or stored."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import polars as pl

from cyclosweep_challenge.scoring.calibration import Bin, calibration_bins
from cyclosweep_challenge.scoring.comparison import contest
from cyclosweep_challenge.scoring.confusion import confusion
from cyclosweep_challenge.scoring.criteria import all_criteria
from cyclosweep_challenge.scoring.criterion import Criterion
from cyclosweep_challenge.scoring.curves import Curve, detection_curves
from cyclosweep_challenge.scoring.opponents import OpponentCurve, opponent_curves
from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.scoring.power import PROGRAMMES


@dataclass(frozen=True)
class Score:
    """Result of a challenge.

    Attributes
    ----------
    about : dict
        Seed, mix, root hash and number of cases.
    criteria : list of Criterion
        What was wanted and reached, none left out; under ``figures`` in JSON.
    curves : list of Curve
        Detection, naming and the oracle's detection against visibility.
    opponents : list of OpponentCurve
        The opponents' detection at their own false-alarm settings.
    confusion : dict of polars.DataFrame
        Confusion matrix by programme.
    calibration : list of Bin
        Stated probabilities against frequencies.
    verdicts : polars.DataFrame
        Verdicts counted by stratum.
    """

    about: dict[str, Any]
    criteria: list[Criterion]
    curves: list[Curve]
    opponents: list[OpponentCurve]
    confusion: dict[str, pl.DataFrame]
    calibration: list[Bin]
    verdicts: pl.DataFrame

    def as_dict(self) -> dict[str, Any]:
        """Return plain data that JSON can hold; not-a-number becomes null."""
        plain = {
            "schema": "cyclosweep.challenge/2",
            "about": self.about,
            "figures": [one.as_dict() for one in self.criteria],
            "curves": [
                {
                    "who": curve.who,
                    "programme": curve.programme,
                    "noise": curve.noise,
                    "needed": vars(curve.needed),
                    "points": [{"d": d, **vars(e)} for d, e in curve.points],
                }
                for curve in self.curves
            ],
            "opponents": [opponent.as_dict() for opponent in self.opponents],
            "confusion": {name: table.to_dicts() for name, table in self.confusion.items()},
            "calibration": [{"stated": b.stated, **vars(b.frequency)} for b in self.calibration],
            "verdicts": self.verdicts.to_dicts(),
        }
        cleaned: dict[str, Any] = as_json(plain)
        return cleaned


def as_json(value: Any) -> Any:
    """Return the same data with not-a-number and infinities as null."""
    if isinstance(value, dict):
        return {key: as_json(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_json(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def make_score(
    outcomes: Sequence[Outcome],
    replies: Mapping[str, Any],
    about: dict[str, Any],
    further: Sequence[Criterion] = (),
    contest_only: Sequence[Outcome] = (),
) -> Score:
    """Score the outcomes of a challenge.

    Parameters
    ----------
    outcomes : sequence of Outcome
        One for every case.
    replies : mapping
        Replies of the opponents, by key of the case and name of the opponent.
    about : dict
        What the challenge was made of.
    further : sequence of Criterion
        Criteria that do not follow from the outcomes.
    contest_only : sequence of Outcome
        Further cases for the contest with the opponents, in no other criterion.
    """
    curves = detection_curves([*outcomes, *contest_only])
    opponents = opponent_curves([*outcomes, *contest_only], replies)
    verdicts = (
        pl.DataFrame(
            {
                "stratum": [o.stratum for o in outcomes],
                "verdict": [o.verdict for o in outcomes],
            },
            schema={"stratum": pl.String, "verdict": pl.String},
        )
        .group_by("stratum", "verdict")
        .len("cases")
        .sort("stratum", "verdict")
    )
    named = [o for o in outcomes if o.tier in {"C0", "C1", "C2", "C5-alien"} and o.d > 9.0]
    return Score(
        about=about | {"cases": len(outcomes)},
        criteria=[*all_criteria(outcomes, curves), *contest(curves, opponents), *further],
        curves=curves,
        opponents=opponents,
        confusion={
            programme: confusion([o for o in named if o.programme == programme])
            for programme in PROGRAMMES
        },
        calibration=calibration_bins(
            [o for o in outcomes if o.tier in {"C0", "C1", "C2", "C3", "C4"}]
        ),
        verdicts=verdicts,
    )
