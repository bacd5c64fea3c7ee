"""Panels of a residual: the axis that shows the region best, dots, noise and what is modelled."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep.report.charts import FAINT, QUIET, Band, Panel, Points, Series
from cyclosweep.report.data import ReportData
from cyclosweep.report.dots import ResidualDots, dot_size, residual_dots
from cyclosweep.report.regions import axis_values, residual_axis, spans_of
from cyclosweep.report.wording import ARCMIN, number

__all__ = ["Residual", "ResidualAxis"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ResidualAxis:
    """Axis along which the first region is seen best, and what is drawn over it.

    Attributes
    ----------
    quantity, label : str
        What it is, and its label with the unit.
    x : ndarray, shape (n,)
        Place of every sample.
    rows : ndarray of int
        Samples that are drawn.
    dots : ResidualDots
        Where the dots stand, and which of them lie in the region.
    """

    quantity: str
    label: str
    x: Floats
    rows: NDArray[np.int64]
    dots: ResidualDots

    @classmethod
    def of(cls, data: ReportData, rows: NDArray[np.int64]) -> "ResidualAxis":
        """Axis for some samples."""
        quantity = residual_axis(data)
        x, label = axis_values(data.recording, quantity)
        return cls(quantity, label, x, rows, residual_dots(data, rows, x))


@dataclass(frozen=True)
class Residual:
    """A residual to be drawn.

    Attributes
    ----------
    title, colour : str
        What it is called, and the colour of the dots in the region.
    residual_deg : ndarray, shape (n,)
        Of each sample [deg].
    fitted_deg : float or None
        Error of the fit, where one was made [deg].
    model : tuple of Series
        Lines drawn over the dots.
    labelled : bool
        Whether the name of the region stands in the panel.
    """

    title: str
    colour: str
    residual_deg: Floats
    fitted_deg: float | None
    model: tuple[Series, ...]
    labelled: bool

    def panel(self, data: ReportData, axis: ResidualAxis, dot_deg: Floats) -> Panel:
        """Residual over its axis.

        Parameters
        ----------
        data : ReportData
        axis : ResidualAxis
        dot_deg : ndarray
            Residual of each dot [deg].

        Returns
        -------
        Panel
        """
        dots = axis.dots
        rmse = float(np.sqrt(np.mean(self.residual_deg[data.scored] ** 2)))
        fitted, inside, size = self.fitted_deg, dots.located, dot_size(len(dots.x))
        words = f"{number(rmse)} deg rms" if fitted is None else f"fit error {number(fitted)} deg"
        return Panel(
            title=f"{self.title}: {words}",
            x_label=axis.label,
            y_label="residual (deg)",
            series=(
                *_noise_band(axis.x[axis.rows], dots.sigma_deg),
                Points(dots.x[~inside], dot_deg[~inside], "", FAINT, size),
                Points(dots.x[inside], dot_deg[inside], "", self.colour, size),
                *self.model,
            ),
            spans=tuple(spans_of(data, axis.quantity, labelled=self.labelled)),
            y_range=(-dots.limit_deg, dots.limit_deg),
            right_factor=ARCMIN,
            right_label="residual (arcmin)",
            zero_line=True,
        )


def _noise_band(x: Floats, sigma: float) -> tuple[Band, ...]:
    """Two standard deviations either side of zero."""
    if sigma <= 0 or not len(x):
        return ()
    ends = np.array([x.min(), x.max()])
    return (Band(ends, np.full(2, -2 * sigma), np.full(2, 2 * sigma), "noise ±2σ", QUIET),)
