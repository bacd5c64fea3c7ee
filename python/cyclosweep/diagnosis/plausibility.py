"""Plausibility: which mistake a compliance, play or datum far from the drive file suggests."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import log

from cyclosweep.recording import Recording
from cyclosweep.recording.exchanged_columns import EXCHANGED, are_exchanged
from cyclosweep.recording.units import factor_of
from cyclosweep.result import CalibratedParameter, Doubt
from cyclosweep.result.plausibility import Quantity

FAR_COMPLIANCE = 2.0
"""Factor from nominal beyond which a compliance is remarked on. Real drives are often softer than
their file by more than that, so that the remark says what it would mean; among 300 made recordings
whose drives scatter by a tenth, effects of the size of the twist itself move it by less."""
FAR_PLAY = 2.2
"""Factor from nominal beyond which a free play is remarked on."""
FAR_PLAY_SHARE = 0.1
"""Share of the elastic twist by which the play must differ from nominal as well: a play of
hundredths of a degree may be any multiple of another."""
FAR_DATUM = 3.0
"""Multiple of half the nominal range of the angle, play and elastic twist together, beyond which
a datum is remarked on: a zero that was set on the drive lies within the range."""
NEAR = log(1.3)
"""How far (logarithm of the factor) a compliance may be from what a mistake gives."""
NEAR_PLAY = log(1.6)
"""The same of a free play, which differs more between specimens of one drive."""
CLEAR = log(1.03)
"""How near a compliance must be to a mistake of less than `FAR_COMPLIANCE`, as lbf ft for N m."""
SAME_PLAY = log(1.1)
"""How near nominal the play must then be."""
RARER = log(1.1)
"""Disadvantage of a conversion made twice or the wrong way against a unit that was overlooked."""
RIVAL = log(1.12)
"""How much worse than the best a mistake may fit and still be named beside it."""

REMARKS: dict[str, Quantity] = {
    "columns_swapped": "columns",
    "unit_contradicted": "columns",
    "column_unread": "columns",
    "saturation": "range",
}
"""Remarks of reading to be settled first, and what each is about."""


@dataclass(frozen=True)
class Mistake:
    """A mistake of reading and what it does.

    Attributes
    ----------
    text : str
        In words, with the factor.
    compliance, play : float
        Factors by which compliance and free play then come out.
    rare : bool
        Whether it is a conversion made twice or the wrong way.
    """

    text: str
    compliance: float
    play: float
    rare: bool = False


ANGLE_UNITS = {"arcmin": "60", "arcsec": "3600", "mrad": "17.45", "rad": "57.3", "turns": "360"}
"""Units that are read as degrees, with the factor in words."""
TORQUE_UNITS = {
    "lbf in": "8.85",
    "lbf ft": "1.356",
    "kgf m": "9.81",
    "kgf cm": "10.2",
    "N cm": "100",
    "N mm": "1000",
    "kN m": "1000",
}
"""Units that are read as newton metres, with the factor in words."""
TWICE = {"angle": ("rad", "turns"), "torque": ("lbf in", "lbf ft", "N mm")}
"""Units that are converted by mistake where a file is in deg and N m already."""


def mistakes(ratio: float) -> tuple[Mistake, ...]:
    """List the mistakes of units and sides that recordings have had.

    Parameters
    ----------
    ratio : float
        Ratio of the drive.

    Returns
    -------
    tuple of Mistake
    """
    degrees = {unit: factor_of(unit, "angle_deg") for unit in ANGLE_UNITS}
    newton_metres = {unit: factor_of(unit, "torque_nm") for unit in TORQUE_UNITS}
    found = [
        Mistake(
            f"the angle is in {unit} and was read as deg (factor {text})",
            1.0 / degrees[unit],
            1.0 / degrees[unit],
        )
        for unit, text in ANGLE_UNITS.items()
    ]
    found += [
        Mistake(
            f"the torque is in {unit} and was read as N m (factor {text})", newton_metres[unit], 1.0
        )
        for unit, text in TORQUE_UNITS.items()
    ]
    twice = "the {} was converted from {} and did not need it (factor {})"
    found += [
        Mistake(twice.format("angle", unit, ANGLE_UNITS[unit]), degrees[unit], degrees[unit], True)
        for unit in TWICE["angle"]
    ]
    found += [
        Mistake(
            twice.format("torque", unit, TORQUE_UNITS[unit]), 1.0 / newton_metres[unit], 1.0, True
        )
        for unit in TWICE["torque"]
    ]
    at = f"the ratio, {ratio:g}"
    found += [
        Mistake(f"measured at the output, and side says input (the ratio squared, {ratio**2:g})",
                ratio**-2, 1.0 / ratio),
        Mistake(f"measured at the input, and side says output (the ratio squared, {ratio**2:g})",
                ratio**2, ratio),
        Mistake(f"the angle was taken at the output and the torque at the input ({at})",
                1.0 / ratio, 1.0 / ratio),
        Mistake(f"the angle was taken at the input and the torque at the output ({at})",
                ratio, ratio),
        Mistake(f"the torque was taken at the output and the angle at the input ({at})",
                1.0 / ratio, 1.0),
        Mistake(f"the torque was taken at the input and the angle at the output ({at})",
                ratio, 1.0),
    ]  # fmt: skip
    return tuple(found)


def likely_mistakes(
    compliance: float, play: float | None, ratio: float, near: float = NEAR
) -> tuple[str, ...]:
    """Choose the mistakes by which compliance and, independently, play come near nominal.

    Parameters
    ----------
    compliance : float
        Measured compliance over the nominal one, above zero.
    play : float or None
        The same of the free play; None where the recording or the drive file does not tell it.
    ratio : float
        Ratio of the drive.
    near : float
        How far the compliance may be from what a mistake gives, as a logarithm.

    Returns
    -------
    tuple of str
        The likeliest first, with those that fit about as well; empty where none does.

    Examples
    --------
    >>> likely_mistakes(1 / 8.9, 1.02, 87.0)
    ('the torque is in lbf in and was read as N m (factor 8.85)',)
    >>> likely_mistakes(1.8, 9.0, 87.0)
    ()
    """
    ranked = []
    for mistake in mistakes(ratio):
        distance = abs(log(compliance / mistake.compliance))
        if distance > near:
            continue
        if play is not None and play > 0:
            apart = abs(log(play / mistake.play))
            if apart > NEAR_PLAY:
                continue
            distance = max(distance, 0.3 * apart)
        ranked.append((distance + (RARER if mistake.rare else 0.0), mistake.text))
    ranked.sort()
    return tuple(text for far, text in ranked if far <= ranked[0][0] + RIVAL)[:2]


def doubts(
    before: Mapping[str, CalibratedParameter],
    after: Mapping[str, CalibratedParameter],
    recording: Recording,
    ratio: float,
) -> tuple[Doubt, ...]:
    """Remark on compliance, play and datum far from nominal, and on what reading found at fault.

    Parameters
    ----------
    before, after : mapping of str to CalibratedParameter
        Calibrated parameters of the published and of the repaired model by name: an effect may
        take compliance or play from the line, or hide in it, so that a value is far only where
        both say so.
    recording : Recording
        What was measured.
    ratio : float
        Ratio of the drive.

    Returns
    -------
    tuple of Doubt
        Empty where every value is near nominal.
    """
    compliance = _nearer("compliance_deg_per_nm", before, after)
    play = _nearer("free_play_deg", before, after)
    datum = _nearer("datum_deg", before, after).estimate
    nominal, nominal_play = compliance.nominal or compliance.estimate, play.nominal or 0.0
    factor = compliance.estimate / nominal
    elastic = abs(nominal) * float(abs(recording.torque_nm).max())
    known = play.std_error is not None and nominal_play > FAR_PLAY_SHARE * elastic
    play_factor = play.estimate / nominal_play if known else None
    play_is_far = (
        play.std_error is not None
        and abs(play.estimate - nominal_play) > max(FAR_PLAY_SHARE * elastic, 5 * play.std_error)
        and not nominal_play / FAR_PLAY <= play.estimate <= nominal_play * FAR_PLAY
    )
    compliance_is_far = not 1.0 / FAR_COMPLIANCE <= factor <= FAR_COMPLIANCE
    suggested: tuple[str, ...] = ()
    if factor > 0:
        torque, angle = recording.torque_nm, recording.angle_deg
        if compliance_is_far and angle is not None and are_exchanged(torque, angle, abs(nominal)):
            suggested = (EXCHANGED,)
        elif compliance_is_far:
            suggested = likely_mistakes(factor, play_factor, ratio)
        elif play_factor is None or abs(log(max(play_factor, 1e-9))) < SAME_PLAY:
            suggested = likely_mistakes(factor, play_factor, ratio, CLEAR)
    found = []
    if compliance_is_far or suggested:
        found.append(_compliance(compliance, nominal, factor, suggested, play_is_far))
    if play_is_far and not suggested:
        # Of both estimates, which are far, the one that the answer gives elsewhere.
        found.append(_play(after["free_play_deg"], nominal_play, compliance_is_far))
    reach = nominal_play + elastic * max(factor, 1.0)
    if play.std_error is not None and abs(datum) > FAR_DATUM * reach:
        found.append(_datum(datum, reach))
    modulo = recording.modulo_fault(2.0 * nominal_play)
    if modulo is not None:
        found.append(Doubt(quantity="angle_modulo", text=modulo.reason))
    # How the file was read decides what everything else means.
    return (*_remarks_of_reading(recording), *found)


def _remarks_of_reading(recording: Recording) -> tuple[Doubt, ...]:
    """Remarks on how a file was read, to be settled before anything else."""
    return tuple(
        Doubt(
            quantity=REMARKS[fault.kind],
            text=fault.reason[0].lower() + fault.reason[1:].rstrip("."),
        )
        for fault in recording.faults
        if fault.kind in REMARKS
    )


def _nearer(
    name: str,
    before: Mapping[str, CalibratedParameter],
    after: Mapping[str, CalibratedParameter],
) -> CalibratedParameter:
    """Return of two estimates the one that is nearer to nominal.

    Parameters
    ----------
    name : str
        Which parameter.
    before, after : mapping of str to CalibratedParameter
        Parameters of the published and of the repaired model.

    Returns
    -------
    CalibratedParameter
    """
    pair = (after[name], before.get(name, after[name]))
    if name == "datum_deg" or not all(each.estimate > 0 for each in pair):
        return min(pair, key=lambda each: abs(each.estimate - (each.nominal or 0.0)))
    nominal = after[name].nominal or 1.0
    return min(pair, key=lambda each: abs(log(each.estimate / nominal)))


def _compliance(
    found: CalibratedParameter,
    nominal: float,
    factor: float,
    suggested: tuple[str, ...],
    play_is_far: bool,
) -> Doubt:
    """Remark on a compliance; with a far play and no mistake of units, on the drive's file.

    Parameters
    ----------
    found : CalibratedParameter
        Calibrated compliance [deg/(N m)].
    nominal : float
        The drive file's [deg/(N m)].
    factor : float
        Found over nominal.
    suggested : tuple of str
        Mistakes that explain it.
    play_is_far : bool
        Whether the free play is far from nominal, too.

    Returns
    -------
    Doubt
    """
    words = f"the compliance is {factor:.3g} times that of the drive file"
    if suggested:
        words += f", as where {' or '.join(suggested)}; if that is so, correct it and repeat"
    elif play_is_far:
        words += ", and no mistake of units brings it and the play near nominal"
    elif factor > 1.0:
        words += (
            "; no mistake of units fits: the drive, or what holds it, is softer than calculated, "
            "as real drives often are, or the file is another drive's"
        )
    else:
        words += "; no mistake of units fits: check the torque's scale and the drive file"
    return Doubt(
        quantity="compliance",
        found=found.estimate,
        nominal=nominal,
        factor=factor,
        suggests=suggested,
        text=words,
    )


def _play(found: CalibratedParameter, nominal: float, compliance_is_far: bool) -> Doubt:
    """Remark on a free play that no unit explains.

    Parameters
    ----------
    found : CalibratedParameter
        Calibrated free play [deg].
    nominal : float
        The drive file's [deg].
    compliance_is_far : bool
        Whether the compliance is far from nominal, too.

    Returns
    -------
    Doubt
    """
    factor = found.estimate / nominal if nominal > 0 else None
    words = f"the free play is {found.estimate:.3g} deg each side where the drive file says "
    words += f"{nominal:.3g}"
    suggested: tuple[str, ...] = ()
    if (
        not compliance_is_far
        and factor is not None
        and abs(log(max(factor, 1e-9) / 2.0)) < log(1.15)
    ):
        suggested = ("the file gives half of the play of each side",)
    elif factor is not None and factor > 1.0:
        suggested = ("the file is another drive's",)
    if suggested:
        words += f", as where {suggested[0]}"
    words += "; else the drive is worn or set otherwise than the file says"
    return Doubt(
        quantity="free_play",
        found=found.estimate,
        nominal=nominal,
        factor=factor,
        suggests=suggested,
        text=words,
    )


def _datum(datum: float, reach: float) -> Doubt:
    """Remark on a zero far from the middle of the play.

    Parameters
    ----------
    datum : float
        Calibrated datum [deg].
    reach : float
        Half of the range that the drive file and the torque give the angle [deg].

    Returns
    -------
    Doubt
    """
    turns = datum / 360.0
    words = f"the middle of the play reads {datum:.4g} deg, where the whole twist is ±{reach:.3g}"
    suggested: tuple[str, ...] = ()
    if round(turns) and abs(turns - round(turns)) * 360.0 < reach:
        suggested = ("whole turns were counted before the test",)
        words += f": {round(turns)} turns were counted before the test"
    words += "; harmless where the sensor's zero is arbitrary, else the wrong columns or rows"
    return Doubt(quantity="datum", found=datum, nominal=0.0, suggests=suggested, text=words)
