"""The diagnosis in sentences that a test engineer can act on."""

from collections.abc import Sequence
from typing import Any

from cyclosweep.diagnosis.locate import Region


def degrees(value: float) -> str:
    """An angle in deg and, where small, in arcmin."""
    return f"{value:.3g} deg" + (f" ({60 * value:.2g} arcmin)" if abs(value) < 1.0 else "")


def readable(name: str) -> str:
    """Name of an effect in plain words."""
    return name.replace("_", " ")


def listed(names: Sequence[str]) -> str:
    """Names in a row."""
    words = [readable(n) for n in names]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def place_of(regions: Sequence[Region]) -> str:
    """Where the strongest region lies, in words."""
    if not regions:
        return "no single place"
    region = regions[0]
    parts = []
    if region.torque_nm is not None:
        parts.append(f"{region.torque_nm[0]:.3g} to {region.torque_nm[1]:.3g} N m")
    if region.direction is not None:
        parts.append(region.direction)
    if region.run is not None:
        first, last = region.run
        parts.append(f"run {first}" if first == last else f"runs {first} to {last}")
    if region.time_s is not None:
        parts.append(f"t = {region.time_s[0]:.5g} to {region.time_s[1]:.5g} s")
    if region.crank_deg is not None:
        parts.append(f"mesh position {region.crank_deg[0]:.4g} deg")
    return ", ".join(parts) or "everywhere"


def calibration_words(parameters: dict[str, dict[str, Any]]) -> str:
    """What the calibration found, against nominal."""
    scale = parameters["compliance_scale"]["estimate"]
    play = parameters["free_play_deg"]
    datum = parameters["datum_deg"]["estimate"]
    words = f"Calibration: compliance {100 * (scale - 1):+.1f} % against nominal"
    if play.get("std_error") is not None:
        words += f", free play {degrees(play['estimate'])} each side"
        words += f" (nominal {play['nominal']:.3g})"
    return f"{words}, datum {degrees(datum)}; these are settings of this specimen, not physics."


def statement(
    verdict: str,
    effects: Sequence[dict[str, Any]],
    explanation_set: Sequence[dict[str, Any]],
    regions: Sequence[Region],
    parameters: dict[str, dict[str, Any]],
    numbers: dict[str, Any],
) -> str:
    """Compose the statement of a verdict."""
    where = place_of(regions)
    calibration = calibration_words(parameters)
    if verdict == "NOTHING_MISSING":
        return (
            "Nothing is missing: simulation and recording agree within the noise of "
            f"{degrees(numbers['sigma'])}, and every effect this recording can show is below "
            f"{degrees(numbers['largest_bound'])} (tolerance {degrees(numbers['tolerance'])}). "
            + calibration
        )
    if verdict == "INSUFFICIENT_DATA":
        names = listed(numbers["open"][:4]) if numbers["open"] else "no effect"
        return (
            "No difference was found, but the recording is too poor to rule out what matters: "
            f"{names} could be as large as {degrees(numbers['largest_bound'])}, above the "
            f"tolerance of {degrees(numbers['tolerance'])}. {calibration}"
        )
    sizes = "; ".join(
        f"{readable(e['name'])} {degrees(e['size_deg']['estimate'])} "
        f"(95 %: {e['size_deg']['ci95'][0]:.2g} to {e['size_deg']['ci95'][1]:.2g})"
        for e in effects
    )
    repaired = (
        f" With it the error falls from {degrees(numbers['before'])} to {degrees(numbers['after'])}"
    )
    if numbers["held_before"] > 0.0:
        repaired += (
            f", on data not used from {degrees(numbers['held_before'])} to "
            f"{degrees(numbers['held_after'])}"
        )
    repaired += "."
    if verdict == "IDENTIFIED":
        return (
            f"Missing physics: {listed([e['name'] for e in effects])}{_others(explanation_set)}. "
            "Size after "
            f"re-calibration: {sizes}. It shows most at {where}.{repaired} {calibration}"
        )
    if verdict == "AMBIGUOUS":
        options = " or ".join(_option(e) for e in explanation_set)
        return (
            f"Something is missing, and this recording cannot say which: {options}. It shows most "
            f"at {where}.{repaired} {calibration}"
        )
    remains = numbers["remains"]
    if numbers["drift"] is not None:
        own, other = numbers["drift"]
        calibration = (
            "The recording is not stationary: a model of some runs misses others by "
            f"{degrees(other)} against {degrees(own)} on its own. "
            "It is unfit for a stiffness; warm-up, wear or creep have to settle first."
        )
    known = ""
    if effects:
        known = f" Beside {listed([e['name'] for e in effects])} ({sizes}),"
    return (
        f"Unknown physics:{known} something without a name in the vocabulary remains"
        f"{': ' + remains if remains else ''}. It shows most at {where}. {calibration}"
    )


def _option(explanation: dict[str, Any]) -> str:
    """One explanation with its probability."""
    names = explanation["effects"] + explanation["without_name"]
    return f"{' + '.join(map(readable, names))} ({100 * explanation['probability']:.0f} %)"


def _others(explanation_set: Sequence[dict[str, Any]]) -> str:
    """What else it may be, beside the explanation that is named."""
    if len(explanation_set) < 2:
        return ""
    first, *rest = explanation_set
    return (
        f", with a probability of {100 * first['probability']:.0f} %; not ruled out: "
        + " or ".join(_option(e) for e in rest)
    )


def forecast(blocks: Sequence[dict[str, Any]]) -> str:
    """Sentence on forecasts of runs that were kept; empty where the model was told the flank."""
    kept = [b for b in blocks if b.get("told_after_deg") is not None]
    if not kept:
        return ""
    block = kept[0]
    text = (
        f" As a forecast of what was not fitted, crossings of the dead zone included, the model "
        f"errs by {degrees(block['after_deg'])}, before the repair by "
        f"{degrees(block['before_deg'])}; told the flank by {degrees(block['told_after_deg'])}."
    )
    if block.get("floor_deg") is not None:
        text += f" Another run as the prediction leaves {degrees(block['floor_deg'])}."
    return text
