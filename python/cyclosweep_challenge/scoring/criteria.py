"""The criteria of a score, each with its value, interval, target and whether it is met."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.scoring.calibration import (
    calibration_error,
    chance_error,
    stated_and_true,
)
from cyclosweep_challenge.scoring.criterion import Criterion, criterion
from cyclosweep_challenge.scoring.curves import DETECTED, KNOWING, Curve, needed_by
from cyclosweep_challenge.scoring.intervals import NOTHING, Estimate, bootstrapped, share_of
from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.scoring.power import LEVEL, PROGRAMMES, relative_to_oracle

Chosen = Sequence[Outcome]


def false_alarms(outcomes: Chosen) -> list[Criterion]:
    """Count false alarms by noise family, and how often nothing missing is said so."""
    nulls = [o for o in outcomes if o.tier == "C6"]
    criteria = [
        criterion(
            f"false alarms, {family}",
            share_of([o.alarm for o in nulls if o.noise == family]),
            at_most=0.02,
            must=0.02,
            by_upper_bound=True,
        )
        for family in NOISES
    ]
    plain = [o for o in nulls if o.programme == "rich" and o.noise == "white"]
    alarmed = share_of([o.verdict == "NOTHING_MISSING" for o in plain])
    criteria.append(criterion("nothing missing said so, rich, white", alarmed, at_least=0.90))
    return criteria


def power(curves: Sequence[Curve]) -> list[Criterion]:
    """Visibility for nine detections in ten under white noise, beside the knowing test's."""
    criteria = []
    for programme in PROGRAMMES:
        needed = needed_by(curves, DETECTED, programme, "white")
        target = 1.30 if programme == "rich" else None
        criteria += [
            criterion(f"d for 90 % power, {programme}", needed),
            criterion(
                f"the same of the test that knows the effect, {programme}",
                needed_by(curves, KNOWING, programme, "white"),
            ),
            criterion(
                f"d for 90 % power over the knowing test's, {programme}",
                relative_to_oracle(needed, LEVEL),
                at_most=target,
            ),
        ]
    return criteria


def naming(outcomes: Chosen) -> list[Criterion]:
    """Single effects named right, and explanation sets."""
    targets: dict[str, dict[float, tuple[float, float | None]]] = {
        "rich": {6.0: (0.92, None), 10.0: (0.98, 0.90), 20.0: (0.99, 0.90)},
        "poor": {6.0: (0.80, None), 10.0: (0.90, None), 20.0: (0.95, None)},
    }
    criteria = []
    for programme, rows in targets.items():
        for d, (target, must) in rows.items():
            there = [
                o
                for o in outcomes
                if o.tier == "C0" and o.programme == programme and abs(o.d / d - 1.0) < 0.02
            ]
            criteria.append(
                criterion(
                    f"named right, single effect, d = {d:g}, {programme}",
                    share_of([o.named_right for o in there]),
                    at_least=target,
                    must=must,
                )
            )
            criteria.append(
                criterion(
                    f"the same if only the nearest rival were in doubt, d = {d:g}, {programme}",
                    bootstrapped([o.naming_bound for o in there]),
                )
            )
    for programme, size in (("rich", 1.3), ("poor", 1.8)):
        single = [o for o in outcomes if o.tier in {"C0", "C1", "C2"} and o.programme == programme]
        # An alarm that explains nothing does not cover the truth.
        alarmed = [o for o in single if o.alarm]
        criteria += [
            criterion(
                f"explanation set covers the truth, {programme}",
                share_of([o.covered for o in alarmed]),
                at_least=0.95,
            ),
            criterion(
                f"mean size of the explanation set, {programme}",
                bootstrapped([len(o.explanations) for o in alarmed if o.explanations]),
                at_most=size,
            ),
        ]
    ten = [o for o in outcomes if o.tier == "C3"]
    criteria.append(
        criterion(
            "two effects ten to one, both right, rich",
            share_of([o.named_right for o in ten]),
            at_least=0.80,
            must=0.70,
        )
    )
    for tier in ("C1", "C2", "C4"):
        there = [o for o in outcomes if o.tier == tier]
        criteria.append(criterion(f"named right, {tier}", share_of([o.named_right for o in there])))
    return criteria


def sizes(outcomes: Chosen) -> list[Criterion]:
    """Amplitude errors against their bound, interval coverage, calibration parameters' bias."""
    named = [s for o in outcomes if o.named_right and len(o.causes) == 1 for s in o.sizes]
    large = [s for s in named if s.d >= 9.9]
    error = [s.error for s in large]
    stated = [s for s in named if math.isfinite(s.low_deg)]
    covered = [(s.d >= 9.9, s.low_deg <= s.true_deg <= s.high_deg) for s in stated]
    criteria = [
        criterion(
            "amplitude error over the Cramer-Rao bound, d at least 10",
            bootstrapped(error, "rms"),
            at_most=1.10,
        ),
        criterion(
            "95 % interval of the size covers it, d at least 10",
            share_of([holds for visible, holds in covered if visible]),
            within=(0.93, 0.97),
        ),
        criterion(
            "the same at every d, of those found and named right",
            share_of([holds for _, holds in covered]),
        ),
    ]
    right = [o for o in outcomes if o.named_right]
    straight = [o for o in right if not SLOPES & set(o.causes)]
    for name in sorted({key for o in right for key in o.pulls}):
        pulls = [o.pulls[name] for o in right if name in o.pulls]
        bias = bootstrapped(pulls)
        criteria.append(
            criterion(
                f"bias of {name} after the repair, in standard errors",
                Estimate(abs(bias.value), *_folded(bias), bias.count),
                at_most=0.5,
            )
        )
        for words, there in (("median", right), ("median, effects that are no slope", straight)):
            middle = bootstrapped([o.pulls[name] for o in there if name in o.pulls], "median")
            criteria.append(
                criterion(
                    f"the same, {words}: {name}",
                    Estimate(abs(middle.value), *_folded(middle), middle.count),
                )
            )
    return criteria


