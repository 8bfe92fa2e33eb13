"""The report: a store to one HTML file to look at, which asks nothing of any server."""

from divideropt.report.comparison import comparison_data, comparison_table, comparison_text
from divideropt.report.page import write_report
from divideropt.report.response_page import Curve, ResponseCurves, response_page, write_response
from divideropt.report.sweeps_page import write_sweeps

__all__ = [
    "Curve",
    "ResponseCurves",
    "comparison_data",
    "comparison_table",
    "comparison_text",
    "response_page",
    "write_report",
    "write_response",
    "write_sweeps",
]
