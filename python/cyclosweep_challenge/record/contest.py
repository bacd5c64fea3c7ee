"""Section of a page that compares detection with the opponents': text, tables and charts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from cyclosweep_challenge.board.curves import power_chart, power_series
from cyclosweep_challenge.board.terminal import within_reach
from cyclosweep_challenge.record.markdown import Plain, table, text
from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.scoring.intervals import Estimate
from cyclosweep_challenge.scoring.opponents import OURS
from cyclosweep_challenge.scoring.power import PROGRAMMES

EVERY = "every"
OWN = "own"

_HEAD = """## Detection beside its opponents

Share of recordings with a single effect in which something was found, on identical files. Every
opponent stands at a threshold that one in a hundred recordings with nothing missing exceeds. Which
recordings those are decides the comparison, so it is made more than once. The diagnosis is the
same every time and is not told the noise; it stands as it is, and once more with its own evidence
tuned in the same way. `ahead` is the share found by the diagnosis minus that found by the opponent
over d = 3 to 10, with the uncertainty of the threshold in its interval; `ahead, both at 1 %` the
same with both tuned. An opponent is behind where the whole interval is above zero. In the pictures
the points of one d stand side by side."""

_WHITE = """Effects under white noise, thresholds set on white noise. This is what the opponents'
formulas assume."""

_COLOURED = """Effects under correlated noise (family {noise}), thresholds set on recordings with
that very noise. The thresholds alone are tuned: nobody whitens the noise for the opponents, as the
diagnosis does for itself. Those that cost too much are left out."""

_EVERY = """Effects under white noise, with one threshold for all ten families of noise, each of
which counts the same: what a detector is worth that is set once and used on rigs of any noise. The
worst family decides an opponent's threshold, as the shares below show; against white noise it is
then far stricter than one in a hundred. Opponents that were not shown all families are left out."""


def write_pictures(score: Plain, docs: Path, page: str) -> None:
    """Write the power curves of a page, one picture for every programme and setting."""
    for noise, setting in _settings(score):
        for programme in _programmes(score, noise):
            drawn = _drawn(score, programme, noise, setting)
            (docs / _picture(page, programme, noise, setting)).write_text(drawn)


def contest_section(score: Plain, page: str) -> str:
    """Every comparison that a score holds, with the pictures of this page."""
    parts = [_HEAD]
    for noise, setting in _settings(score):
        if setting == EVERY:
            title, words = "thresholds set over all families of noise", _EVERY
        elif noise == "white":
            title, words = "white noise", _WHITE
        else:
            title, words = f"noise {noise}", _COLOURED.format(noise=noise)
        parts.append(f"### {title[0].upper()}{title[1:]}\n\n{words}")
        for programme in _programmes(score, noise):
            parts.append(
                f"#### {programme.capitalize()} programme, {title}\n\n"
                + _comparison(score, page, programme, noise, setting)
                + _alarms(_rivals(score, programme, noise, setting), setting)
            )
    return "\n\n".join(parts)


def _settings(score: Plain) -> Iterator[tuple[str, str]]:
    """Noise and setting of every comparison."""
    for noise in dict.fromkeys(["white", *(c["noise"] for c in score["curves"])]):
        yield noise, OWN
    if any(_rivals(score, programme, "white", EVERY) for programme in PROGRAMMES):
        yield "white", EVERY


def _programmes(score: Plain, noise: str) -> list[str]:
    """Programmes on which there are effects to be found under this noise."""
    return [p for p in PROGRAMMES if any(c["points"] for c in _curves(score, p, noise))]


def _rivals(score: Plain, programme: str, noise: str, setting: str) -> list[Plain]:
    """Curves of a programme and noise for which this setting exists."""
    return [
        o
        for o in score["opponents"]
        if (o["programme"], o["noise"]) == (programme, noise) and o[setting] is not None
    ]


def _curves(score: Plain, programme: str, noise: str) -> list[Plain]:
    """Curves of the diagnosis and of the test that knows the effect."""
    return [c for c in score["curves"] if (c["programme"], c["noise"]) == (programme, noise)]


def _picture(page: str, programme: str, noise: str, setting: str) -> str:
    """Name of a picture's file."""
    where = "-every-family" if setting == EVERY else "" if noise == "white" else f"-{noise}"
    return f"{page}-power-{programme}{where}.svg"


