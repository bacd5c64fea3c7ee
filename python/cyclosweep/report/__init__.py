"""Reports of a diagnosis: one HTML page, PNG pictures, a terminal summary."""

from cyclosweep.report.data import HeldOut, Hypothesis, ReportData
from cyclosweep.report.html import write_html

__all__ = ["HeldOut", "Hypothesis", "ReportData", "write_html"]
