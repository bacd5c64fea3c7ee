"""Closed forms of the dead zone: frequency over amplitude, torque of a reversal."""

from __future__ import annotations

import math

from cyclosweep.errors import InputError

__all__ = ["backbone_frequency_hz", "reversal_shock_factor"]


def _above_zero(**numbers: float) -> None:
    for name, value in numbers.items():
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name}: found {value:g}, expected a number above zero")


def _not_below_zero(**numbers: float) -> None:
    for name, value in numbers.items():
        if not (math.isfinite(value) and value >= 0):
            raise InputError(f"{name}: found {value:g}, expected a number not below zero")


def backbone_frequency_hz(
    amplitude_rad: float,
    *,
    stiffness_nm_per_rad: float,
    inertia_kg_m2: float,
    gap_rad: float,
) -> float:
    """Frequency of a free oscillation through a dead zone.

    The period is that of the spring and the time in which the play is crossed twice at the speed
    ``omega a``: ``2 pi / omega + 4 gamma / (omega a)`` with ``omega = sqrt(k / J)``.

    Parameters
    ----------
    amplitude_rad : float
        Largest twist of the spring beyond the play [rad].
    stiffness_nm_per_rad : float
        Stiffness beyond the play [N m/rad].
    inertia_kg_m2 : float
        Inertia against the locked end; between two free inertias ``1 / (1 / J_1 + 1 / J_2)``
        [kg m^2].
    gap_rad : float
        Half of the play [rad].

    Returns
    -------
    float
        Frequency [Hz].

    Raises
    ------
    InputError
        For a number that is not above zero, or a gap below zero.

    Notes
    -----
    Without damping, friction and mean load.

    Examples
    --------
    >>> round(
    ...     backbone_frequency_hz(
    ...         0.1, stiffness_nm_per_rad=21, inertia_kg_m2=0.0035, gap_rad=0.48869219
    ...     ),
    ...     4,
    ... )
    2.9987
    """
    _above_zero(
        amplitude_rad=amplitude_rad,
        stiffness_nm_per_rad=stiffness_nm_per_rad,
        inertia_kg_m2=inertia_kg_m2,
    )
    _not_below_zero(gap_rad=gap_rad)
    omega = math.sqrt(stiffness_nm_per_rad / inertia_kg_m2)
    return omega / (math.tau + 4 * gap_rad / amplitude_rad)


def reversal_shock_factor(
    torque_nm: float,
    *,
    stiffness_nm_per_rad: float,
    gap_rad: float,
    driven_share: float = 1.0,
    balanced: bool = True,
) -> float:
    """Peak torque over static torque when the torque on one spring with play is reversed.

    Balanced (the torques of both ends are reversed, or one end is locked): ``1 + 2 sqrt(1 + K
    gamma / T)``. Otherwise the torque of one end is reversed and that of the other end vanishes:
    ``(T_e + sqrt(T_e^2 + 2 K (T_e (2 gamma + T / K) + T^2 / (2 K)))) / T``, where ``T_e = T
    driven_share`` is the part of the torque that acts on the spring.

    Parameters
    ----------
    torque_nm : float
        Static torque T before the reversal [N m].
    stiffness_nm_per_rad : float
        Stiffness K beyond the play [N m/rad].
    gap_rad : float
        Half of the play [rad].
    driven_share : float
        For unbalanced torques: ``J_2 / (J_1 + J_2)``, with ``J_1`` the inertia whose torque is
        reversed [1].
    balanced : bool
        Whether the torques on the train stay in balance.

    Returns
    -------
    float
        Shock factor [1].

    Raises
    ------
    InputError
        For numbers out of range.

    Notes
    -----
    One spring between two inertias, no damping, no friction.

    Examples
    --------
    >>> round(reversal_shock_factor(7.2575, stiffness_nm_per_rad=21, gap_rad=0.48869219), 6)
    4.107449
    """
    _above_zero(torque_nm=torque_nm, stiffness_nm_per_rad=stiffness_nm_per_rad)
    _not_below_zero(gap_rad=gap_rad)
    if balanced:
        return 1 + 2 * math.sqrt(1 + stiffness_nm_per_rad * gap_rad / torque_nm)
    _above_zero(driven_share=driven_share)
    acting = torque_nm * driven_share
    way = 2 * gap_rad + torque_nm / stiffness_nm_per_rad
    energy = acting * way + torque_nm**2 / (2 * stiffness_nm_per_rad)
    return (acting + math.sqrt(acting**2 + 2 * stiffness_nm_per_rad * energy)) / torque_nm