SLOPES = frozenset(
    {
        "contact_stiffening",
        "clearance_takeup",
        "overload_softening",
        "phase_dependent_compliance",
    }
)
"""Effects that are a compliance themselves: how much of it is the baseline's is a convention."""


def _folded(estimate: Estimate) -> tuple[float, float]:
    """Bounds of the magnitude of a signed estimate."""
    low, high = sorted((abs(estimate.low), abs(estimate.high)))
    return (0.0 if estimate.low < 0.0 < estimate.high else low), high


def prediction(outcomes: Chosen) -> list[Criterion]:
    """Held-out error over the true model's, where the effect was named."""
    there = [o.held_out for o in outcomes if o.named_right and math.isfinite(o.held_out.known)]
    fitted, known = [h.fitted for h in there], [h.known for h in there]
    return [
        criterion(
            "held-out error over the fitted true model's, mean",
            bootstrapped(fitted),
            at_most=1.02,
            must=1.05,
        ),
        criterion(
            "held-out error over the fitted true model's, median", bootstrapped(fitted, "median")
        ),
        criterion(
            "held-out error over the true model's at its true parameters", bootstrapped(known)
        ),
        criterion("the same, median", bootstrapped(known, "median")),
        criterion("the same, 95 of 100 within", bootstrapped(known, "late")),
    ]


def unknown(outcomes: Chosen) -> list[Criterion]:
    """Causes off the list, deleted members and exact aliases."""
    criteria = []
    for tier, words, must in (
        ("C5-alien", "cause on nobody's list", (0.80, 0.10)),
        ("C5-removed", "effect taken out of the library", (0.60, None)),
    ):
        there = [o for o in outcomes if o.tier == tier]
        criteria += [
            criterion(
                f"{words}: recognised",
                share_of([o.recognised for o in there]),
                at_least=0.90,
                must=must[0],
            ),
            criterion(
                f"{words}: given a false name",
                share_of([bool(o.false_names) for o in there]),
                at_most=0.05,
                must=must[1],
            ),
        ]
    # That exact aliases are called untestable is no figure: a diagnosis lists them unconditionally.
    aliased = [o for o in outcomes if o.tier == "C7"]
    criteria.append(criterion("alarms on exact aliases", share_of([o.alarm for o in aliased])))
    return criteria


def probabilities(outcomes: Chosen) -> list[Criterion]:
    """Calibration of the stated probabilities of explanations."""
    there = [o for o in outcomes if o.tier in {"C0", "C1", "C2", "C3", "C4"}]
    stated, _ = stated_and_true(there)
    if not stated:
        return _calibrated(NOTHING, NOTHING)
    rng = np.random.default_rng(99)
    drawn = [
        calibration_error([there[k] for k in rng.integers(0, len(there), len(there))])
        for _ in range(200)
    ]
    low, high = np.nanquantile(drawn, [0.025, 0.975])
    estimate = Estimate(calibration_error(there), float(low), float(high), len(stated))
    return _calibrated(estimate, chance_error(there))


def _calibrated(error: Estimate, by_chance: Estimate) -> list[Criterion]:
    """Calibration error, and what exact probabilities would show."""
    return [
        criterion(
            "calibration error of stated probabilities", error, at_most=0.03, comparable=False
        ),
        criterion("the same if every stated probability were exact", by_chance, comparable=False),
    ]


def timing(
    verdict_s: Sequence[float], whole_s: Sequence[float], agree: Sequence[bool]
) -> list[Criterion]:
    """Time of the verdict alone and of the whole report, and whether both say the same."""

    def late(values: Sequence[float]) -> Estimate:
        return bootstrapped(values, "late")

    return [
        criterion(
            "time of the verdict alone, s, median",
            bootstrapped(verdict_s, "median"),
            comparable=False,
        ),
        criterion(
            "time of the verdict alone, s, 95 of 100 within",
            late(verdict_s),
            at_most=5.0,
            comparable=False,
        ),
        criterion(
            "time of the whole report, s, median", bootstrapped(whole_s, "median"), comparable=False
        ),
        criterion(
            "time of the whole report, s, 95 of 100 within",
            late(whole_s),
            at_most=10.0,
            comparable=False,
        ),
        criterion("verdict alone says what the whole report says", share_of(agree), at_least=1.0),
    ]


def effort(outcomes: Chosen) -> list[Criterion]:
    """Time of a diagnosis, and how many gave no answer."""
    return [
        criterion(
            "time of a diagnosis as run here, s, median",
            bootstrapped([o.elapsed_s for o in outcomes], "median"),
            at_most=10.0,
            comparable=False,
        ),
        criterion("no answer at all", share_of([bool(o.failure) for o in outcomes]), at_most=0.0),
    ]


def all_criteria(outcomes: Chosen, curves: Sequence[Curve]) -> list[Criterion]:
    """Every line of the table, none left out."""
    parts = (naming, sizes, prediction, unknown, probabilities, effort)
    return [
        *false_alarms(outcomes),
        *power(curves),
        *(one for part in parts for one in part(outcomes)),
    ]
