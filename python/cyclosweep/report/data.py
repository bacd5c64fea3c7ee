"""What a report is made of: the recording, what was predicted, the tables behind the verdict."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep.recording.robust import robust_sigma
from cyclosweep.report.residual_scale import MAY_BE_IN_PLAY_SHARE, scale_deg
from cyclosweep.result import Answer, HeldOutBlock, Hypothesis, NoiseEstimate, answer_of
from cyclosweep.result.stand_in_words import stand_in_words

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOut:
    """Errors on one block of data that was not used.

    Attributes
    ----------
    block : str
        Which samples.
    samples : int
        How many.
    rmse_before_deg, rmse_after_deg : float
        Error of the published model and of the repaired one [deg].
    floor_deg : float or None
        What noise or replicates leave [deg].
    told_before_deg, told_after_deg : float or None
        Where the errors are of a forecast: those of the same models with the flank in contact
        taken from the recording [deg].
    near_before_deg, near_after_deg : float or None
        Where they are: root mean square distance to the predicted curve [deg].
    """

    block: str
    samples: int | None
    rmse_before_deg: float
    rmse_after_deg: float
    floor_deg: float | None = None
    told_before_deg: float | None = None
    told_after_deg: float | None = None
    near_before_deg: float | None = None
    near_after_deg: float | None = None

    @classmethod
    def of(cls, block: HeldOutBlock, noise_deg: float | None) -> "HeldOut":
        """Row of a block; the floor is what replicates leave of a forecast, otherwise the noise.

        Parameters
        ----------
        block : HeldOutBlock
            Errors of a diagnosis.
        noise_deg : float or None
            Standard deviation of the noise [deg].
        """
        return cls(
            block=block.block,
            samples=block.samples,
            rmse_before_deg=block.before_deg,
            rmse_after_deg=block.after_deg,
            floor_deg=block.floor_deg if block.is_forecast else noise_deg,
            told_before_deg=block.told_before_deg,
            told_after_deg=block.told_after_deg,
            near_before_deg=block.near_before_deg,
            near_after_deg=block.near_after_deg,
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class ReportData:
    """Everything a report shows.

    Attributes
    ----------
    recording : Recording
        What was measured.
    result : Answer
        What the diagnosis says; a mapping with the content of ``diagnosis.json`` is read.
    before_deg, after_deg : ndarray of float, shape (n,), or None
        Angle by the calibrated published model and by the repaired model [deg]; None where there
        is nothing to predict from.
    rated_torque_nm : float or None
        Rated torque at the measured shaft [N m].
    ratio : float or None
        Reduction of the drive.
    hypotheses : tuple of Hypothesis
        Rows of the hypothesis table.
    held_out : tuple of HeldOut
        Rows of the held-out table; default: the blocks of the result.
    provenance : mapping of str to str
        Hashes, versions, seeds.
    """

    recording: Recording
    result: Answer
    before_deg: Floats | None = None
    after_deg: Floats | None = None
    rated_torque_nm: float | None = None
    ratio: float | None = None
    hypotheses: tuple[Hypothesis, ...] = ()
    held_out: tuple[HeldOut, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.result, Answer):
            object.__setattr__(self, "result", answer_of(self.result))

    @property
    def held_out_rows(self) -> tuple[HeldOut, ...]:
        """Rows of the held-out table."""
        noise = self.result.noise.sigma_deg
        return self.held_out or tuple(HeldOut.of(b, noise) for b in self.result.repaired.blocks)

    @property
    def residual_before_deg(self) -> Floats | None:
        """Measured minus predicted by the published model [deg]."""
        return self._residual(self.before_deg)

    @property
    def residual_after_deg(self) -> Floats | None:
        """Measured minus predicted by the repaired model [deg]."""
        return self._residual(self.after_deg)

    @property
    def is_repaired(self) -> bool:
        """Whether the repaired model differs from the published one, by effects or stand-ins."""
        return bool(self.result.effects or self.result.repaired.stand_ins)

    @property
    def stand_in_note(self) -> str:
        """Which stand-ins the figures "after" hold, as a sentence to add; empty without any."""
        names = stand_in_words(self.result)
        return f" After: with {names}, which is not named as a cause." if names else ""

    @property
    def scored(self) -> NDArray[np.bool_]:
        """Samples that count: all but conditioning runs and those beyond the limits of [score]."""
        return self.recording.counts

    @cached_property
    def on_the_way_through(self) -> NDArray[np.bool_]:
        """Readings at almost no torque that are wrong by a part of the play."""
        before, after = self.residual_before_deg, self.residual_after_deg
        assert before is not None
        assert after is not None
        torque, scored = self.recording.torque_nm, self.scored
        sigma, _ = self.noise
        light = np.abs(torque) <= MAY_BE_IN_PLAY_SHARE * float(np.abs(torque[scored]).max())
        found = np.zeros(len(torque), dtype=bool)
        for residual in (before, after):
            scale = max(scale_deg(torque[scored], residual[scored]), 4 * sigma)
            found |= light & (np.abs(residual) > 1.2 * scale)
        return found

    @property
    def noise(self) -> tuple[float, float]:
        """Standard deviation [deg] and lag-one autocorrelation of the noise of the samples.

        Of noise of two parts it is the autocorrelation of one part whose means vary as much.
        """
        sigma, rho = self.result.noise.sigma_deg, _of_means(self.result.noise)
        thinning = self.result.thinning
        if thinning is not None and thinning.sample_sigma_deg is not None:
            sigma = thinning.sample_sigma_deg
            if thinning.sample_autocorrelation is not None:
                rho = max(thinning.sample_autocorrelation, 0.0)
        if sigma is None or not np.isfinite(sigma) or sigma <= 0:
            residual = self.residual_after_deg
            sigma = 0.0 if residual is None else robust_sigma(residual)
        return sigma, 0.0 if rho is None or not np.isfinite(rho) else rho

    def _residual(self, predicted: Floats | None) -> Floats | None:
        measured = self.recording.angle_deg
        return None if predicted is None or measured is None else measured - predicted


def _of_means(noise: NoiseEstimate) -> float | None:
    """Autocorrelation of noise of one part whose means vary as much as those of this one."""
    rho, share = noise.autocorrelation, noise.white_share
    if rho is None or share is None or not rho < 1.0 - share:
        return rho
    slow = rho / (1.0 - share)
    inflation = share + (1.0 - share) * (1.0 + slow) / (1.0 - slow)
    return (inflation - 1.0) / (inflation + 1.0)
