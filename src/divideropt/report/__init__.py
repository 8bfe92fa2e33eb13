"""The report: a store to one HTML file to look at, which asks nothing of any server."""

from divideropt.report.comparison import comparison_data, comparison_table, comparison_text
from divideropt.report.page import write_report
from divideropt.report.response_page import Curve, ResponseCurves, response_page, write_response
from divideropt.report.sensitivity_data import read_study
from divideropt.report.sensitivity_page import study_text, write_study
from divideropt.report.sheet_text import sheet_svg, sheet_text
from divideropt.report.sweeps_page import write_sweeps

__all__ = [
    "Curve",
    "ResponseCurves",
    "comparison_data",
    "comparison_table",
    "comparison_text",
    "read_study",
    "response_page",
    "sheet_svg",
    "sheet_text",
    "study_text",
    "write_report",
    "write_response",
    "write_study",
    "write_sweeps",
]
