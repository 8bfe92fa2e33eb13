"""The divider's reference figures: check values, leakage, and what the clearance does in either formulation.

Run it with `python benchmarks/reference_figures.py`; it takes some seconds.
"""

import math

import numpy as np

from divideropt.models.divider import FORMULATIONS, QUANTITIES, Divider, Scenario, parameter_set, solver_settings
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.equilibrium import find_equilibrium, initial_guess


def main() -> None:
    """Print the tables."""
    print("Check values, conservative, settled, standard test, Radau at rtol 1e-10")
    print(f"{'':18}{'error [%]':>14}{'Ps [Pa]':>14}{'dyn. error [m3]':>17}{'settling [s]':>14}{'leakage [m3/s]':>16}")
    for name in ("thesis_base", "thesis_prototype"):
        model = Divider(settings=solver_settings("Radau", 1e-10))
        row, _ = model.evaluate(np.array([list(parameter_set(name).values())]))
        q = dict(zip(QUANTITIES, row[0], strict=True))
        print(
            f"{name:18}{q['steady_state_error']:14.8f}{q['source_pressure']:14.1f}{q['dynamic_error']:17.6e}"
            f"{q['settling_time']:14.7f}{q['leakage']:16.6e}"
        )
    print("\nAt the base set's equilibrium after the step, 10 → 15 MPa")
    print(f"{'':18}{'fluid from nowhere [m3/s]':>28}{'steady-state error [%]':>24}")
    for formulation in FORMULATIONS:
        for clearance in (1e-6, 2.9e-6, 20e-6):
            made, error = balance(formulation, clearance)
            print(f"{formulation:14}{clearance * 1e6:4.1f} {made:27.2e}{error:24.3f}")


def balance(formulation: str, clearance: float) -> tuple[float, float]:
    """Return QL1 + QL2 + end-seal leakage - Qs [m^3/s] and the steady-state error [%] at the equilibrium."""
    p = parameter_set("thesis_base") | {"radial_clearance": clearance}
    design = Valve.of(p, FORMULATIONS[formulation]).under(Scenario().spans()[-1].inputs)
    rest = find_equilibrium(design, initial_guess(design))
    if rest is None:
        return math.nan, math.nan
    d, y = design[0], rest.state
    first, second = d.load_1 * math.sqrt(y[7]), d.load_2 * math.sqrt(y[8])
    seals = d.seal_leakage * (y[3] + y[4])
    return float(first + second + seals - d.source_flow), float(100 * (first - second) / d.source_flow)


if __name__ == "__main__":
    main()
