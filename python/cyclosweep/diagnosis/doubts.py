"""Remarks on a compliance, play or zero far from the drive file, in words."""

from math import log

from cyclosweep.result import Doubt

HALVED = log(1.15)
"""How near twice the nominal play a play is where the file gives half of it."""


def compliance_doubt(
    factor: float,
    nominal: float,
    suggested: tuple[str, ...],
    which: str = "",
    *,
    play_is_far: bool = False,
) -> Doubt:
    """Remark on a compliance; with a far play and no mistake of units, on the drive's file.

    Parameters
    ----------
    factor : float
        Compliance over the nominal one.
    nominal : float
        The drive file's [deg/(N m)].
    suggested : tuple of str
        Mistakes that explain it.
    which : str
        How it was read, where that is not the calibration.
    play_is_far : bool
        Whether the free play is far from nominal, too.

    Returns
    -------
    Doubt
    """
    words = f"the compliance{which} is {factor:.3g} times that of the drive file"
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
        found=factor * nominal,
        nominal=nominal,
        factor=factor,
        suggests=suggested,
        text=words,
    )


def play_doubt(found: float, nominal: float, *, compliance_is_far: bool) -> Doubt:
    """Remark on a free play that no unit explains.

    Parameters
    ----------
    found : float
        Free play of each side, below zero where straight lines along the flanks overlap [deg].
    nominal : float
        The drive file's [deg].
    compliance_is_far : bool
        Whether the compliance is far from nominal, too.

    Returns
    -------
    Doubt
    """
    shown = max(found, 0.0)
    factor = shown / nominal if nominal > 0 else None
    words = f"the free play is {shown:.3g} deg each side where the drive file says {nominal:.3g}"
    suggested: tuple[str, ...] = ()
    if factor is not None and not compliance_is_far and abs(log(max(factor, 1e-9) / 2.0)) < HALVED:
        suggested = ("the file gives half of the play of each side",)
    elif factor is not None and factor > 1.0:
        suggested = ("the file is another drive's",)
    if suggested:
        words += f", as where {suggested[0]}; else the drive is worn or set otherwise than it says"
    elif found > nominal:
        words += ": the drive is worn or set otherwise than the file says"
    else:
        words += (
            ": a preload, friction that holds the shaft within its play, or the file of another "
            "drive"
        )
    return Doubt(
        quantity="free_play",
        found=shown,
        nominal=nominal,
        factor=factor,
        suggests=suggested,
        text=words,
    )


def datum_doubt(datum: float, reach: float) -> Doubt:
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
