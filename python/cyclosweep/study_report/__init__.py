"""The report of a study: one page that needs nothing else, whatever the study's size."""

from cyclosweep.study_report.write import report_study

__all__ = ["report_study"]
