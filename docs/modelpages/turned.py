"""What the error of a turned spool is made of, with equal loads."""

from dataclasses import replace

from divideropt.models.divider import FORMULATIONS, Scenario, parameter_set
from modelpages.runs import run
from modelpages.tables import fixed, table

POSITIONS = (0.3, 0.4)
"""φ/φ0; 0.7 and 0.6 are their mirror images."""

NO_RIMS = {"rim_thickness": 0.0}


def turned_table() -> str:
    """Tabulate the error before the step with the causes on and off; `conservative`, base set, loads 10 MPa."""
    base, whole = parameter_set("thesis_base"), FORMULATIONS["conservative"]
    closed = replace(whole, pilot_bypass=False)
    cases = ((base, whole), (base, closed), (base | NO_RIMS, whole), (base | NO_RIMS, closed))
    rows = []
    for position in POSITIONS:
        runs = [run(p, formulation, Scenario(spool_position=position)) for p, formulation in cases]
        rows.append([f"{position}", *(fixed(abs(found["ratio_bias"]), 3) for found in runs)])
    header = ["φ/φ₀", "error [%]", "without the pilot flow [%]", "without rims [%]", "without both [%]"]
    return table(header, rows, numbers_from=1)