def _comparison(score: Plain, page: str, programme: str, noise: str, setting: str) -> str:
    """Chart and table of the share that each detector finds."""
    curves = _curves(score, programme, noise)
    levels = sorted({p["d"] for c in curves for p in c["points"]})
    rows: list[Sequence[object]] = []
    for c in curves:
        at = {p["d"]: p for p in c["points"]}
        rows.append((c["who"], "", _needed(c["needed"]), "", "", *(_at(at, d) for d in levels)))
    for o in _rivals(score, programme, noise, setting):
        tuned = o[setting]
        at = {p["d"]: p for p in tuned["power"]}
        rows.append(
            (
                o["who"],
                text(o["default_alarms"], 2),
                _needed(tuned["needed"]),
                text(tuned["ahead"], 2),
                text(tuned["tuned_ahead"], 2),
                *(_at(at, d) for d in levels),
            )
        )
    heads = (
        "who",
        f"false alarms at defaults, {noise}",
        "d for 90 %",
        "ahead",
        "ahead, both at 1 %",
        *(f"d = {d:g}" for d in levels),
    )
    picture = _picture(page, programme, noise, setting)
    return f"![Power against visibility]({picture})\n\n" + table(heads, rows)


def _alarms(rivals: Sequence[Plain], setting: str) -> str:
    """False alarms at those thresholds under every family of noise that was seen."""
    there = [o for o in rivals if len(o[setting]["alarms"]) > 1]
    families = [f for f in NOISES if any(f in o[setting]["alarms"] for o in there)]
    if not there:
        return ""
    rows = ((o["who"], *(_alarm(o[setting]["alarms"], f) for f in families)) for o in there)
    return (
        "\n\nFalse alarms at those thresholds, by family of noise; those of the diagnosis as it is "
        "stand further up.\n\n" + table(("who", *families), rows)
    )


def _alarm(alarms: Mapping[str, Plain], family: str) -> str:
    """Share of false alarms under one family of noise, or a dash."""
    e = alarms.get(family)
    return f"{text(e, 2)} of {e['count']}" if e else "–"


def _needed(e: Plain) -> str:
    """Visibility for 90 % power; without a bound where it lies beyond what was tried."""
    if not e["count"]:
        return text(e)
    # JSON has no infinity.
    value, low, high = (math.inf if e[k] is None else e[k] for k in ("value", "low", "high"))
    return within_reach(Estimate(value, low, high, e["count"]))


def _at(points: Mapping[float, Plain], d: float) -> str:
    """Share found at one d, or a dash."""
    return text(points.get(d), 2)


def _drawn(score: Plain, programme: str, noise: str, setting: str) -> str:
    """Chart of the diagnosis, the test that knows the effect and all opponents, with intervals."""
    named = [(c["who"], c["points"]) for c in _curves(score, programme, noise)]
    rivals = _rivals(score, programme, noise, setting)
    named += [
        (f"{o['who']} at 1 %", o[setting]["power"])
        for o in sorted(rivals, key=lambda o: bool(o["who"] != OURS))
    ]
    series = power_series(
        [
            (who, [(p["d"], p["value"], p["low"], p["high"]) for p in points])
            for who, points in named
        ],
        apart=1.008,
    )
    where = "one threshold for all families of noise" if setting == EVERY else f"{noise} noise"
    drawn = power_chart(f"{programme} programme, {where}", series)
    element = drawn[: drawn.index("</svg>")]
    legend = "".join(
        f'<rect x="480" y="{26 + 18 * k}" width="9" height="9" fill="{s.colour}"/>'
        f'<text x="494" y="{34 + 18 * k}">{s.name}</text>'
        for k, s in enumerate(series)
    )
    opening = element.index(">") + 1
    style = (
        "<style>text{font:10px sans-serif;fill:#1a1a1a}.title{font-weight:600}"
        ".grid{stroke:#e6e6e6}</style>"
        '<rect width="100%" height="100%" fill="#fff"/>'
    )
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 700 300">'
        + style
        + element[opening:]
        + legend
        + "</svg>\n"
    )
