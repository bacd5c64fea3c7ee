"""Figures of a campaign beside their targets: loud and foreign recordings, noise, few readings."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from cyclosweep_challenge.campaign.result import Result
from cyclosweep_challenge.scoring.criteria import all_criteria
from cyclosweep_challenge.scoring.criterion import Criterion, criterion
from cyclosweep_challenge.scoring.curves import detection_curves
from cyclosweep_challenge.scoring.intervals import Estimate, bootstrapped, share_of
from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.trial.oracle import oracle_d, oracle_power

FAINT = ("null", "open", "concealed")
"""Parts on which the figures of the first records are counted again."""
LOUD = ("loud", "loud-single", "foreign-loud")
"""Parts of tier C8."""
FOREIGN = ((10.0, 0.85), (20.0, 0.92), (60.0, 0.95))
"""Visibility of single foreign effects, and the share to be named right [-]."""
CORRELATIONS = (0.9, 0.95, 0.97, 0.99)
"""Autocorrelations of the noise [-]."""
LOUD_D = 100.0
"""Visibility from which a cause counts as loud [-]."""
LEVEL = 0.01
"""False alarms at which the test that knows the effect stands [-]."""
FALSE_ALARMS = 0.02
"""Share of false alarms below which the upper bound has to lie [-]."""


def _of(results: Sequence[Result], *parts: str) -> list[Result]:
    """Results of some parts."""
    return [result for result in results if result.part in parts]


def _share(results: Sequence[Result], holds: Callable[[Result], bool]) -> Estimate:
    """Share of results for which something holds."""
    return share_of([holds(result) for result in results])


def new_figures(results: Sequence[Result]) -> list[Criterion]:
    """Figures whose targets came with loud recordings and foreign laws.

    Parameters
    ----------
    results : sequence of Result
        Everything that is diagnosed.
    """
    return [
        *_loud(results),
        *_unseen(results),
        *_foreign(results),
        *_unknown(results),
        *_correlated(results),
        *_noisy_torque(results),
        *_few(results),
    ]


def _loud(results: Sequence[Result]) -> list[Criterion]:
    """What is named of loud recordings."""
    loud = _of(results, *LOUD)
    own = [r for r in loud if r.friction_family == "library"]
    other = [r for r in loud if r.friction_family == "other"]
    rows = [
        criterion(
            "C8: dominant effect named",
            _share(loud, lambda r: r.dominant_named),
            at_least=0.98,
        ),
        criterion(
            "C8, friction of the library's family: every effect above a hundredth named, "
            "nothing false",
            _share(own, lambda r: r.all_visible_named),
            at_least=0.90,
        ),
        criterion(
            "C8, friction of another family: dominant effect and those beyond its model error "
            "named, nothing false",
            _share(other, lambda r: r.all_beyond_model_error_named),
            at_least=0.95,
        ),
    ]
    for part in LOUD:
        there = _of(loud, part)
        rows += [
            criterion(
                f"C8, {part}: dominant effect named", _share(there, lambda r: r.dominant_named)
            ),
            criterion(f"C8, {part}: a false name", _share(there, lambda r: r.false_name)),
            criterion(f"C8, {part}: exactly the true set", _share(there, lambda r: r.right)),
        ]
    rows.append(
        criterion(
            "C8, dominant effect that is no friction: it and those beyond its model error named, "
            "nothing false",
            _share(
                [r for r in loud if not r.friction_family],
                lambda r: r.all_beyond_model_error_named,
            ),
        )
    )
    return rows


def _unseen(results: Sequence[Result]) -> list[Criterion]:
    """What repaired models remove of the mismatch on programmes they have not seen."""
    rows = []
    for words, parts, target in (
        ("C8", LOUD, 0.95),
        *((f"C8, {part}", (part,), None) for part in LOUD),
        ("foreign single effects", ("foreign",), None),
    ):
        there = [r.unseen for r in _of(results, *parts) if math.isfinite(r.unseen.relative)]
        start = f"{words}: mismatch removed on an unseen programme over what the own law removes"
        rows += [
            criterion(
                f"{start}, median",
                bootstrapped([u.relative for u in there], "median"),
                at_least=target,
            ),
            criterion(
                f"{start}, share of recordings above 0.95",
                share_of([u.relative >= 0.95 for u in there]),
            ),
            criterion(
                f"{start}, median, readings on the wrong side of the play counted",
                bootstrapped([u.relative_everywhere for u in there], "median"),
            ),
            criterion(
                f"{words}: forecast worse than that of the calibrated model",
                share_of([u.error_ratio > 1.02 for u in there]),
            ),
        ]
    return rows


def _foreign(results: Sequence[Result]) -> list[Criterion]:
    """Single effects of foreign laws: exactly the true name, IDENTIFIED or MOSTLY_EXPLAINED."""
    rows = []
    for d, target in FOREIGN:
        there = [
            r
            for r in _of(results, "foreign")
            if len(r.causes) == 1 and abs(r.causes[0].d / d - 1.0) < 0.05
        ]
        rows += [
            criterion(
                f"foreign laws, d = {d:g}, rich: named right",
                _share(there, lambda r: r.right),
                at_least=target,
            ),
            criterion(
                f"foreign laws, d = {d:g}, rich: a false name",
                _share(there, lambda r: r.false_name),
            ),
            criterion(
                f"foreign laws, d = {d:g}, rich: found", _share(there, lambda r: r.outcome.alarm)
            ),
        ]
    return rows


def _unknown(results: Sequence[Result]) -> list[Criterion]:
    """Causes whose entry is deleted, and causes on nobody's list."""
    deleted = _of(results, "deleted") + [r for r in results if r.outcome.tier == "C5-removed"]
    faint = [r for r in deleted if (r.dominant.d if r.dominant else 0.0) < LOUD_D]
    loud = [r for r in deleted if r not in faint]
    strangers = _of(results, "strangers")
    rows = [
        criterion(
            "cause deleted from the library: false name",
            _share(deleted, lambda r: r.false_name),
            at_most=0.10,
        ),
        criterion(
            "cause deleted from the library: a name of another class of behaviour",
            _share(deleted, lambda r: r.false_class),
        ),
    ]
    for words, there in (
        ("first generator, faint", [r for r in faint if r.part == "concealed"]),
        ("second generator, faint", [r for r in faint if r.part == "deleted"]),
        ("second generator, loud", loud),
    ):
        rows += [
            criterion(f"deleted, {words}: false name", _share(there, lambda r: r.false_name)),
            criterion(
                f"deleted, {words}: recognised", _share(there, lambda r: r.outcome.recognised)
            ),
        ]
    for words, there in (
        ("faint", [r for r in strangers if r.alien_d < LOUD_D]),
        ("loud", [r for r in strangers if r.alien_d >= LOUD_D]),
    ):
        rows += [
            criterion(
                f"stranger of the second generator, {words}: recognised",
                _share(there, lambda r: r.outcome.recognised),
                at_least=0.90,
            ),
            criterion(
                f"stranger of the second generator, {words}: false name",
                _share(there, lambda r: r.false_name),
                at_most=0.05,
            ),
        ]
    return rows


