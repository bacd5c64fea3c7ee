"""What the paper prints of its 87:1 drive and a picture can show beside the model's."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cyclosweep.design.drive import Drive

__all__ = [
    "LINE_DEG",
    "LINE_LOAD_TN",
    "LINE_START_DEG",
    "MEAN_ACTIVE_PINS",
    "THEORY_ERROR",
    "THEORY_LOAD_TN",
    "is_paper_drive",
]

LINE_LOAD_TN = 2.5
"""Load [T_N] up to which the loading curve is printed to be about linear."""

LINE_START_DEG = 28.0
"""Turn of the input at which the loading curve is printed to start [deg]: half the free play."""

LINE_DEG = (75.0, 80.0)
"""Turn of the input at that load [deg], as printed."""

MEAN_ACTIVE_PINS = 6.75
"""Mean number of active pins of 8 over a turn, both discs, as printed."""

THEORY_LOAD_TN = 4.0
"""Load [T_N] for which the paper states how far its theory is from its measurement."""

THEORY_ERROR = 0.085
"""How far at most theory and measurement are said to be apart there, over the twist [1]."""


def is_paper_drive(drive: Drive) -> bool:
    """Whether a drive has the ratio, counts and ratings of the paper's (Sumitomo CHH413087).

    Parameters
    ----------
    drive : Drive
        Any drive. Its dimensions are not asked: the paper prints none.

    Returns
    -------
    bool

    Examples
    --------
    >>> import cyclosweep as cs
    >>> is_paper_drive(cs.Drive.reference_87())
    True
    """
    own = (
        drive.ratio,
        drive.disc_count,
        drive.output_pin_count,
        drive.output_torque_nm,
        drive.input_power_kw,
        drive.input_speed_rpm,
    )
    return own == (87, 2, 8, 585.0, 1.14, 1500.0)
