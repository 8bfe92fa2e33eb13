"""When the load steps: section 3.1's words, `changeall.m` and `divfitag.m`."""

from divideropt.models.divider import FORMULATIONS, Scenario
from divideropt.models.divider.scenario import load_step
from modelpages.options import HEADER, PARAMETERS, cells
from modelpages.runs import run
from modelpages.tables import table

STARTS = {
    "settled (section 3.1)": Scenario(),
    "empty, step at 0.6 s (`changeall.m`)": Scenario(settled=False, events=(load_step(1, 15e6, at=0.6),)),
    "empty, step at 50 ms (`divfitag.m`)": Scenario(settled=False, events=(load_step(1, 15e6, at=0.05),)),
}
"""The scenarios by the row's label."""


def starts_table(formulation: str) -> str:
    """Tabulate the starts for the base set and the prototype."""
    rows = [
        [f"`thesis_{name}`, {label}", *cells(run(PARAMETERS[name], FORMULATIONS[formulation], scenario))[:-1]]
        for name in ("base", "prototype")
        for label, scenario in STARTS.items()
    ]
    return table(HEADER[:-1], rows, numbers_from=1)