def _correlated(results: Sequence[Result]) -> list[Criterion]:
    """False alarms and power under noise of high autocorrelation."""
    nulls = _of(results, "correlated-null", "foreign-correlated-null")
    rows = [
        criterion(
            "nothing missing, autocorrelation 0.9 to 0.99: false alarms",
            _share(nulls, lambda r: r.outcome.alarm),
            at_most=FALSE_ALARMS,
            by_upper_bound=True,
        ),
        criterion(
            "nothing missing, ten families of noise together: false alarms",
            _share(_of(results, "null"), lambda r: r.outcome.alarm),
            at_most=FALSE_ALARMS,
            by_upper_bound=True,
        ),
        criterion(
            "nothing missing, second generator, white: false alarms",
            _share(_of(results, "foreign-null"), lambda r: r.outcome.alarm),
        ),
    ]
    single = _of(results, "correlated", "foreign-correlated")
    for rho in CORRELATIONS:
        family = f"ar{rho:g}"
        rows.append(
            criterion(
                f"nothing missing, autocorrelation {rho:g}: false alarms",
                _share([r for r in nulls if r.outcome.noise == family], lambda r: r.outcome.alarm),
            )
        )
        for words, part in (("first", "correlated"), ("second", "foreign-correlated")):
            there = [r for r in single if (r.part, r.outcome.noise) == (part, family)]
            rows.append(
                criterion(
                    f"d = 20, autocorrelation {rho:g}, {words} generator: power over that of the "
                    "test that knows the effect",
                    _over_knowing(there),
                    at_least=0.8 if rho == 0.97 else None,
                )
            )
        there = [r for r in single if r.outcome.noise == family]
        rows.append(
            criterion(
                f"d = 20, autocorrelation {rho:g}: named right", _share(there, lambda r: r.right)
            )
        )
    return rows


def _noisy_torque(results: Sequence[Result]) -> list[Criterion]:
    """Recordings whose torque reading is noisy, too."""
    single = _of(results, "torque-noise")
    rows = [
        criterion(
            "nothing missing, noise of the torque reading: false alarms",
            _share(_of(results, "torque-noise-null"), lambda r: r.outcome.alarm),
        )
    ]
    for d in (20.0, 60.0):
        there = [r for r in single if r.dominant and abs(r.dominant.d / d - 1.0) < 0.05]
        start = f"foreign laws, d = {d:g}, noise of the torque reading"
        rows += [
            criterion(f"{start}: named right", _share(there, lambda r: r.right)),
            criterion(f"{start}: a false name", _share(there, lambda r: r.false_name)),
        ]
    return rows


def _over_knowing(there: Sequence[Result]) -> Estimate:
    """Share found over that of the test that knows the effect, on the same recordings."""
    found = _share(there, lambda r: r.outcome.alarm)
    bound = oracle_d(0.5, LEVEL)
    knowing = [
        float(abs(r.outcome.oracle_z) > bound)
        if math.isfinite(r.outcome.oracle_z)
        else float(oracle_power(r.outcome.d, LEVEL))
        for r in there
    ]
    if not knowing or sum(knowing) == 0.0:
        return found
    mean = sum(knowing) / len(knowing)
    return Estimate(found.value / mean, found.low / mean, found.high / mean, found.count)


def _few(results: Sequence[Result]) -> list[Criterion]:
    """Recordings of few readings."""
    few = _of(results, "few")
    return [
        criterion(
            "C9: verdict right or INSUFFICIENT_DATA",
            _share(few, lambda r: r.right_or_insufficient),
            at_least=0.95,
        ),
        criterion("C9: false names", _share(few, lambda r: r.false_name), at_most=0.02),
        criterion(
            "C9: INSUFFICIENT_DATA", _share(few, lambda r: r.outcome.verdict == "INSUFFICIENT_DATA")
        ),
    ]


def faint_figures(results: Sequence[Result]) -> list[Criterion]:
    """Figures of the first records, counted again on faint recordings of the first generator."""
    outcomes: list[Outcome] = [r.outcome for r in _of(results, *FAINT)]
    return all_criteria(outcomes, detection_curves(outcomes))
