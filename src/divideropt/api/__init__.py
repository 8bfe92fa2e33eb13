"""The commands as functions, for notebooks and scripts: `divideropt.run` is `divideropt run`.

They decide nothing that the commands do not: what they take is checked by the same code, what they raise is worded
by it, and what they return is read from the same stores. Numbers are SI, percentages in percent; a `DataFrame` says
the unit, the symbol and the description of each column in `attrs["units"]`, `attrs["symbols"]` and
`attrs["descriptions"]`.
"""

from divideropt.api.campaigns import check, run
from divideropt.api.designs import Simulated, error_budget, evaluate, simulate
from divideropt.api.sheets import DimensionSheet, sheet
from divideropt.api.stores import Results, export, open, status, verify
from divideropt.api.studies import Compared, Study, compare, sensitivity

__all__ = [
    "Compared",
    "DimensionSheet",
    "Results",
    "Simulated",
    "Study",
    "check",
    "compare",
    "error_budget",
    "evaluate",
    "export",
    "open",
    "run",
    "sensitivity",
    "sheet",
    "simulate",
    "status",
    "verify",
]
