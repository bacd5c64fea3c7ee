"""Output pins as parallel contacts: how far the input turns before they carry a torque."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import DISCS, OUTPUT_PINS, RATED_INPUT_TORQUE_NM, RATIO

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pins:
    """The sixteen hole-pin contacts of one specimen.

    Attributes
    ----------
    compliance_share : float
        Share of the drive's compliance that lies in the contacts rather than the shaft [-].
    late_share : array, shape (L,)
        Relative stiffness of the contacts that close late, scaled by the take-up amplitude [-].
    late_clearance_deg : array, shape (L,)
        Input twist at which each of them closes [deg].
    hertz_exponent : float
        Exponent of the contact's approach in its force: 2/3 for a point contact [-].
    pin_scatter, disc_weight : array
        Relative stiffness of each pin (8,) and of each disc's contact plane (2,) [-].
    clocking_deg, window_deg : float
        Position of the first hole and edge of its active window [deg].
    """

    compliance_share: float
    late_share: Array
    late_clearance_deg: Array
    hertz_exponent: float
    pin_scatter: Array
    disc_weight: Array
    clocking_deg: float
    window_deg: float

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Pins:
        """Draw the contacts of one specimen."""
        late = int(rng.integers(2, 6))
        return cls(
            compliance_share=float(rng.uniform(0.25, 0.45)),
            late_share=rng.dirichlet(np.full(late, 3.0)),
            late_clearance_deg=np.sort(np.exp(rng.uniform(np.log(3.0), np.log(40.0), late))),
            hertz_exponent=float(rng.choice([2.0 / 3.0, rng.uniform(0.55, 0.75)])),
            pin_scatter=np.exp(rng.normal(0.0, 0.35, OUTPUT_PINS)),
            disc_weight=np.array([1.0, rng.uniform(0.3, 0.8)]),
            clocking_deg=float(rng.uniform(-3.0, 3.0)),
            window_deg=float(rng.uniform(0.0, 25.0)),
        )

    def stiffness_factor(self, crank_deg: Array) -> Array:
        """Relative departure of the contacts' stiffness from its mean over a turn, shape of input.

        Each hole bears on its pin over a part of the turn, with an arm that goes with the sine of
        its angle from the mesh zone; the pins and the two discs' contact planes are not equal.
        """
        turn = np.linspace(0.0, 360.0, 721)[:-1]
        raw = self._bearing(np.concatenate([turn, np.ravel(crank_deg)]))
        mean = raw[: turn.size].mean()
        spread = raw[: turn.size].std()
        return np.reshape((raw[turn.size :] - mean) / spread, np.shape(crank_deg))

    def _bearing(self, crank_deg: Array) -> Array:
        """Sum of the contacts' weights at each crank position, shape (N,)."""
        total = np.zeros(crank_deg.shape)
        edge = np.sin(np.deg2rad(self.window_deg))
        holes = self.clocking_deg + np.arange(OUTPUT_PINS) * (360.0 / OUTPUT_PINS)
        for disc in range(DISCS):
            for pin, hole in enumerate(holes):
                angle = np.deg2rad(crank_deg * (1.0 + 1.0 / RATIO) - hole + 180.0 * disc)
                arm = np.maximum(np.sin(angle) - edge, 0.0)
                total += self.disc_weight[disc] * self.pin_scatter[pin] * arm**2
        return total

    def torque_of_travel(
        self, travel_deg: Array, compliance: float, take_up: float, hertz: float, phase: float
    ) -> Array:
        """Torque carried by the contacts when the discs have travelled past the first contact.

        Parameters
        ----------
        travel_deg : array
            Travel, as input angle [deg], not negative.
        compliance : float
            Compliance of all contacts together, closed, seen at the input [deg/(N m)].
        take_up : float
            Share of the stiffness that closes late [-].
        hertz : float
            Approach of the closed contacts at rated torque beyond the linear law [deg].
        phase : float
            Factor on all stiffness at this crank position [-].

        Returns
        -------
        array
            Input torque [N m], same shape.
        """
        shares = np.concatenate(([1.0 - take_up], take_up * self.late_share))
        gaps = np.concatenate(([0.0], self.late_clearance_deg))
        torque = np.zeros_like(travel_deg)
        for share, gap in zip(shares, gaps, strict=True):
            if share <= 0.0:
                continue
            approach = np.maximum(travel_deg - gap, 0.0)
            torque += share * phase * self._contact(approach, compliance, hertz)
        return torque

    def _contact(self, approach_deg: Array, compliance: float, hertz: float) -> Array:
        """Load of a linear and a Hertzian spring in series, as torque of all contacts [N m]."""
        if hertz == 0.0:
            return approach_deg / compliance
        power = self.hertz_exponent
        scale = hertz / RATED_INPUT_TORQUE_NM**power
        load = np.minimum(approach_deg / compliance, (approach_deg / abs(scale)) ** (1.0 / power))
        load = np.maximum(load, 1e-12)
        for _ in range(60):
            miss = compliance * load + scale * load**power - approach_deg
            slope = compliance + scale * power * load ** (power - 1.0)
            following = np.maximum(load - miss / slope, 0.2 * load)
            if np.all(np.abs(following - load) <= 1e-13 + 1e-12 * load):
                load = following
                break
            load = following
        return np.where(approach_deg > 0.0, load, 0.0)
