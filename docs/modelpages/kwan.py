"""Kwan's estimate of the steady-state error, with the holes that C.2 counts and with those there are."""

from divideropt.models.divider import FORMULATIONS, PARAMETER_SETS, Divider, parameter_set
from divideropt.models.divider.error_budget import error_budget
from modelpages.runs import EXACT
from modelpages.tables import fixed, table

HOLES = FORMULATIONS["conservative"].rim_holes


def kwan_table() -> str:
    """Tabulate the error, the flow force's share of it, and the estimate of that share; `conservative`."""
    rows = []
    for name in PARAMETER_SETS:
        budget = error_budget(Divider(settings=EXACT), parameter_set(name))
        shares = [budget.total, budget.shares["flow_force"], budget.kwan, budget.kwan / HOLES]
        rows.append([f"`{name}`", *(fixed(abs(share), 3) for share in shares)])
    header = [
        "",
        "steady-state error [%]",
        "of it, by the flow force [%]",
        "Kwan's estimate, two holes [%]",
        "one hole, as C.2 [%]",
    ]
    return table(header, rows, numbers_from=1)
