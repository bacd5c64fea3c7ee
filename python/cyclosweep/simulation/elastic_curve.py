"""A twist that is given over the torque point by point, instead of the published straight line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.json_fields import numbers_of

if TYPE_CHECKING:
    from cyclosweep.design.torque_twist import TorqueTwist

__all__ = ["ElasticCurve"]


@dataclass(frozen=True)
class ElasticCurve:
    """Twist beyond the free play over the torque; straight on beyond the last points.

    Attributes
    ----------
    torque_nm : tuple of float
        Torques, rising [N m].
    twist_deg : tuple of float
        Twist there, rising, zero at zero torque [deg].
    """

    torque_nm: tuple[float, ...]
    twist_deg: tuple[float, ...]

    @classmethod
    def of_curve(cls, curve: TorqueTwist) -> Self:
        """Twist beyond the free play of a drive's torque-twist curve.

        Parameters
        ----------
        curve : TorqueTwist
            Curve of a component model.

        Returns
        -------
        ElasticCurve
        """
        torque, twist = curve.branches()
        return cls(tuple(torque.tolist()), tuple(twist.tolist()))

    def twist(self, torque_nm: Floats) -> Floats:
        """Twist beyond the free play.

        Parameters
        ----------
        torque_nm : ndarray, shape (n,)
            Elastic torque [N m].

        Returns
        -------
        ndarray, shape (n,)
            In deg.
        """
        torque, twist = np.array(self.torque_nm), np.array(self.twist_deg)
        found = np.interp(torque_nm, torque, twist)
        for end, inner in ((0, 1), (-1, -2)):
            slope = (twist[end] - twist[inner]) / (torque[end] - torque[inner])
            beyond = torque_nm < torque[0] if end == 0 else torque_nm > torque[-1]
            found = np.where(beyond, twist[end] + slope * (torque_nm - torque[end]), found)
        return np.asarray(found, dtype=np.float64)

    def as_dict(self) -> dict[str, Any]:
        """Entry of ``model.json``."""
        return {"torque_nm": list(self.torque_nm), "twist_deg": list(self.twist_deg)}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Read an entry of ``model.json``.

        Parameters
        ----------
        content : mapping
            Decoded entry with ``torque_nm`` and ``twist_deg``.

        Returns
        -------
        ElasticCurve

        Raises
        ------
        InputError
            The lists do not rise, differ in length, have fewer than three points or do not pass
            through zero.
        """
        torque, twist = numbers_of(content, "torque_nm"), numbers_of(content, "twist_deg")
        if len(torque) != len(twist) or len(torque) < 3:
            raise InputError(
                f"elastic_curve: found {len(torque)} torques and {len(twist)} twists, expected as "
                "many of both, at least three"
            )
        for name, values in (("torque_nm", torque), ("twist_deg", twist)):
            if not np.all(np.diff(values) > 0):
                raise InputError(f"elastic_curve: {name}: expected numbers that rise")
        if 0.0 not in torque or twist[torque.index(0.0)] != 0.0:
            raise InputError("elastic_curve: expected a point of no torque and no twist")
        return cls(torque, twist)
