"""How far the pilot stage can be believed, and what a loss at the grooves' ends changes."""

from dataclasses import replace

from divideropt.models.divider import FORMULATIONS, PARAMETER_SETS, parameter_set
from modelpages.options import HEADER, cells
from modelpages.runs import run
from modelpages.tables import fixed, table


def validity_table() -> str:
    """Tabulate the groove quantities of the named sets, without and with the loss."""
    rows = []
    for name in PARAMETER_SETS:
        for label, loss in ((f"`{name}`", False), (f"`{name}`, `groove_loss: entrance`", True)):
            found = run(parameter_set(name), replace(FORMULATIONS["conservative"], groove_loss=loss))
            rows.append(
                [
                    label,
                    fixed(found["groove_reynolds"], 0),
                    fixed(found["groove_velocity_ratio"], 2),
                    fixed(100 * found["pilot_share"], 1),
                    "yes" if found["within_validity"] else "no",
                ]
            )
    header = ["", "`groove_reynolds`", "`groove_velocity_ratio`", "`pilot_share` [%]", "`within_validity`"]
    return table(header, rows, numbers_from=1)


def groove_loss_table() -> str:
    """Tabulate the standard test of the named sets, without and with the loss."""
    rows = []
    for name in PARAMETER_SETS:
        for label, loss in ((f"`{name}`", False), (f"`{name}`, `groove_loss: entrance`", True)):
            reading = replace(FORMULATIONS["conservative"], groove_loss=loss)
            rows.append([label, *cells(run(parameter_set(name), reading))])
    return table(HEADER, rows, numbers_from=1)
