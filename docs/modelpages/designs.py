"""Designs that the words and the drawings do not agree on: the size of the ports, the stem, the clearance."""

from collections.abc import Mapping

from divideropt.models.divider import FORMULATIONS, parameter_set
from modelpages.options import HEADER, PARAMETERS, cells
from modelpages.runs import run
from modelpages.tables import table


def sizing_table() -> str:
    """Tabulate ports sized by (3.18) for one hole, and for the two there are; `conservative`."""
    rows = []
    for name, label in (("base", "`thesis_base`"), ("prototype", "`thesis_prototype`")):
        p = PARAMETERS[name]
        for parameters, words in ((p, "(3.18) as printed"), (sized_for_two_holes(p), "(3.18) with two holes")):
            found = run(parameters, FORMULATIONS["conservative"])
            drop = f"{found['open_drop'] / 1e6:.2f}"
            rows.append([f"{label}, {words}", drop, *cells(found)[:-1]])
    return table(["", "`open_drop` [MPa]", *HEADER[1:-1]], rows, numbers_from=1)


def sized_for_two_holes(p: Mapping[str, float]) -> dict[str, float]:
    """Return the design whose ports have half the area, by (3.18): as if it counted both holes.

    The fixed drop stays; the ports' drop is four times as large for one hole at the whole flow.
    """
    fixed_drop = p["fixed_drop_ratio"] * p["total_pressure_drop"]
    total = fixed_drop + 4 * (p["total_pressure_drop"] - fixed_drop)
    return {**p, "total_pressure_drop": total, "fixed_drop_ratio": fixed_drop / total}


def drawn_table() -> str:
    """Tabulate what was optimised, what was drawn, and the clearance the text names, in `listing`."""
    optimum, drawn = parameter_set("thesis_optimum"), parameter_set("thesis_prototype")
    designs = {
        "as optimised: B.1 with Table 3.3, stem ratio 0.3": optimum,
        "as drawn: B.2, stem ratio 0.44361": drawn,
        "as drawn, clearance 3 µm (section 3.5.3)": drawn | {"radial_clearance": 3e-6},
    }
    rows = [[label, *cells(run(p, FORMULATIONS["listing"]))] for label, p in designs.items()]
    return table(HEADER, rows, numbers_from=1)
