"""Reports of a diagnosis: one HTML page, PNG pictures, a terminal summary."""

from cyclosweep.report.data import HeldOut, ReportData
from cyclosweep.report.html import write_html
from cyclosweep.report.png import write_png
from cyclosweep.report.terminal import print_summary, summary
from cyclosweep.report.write import write_report

__all__ = [
    "HeldOut",
    "ReportData",
    "print_summary",
    "summary",
    "write_html",
    "write_png",
    "write_report",
]
