"""Detection beside the opponents' on the page of record: words, tables and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from cyclosweep.challenge.board.svg import PALETTE, Series, chart
from cyclosweep.challenge.noise import NOISES
from cyclosweep.challenge.record.markdown import Plain, table, text

EVERY = "every"
OWN = "own"
PROGRAMMES = ("rich", "poor")


def write_pictures(score: Plain, docs: Path) -> None:
    """Write the power curves of a score, one picture for every programme and setting."""
    for programme in PROGRAMMES:
        for noise in _noises(score):
            for setting in (OWN, EVERY):
                if setting == OWN or _rivals(score, programme, noise, setting):
                    file = docs / _picture(programme, noise, setting)
                    file.write_text(_drawn(score, programme, noise, setting))


def contest_section(score: Plain) -> str:
    """Two comparisons under white noise: tuned on white noise, and on every family."""
    parts = [
        "## Detection beside its opponents\n\n"
        "Share of recordings with a single effect in which something was found, on identical "
        "files. Every opponent stands at a threshold that one in a hundred of recordings with "
        "nothing missing exceeds. Which recordings decides the comparison, so both are shown: "
        "white noise alone, which is what their formulas assume and the diagnosis is not told, "
        "and all families of noise alike, which is what a rig has and what the table of false "
        "alarms above asks of the diagnosis. The diagnosis stands as it is, and once more with "
        "its own evidence tuned in the same way. `ahead` is the share found by the diagnosis "
        "minus that found by the opponent over d = 3 to 10, with the uncertainty of the threshold "
        "in its interval; `ahead alike` the same with both tuned."
    ]
    for programme in PROGRAMMES:
        parts.append(
            f"### {programme.capitalize()} programme, thresholds set on white noise\n\n"
            + _comparison(score, programme, "white", OWN)
            + _elsewhere(_rivals(score, programme, "white", OWN))
        )
    for programme in PROGRAMMES:
        if _rivals(score, programme, "white", EVERY):
            parts.append(
                f"### {programme.capitalize()} programme, thresholds set over every family of "
                "noise\n\nOpponents that cost too much to be shown all families are left out; "
                "they stand in the tables above.\n\n"
                + _comparison(score, programme, "white", EVERY)
            )
    return "\n\n".join(parts)


def coloured_section(score: Plain | None) -> str:
    """The contest under correlated noise, every threshold set on that very noise."""
    head = "## The same under correlated noise\n\n"
    if score is None:
        return head + "Not run yet."
    about = score["about"]
    parts = [
        head + f"{about['cases']:,} more recordings under noise of family {about['noise']} (seed "
        f"{about['seed']}, answers sealed under `{about['root']}`), and every opponent's "
        "threshold set on recordings with nothing missing and that very noise: what tuning an "
        "opponent to one's own rig would give."
    ]
    for programme in PROGRAMMES:
        for noise in _noises(score):
            parts.append(
                f"### {programme.capitalize()} programme, noise {noise}\n\n"
                + _comparison(score, programme, noise, OWN)
            )
    return "\n\n".join(parts)


def _noises(score: Plain) -> list[str]:
    own = score["about"].get("noise", "white")
    return list(dict.fromkeys([own, *(o["noise"] for o in score["opponents"])]))


def _rivals(score: Plain, programme: str, noise: str, setting: str) -> list[Plain]:
    """Curves of a programme and noise for which this setting exists."""
    return [
        o
        for o in score["opponents"]
        if (o["programme"], o["noise"]) == (programme, noise) and o[setting] is not None
    ]


def _picture(programme: str, noise: str, setting: str) -> str:
    """Name of a picture's file."""
    where = "-every-family" if setting == EVERY else "" if noise == "white" else f"-{noise}"
    return f"proof-power-{programme}{where}.svg"


def _comparison(score: Plain, programme: str, noise: str, setting: str) -> str:
    """Picture and table of who finds how much."""
    needed = {
        "detected": "d for 90 % power, ",
        "test that knows the effect": "the same of the test that knows the effect, ",
    }
    figures = {f["name"]: f["estimate"] for f in score["figures"]}
    curves = [c for c in score["curves"] if c["programme"] == programme]
    rivals = _rivals(score, programme, noise, setting)
    levels = sorted({p["d"] for c in curves for p in c["points"]})
    rows: list[Sequence[object]] = []
    for c in curves:
        at = {p["d"]: p for p in c["points"]}
        estimate = figures.get(needed.get(c["who"], "") + programme)
        rows.append((c["who"], "", _needed(estimate), "", "", *(_at(at, d) for d in levels)))
    for o in rivals:
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
        "false alarms at defaults",
        "d for 90 %",
        "ahead",
        "ahead alike",
        *(f"d = {d:g}" for d in levels),
    )
    picture = _picture(programme, noise, setting)
    return f"![Power against visibility]({picture})\n\n" + table(heads, rows)


def _elsewhere(rivals: Sequence[Plain]) -> str:
    """False alarms of thresholds that were set on white noise, under every other family."""
    families = [f for f in NOISES if any(f in o["elsewhere"] for o in rivals)]
    if not families:
        return ""
    rows = (
        (o["who"], *(text(o["elsewhere"].get(f), 2) for f in families))
        for o in rivals
        if o["elsewhere"]
    )
    return (
        "\n\nFalse alarms at those thresholds under other noise. A threshold that holds on white "
        "noise alone is no use to a test engineer, whose noise is not; the diagnosis as it is "
        "stands in the table of false alarms above.\n\n" + table(("who", *families), rows)
    )


def _needed(e: Plain | None) -> str:
    if e and e["count"] and (e["value"] is None or e["value"] > 20.0):
        return "> 20"
    return text(e)


def _at(points: Mapping[float, Plain], d: float) -> str:
    return text(points.get(d), 2)


def _drawn(score: Plain, programme: str, noise: str, setting: str) -> str:
    """Curves of the diagnosis, the knowing test and all opponents, with intervals."""
    named = [(c["who"], c["points"]) for c in score["curves"] if c["programme"] == programme]
    named += [
        (f"{o['who']} at 1 %", o[setting]["power"])
        for o in _rivals(score, programme, noise, setting)
    ]
    series = [
        Series(
            who,
            [p["d"] + 0.05 * k for p in points],
            [p["value"] for p in points],
            [p["low"] for p in points],
            [p["high"] for p in points],
            colour=PALETTE[k % len(PALETTE)],
        )
        for k, (who, points) in enumerate(named)
        if points
    ]
    where = "tuned over every family of noise" if setting == EVERY else f"{noise} noise"
    drawn = chart(
        f"Power against visibility, {programme} programme, {where}",
        "projected signal-to-noise d",
        "share of recordings",
        series,
        x_range=(2.0, 21.0),
        y_range=(0.0, 1.0),
    )
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
