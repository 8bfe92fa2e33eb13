"""When the load steps: section 3.1's words, `changeall.m` and `divfitag.m`."""

from collections.abc import Mapping

from divideropt.models.divider import FORMULATIONS, Scenario
from divideropt.models.divider.scenario import load_step
from modelpages.options import HEADER, PARAMETERS, cells
from modelpages.runs import Run, run
from modelpages.tables import fixed, table

SETS = ("base", "prototype")

STARTS = {
    "settled (section 3.1)": Scenario(),
    "empty, step at 0.6 s (`changeall.m`)": Scenario(settled=False, events=(load_step(1, 15e6, at=0.6),)),
    "empty, step at 50 ms (`divfitag.m`)": Scenario(settled=False, events=(load_step(1, 15e6, at=0.05),)),
}
"""The scenarios by the row's label."""


def starts_table(formulation: str) -> str:
    """Tabulate the starts for the base set and the prototype, and say what the early step changes."""
    runs = {
        name: {
            label: run(PARAMETERS[name], FORMULATIONS[formulation], scenario) for label, scenario in STARTS.items()
        }
        for name in SETS
    }
    rows = [[f"`thesis_{name}`, {label}", *cells(found)[:-1]] for name in SETS for label, found in runs[name].items()]
    dynamic, settling = (_growth(runs, quantity) for quantity in ("dynamic_error", "settling_time"))
    words = (
        "Steady-state error and source pressure do not notice the step at 50 ms; "
        f"the dynamic error grows by {dynamic} % and the settling time by {settling} %."
    )
    return f"{table(HEADER[:-1], rows, numbers_from=1)}\n\n{words}"


def _growth(runs: Mapping[str, Mapping[str, Run]], quantity: str) -> str:
    """From the first start to the last, base set and prototype."""
    first, *_, last = STARTS
    return " and ".join(fixed(100 * (runs[s][last][quantity] / runs[s][first][quantity] - 1), 1) for s in SETS)
