"""`docs/model/sound.md`: the front of `sound.yaml` beside that of `divider.yaml` and the thesis's own designs.

Run both campaigns, then `python docs/make_sound_page.py results/divider results/sound`; it takes seconds.
"""

import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from modelpages.blocks import fill
from modelpages.chart import Line, Panel, draw
from modelpages.tables import fixed, table

from divideropt.analysis import nondominated
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models.base import FloatArray
from divideropt.models.divider import PARAMETER_SETS, parameter_set
from divideropt.problem import Problem
from divideropt.problem.aggregate import goal_attainment
from divideropt.store import Store

HERE = Path(__file__).parent
PAGE, PICTURE = HERE / "model" / "sound.md", HERE / "images" / "model" / "sound.svg"
CAPS = (20e6, 24e6)
"""Source pressures [Pa] below which the best trade of the two errors is drawn."""

COLUMNS: Mapping[str, tuple[str, float, int]] = {
    "steady_state_error": ("`steady_state_error` [%]", 1.0, 2),
    "dynamic_error": ("`dynamic_error` [mL]", 1e6, 2),
    "source_pressure": ("`source_pressure` [MPa]", 1e-6, 2),
    "settling_time": ("`settling_time` [ms]", 1e3, 0),
    "groove_reynolds": ("`groove_reynolds`", 1.0, 0),
    "groove_velocity_ratio": ("`groove_velocity_ratio`", 1.0, 2),
    "pilot_share": ("`pilot_share` [%]", 100.0, 1),
}
"""What is tabulated: heading, factor from SI, digits."""


def main(divider: Path, sound: Path) -> None:
    """Write the page and its picture."""
    stores = {"divider": divider, "sound": sound}
    fronts = {name: pd.read_parquet(path / "fronts" / "combined.parquet") for name, path in stores.items()}
    problems = {name: build_problem(stored_campaign(Store(path))) for name, path in stores.items()}
    blocks = {
        "fronts": front_table(fronts),
        "best": best_table(fronts, problems),
        "carried-over": carried_over(fronts["divider"], problems["sound"]),
        "thesis": thesis_table(problems),
        "outcomes": outcomes(stores),
    }
    PAGE.write_text(fill(PAGE.read_text("utf-8"), blocks), "utf-8")
    PICTURE.write_text(picture(fronts), "utf-8")
    print(PAGE, PICTURE, sep="\n")


def front_table(fronts: Mapping[str, pd.DataFrame]) -> str:
    """Tabulate what is on either front."""
    rows = []
    for name, front in fronts.items():
        verified = front["verified"].value_counts()
        rows.append(
            [
                f"`{name}.yaml`",
                str(len(front)),
                f"{100 * front['within_validity'].mean():.0f}",
                *(spread(front[column].abs() * factor, digits) for column, (_, factor, digits) in COLUMNS.items()),
                f"{verified.get('yes', 0)} / {verified.get('no', 0)} / {verified.get('deviates', 0)}",
            ]
        )
    header = ["front", "designs", "within validity [%]", *(heading for heading, _, _ in COLUMNS.values())]
    return table([*header, "verified: yes / no / deviates"], rows, numbers_from=1)


def spread(values: "pd.Series[float]", digits: int) -> str:
    """Write the range and the median."""
    low, middle, high = values.quantile([0.0, 0.5, 1.0])
    return f"{fixed(low, digits)}…{fixed(high, digits)}, median {fixed(middle, digits)}"


def best_table(fronts: Mapping[str, pd.DataFrame], problems: Mapping[str, Problem]) -> str:
    """Tabulate the best design of either front by goal attainment."""
    rows = []
    for name, front in fronts.items():
        problem = problems[name]
        objectives = np.column_stack([front[o.quantity.name].abs() for o in problem.objectives])
        value = goal_attainment(objectives, problem.objectives)
        best = front.iloc[int(np.argmin(value))]
        rows.append([f"`{name}.yaml`, `{best.design_id}`", fixed(float(value.min()), 3), *cells(best)])
    return table(["best by (3.24)", "max λ", *(heading for heading, _, _ in COLUMNS.values())], rows, numbers_from=1)


def thesis_table(problems: Mapping[str, Problem]) -> str:
    """Tabulate the thesis's designs as either campaign simulates them."""
    rows = []
    for label in PARAMETER_SETS:
        for name, problem in problems.items():
            found = simulated(problem, pd.DataFrame([parameter_set(label)])[list(problem.model.parameters)])
            valid = "yes" if found["within_validity"].iloc[0] else "no"
            rows.append([f"`{label}`, as `{name}.yaml` has it", *cells(found.iloc[0]), valid])
    header = ["design", *(heading for heading, _, _ in COLUMNS.values()), "`within_validity`"]
    return table(header, rows, numbers_from=1)


def carried_over(front: pd.DataFrame, problem: Problem) -> str:
    """Say what becomes of the front of `divider.yaml` where the grooves' losses are paid for."""
    full = pd.DataFrame([dict(problem.fixed)] * len(front))
    full[list(problem.space.names)] = front[list(problem.space.names)].to_numpy()
    found = simulated(problem, full[list(problem.model.parameters)])
    told = problem.tell(problem.simulate(front[list(problem.space.names)].to_numpy()))
    names = list(COLUMNS)[:4]
    ratio = {name: float(np.nanmedian(np.abs(found[name]) / front[name].abs().to_numpy())) for name in names}
    still = int(nondominated(told.F[told.feasible]).sum())
    return (
        f"Of the {len(front)} designs on the front of `divider.yaml`, {int(told.feasible.sum())} are feasible in "
        f"`sound.yaml`; {still} of those are still non-dominated among themselves.\nWith the losses the steady-state "
        f"error is {ratio['steady_state_error']:.2f} times what it was without (median), the dynamic error "
        f"{ratio['dynamic_error']:.2f} times,\nthe source pressure {ratio['source_pressure']:.2f} times, the "
        f"settling time {ratio['settling_time']:.2f} times."
    )


def outcomes(stores: Mapping[str, Path]) -> str:
    """Say how many simulations the solver gave up."""
    words = []
    for name, path in stores.items():
        parts = sorted((path / "evaluations").glob("*/part-*.parquet"))
        found = pd.concat([pd.read_parquet(part, columns=["outcome"]) for part in parts])["outcome"]
        words.append(f"{int((found == 'not_completed').sum())} of the {len(found)} simulations of `{name}.yaml`")
    return f"The solver did not complete {' and '.join(words)} (`not_completed`)."


def simulated(problem: Problem, full: pd.DataFrame) -> pd.DataFrame:
    """Every quantity of whole designs."""
    quantities, _ = problem.model.evaluate(full.to_numpy(dtype=np.float64))
    return pd.DataFrame(quantities, columns=list(problem.model.quantities))


def cells(row: "pd.Series[float]") -> list[str]:
    """Write a design's quantities."""
    return [fixed(abs(float(row[name])) * factor, digits) for name, (_, factor, digits) in COLUMNS.items()]


def picture(fronts: Mapping[str, pd.DataFrame]) -> str:
    """Draw the best trade between the two errors below some source pressures."""
    strokes = {"divider": (1, "dash"), "sound": (0, "solid")}
    panels = []
    for cap in CAPS:
        lines = []
        for name, front in fronts.items():
            below = front[front["source_pressure"] <= cap]
            x, y = staircase(below["steady_state_error"].to_numpy(), below["dynamic_error"].abs().to_numpy() * 1e6)
            lines.append(Line(f"{name}.yaml", x, y, *strokes[name]))
        goal = Line("goals", np.array([0.5, 0.5, 0.0]), np.array([0.0, 0.5, 0.5]), 3, "dot")
        panels.append(
            Panel(
                [*lines, goal],
                "steady-state error [%]",
                "dynamic error [mL]",
                f"source pressure up to {cap / 1e6:g} MPa",
                (0.0, 4.0),
                (0.0, 5.0),
            )
        )
    return draw(panels, "Least dynamic error against steady-state error on the fronts of divider.yaml and sound.yaml")


def staircase(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The least y reached at each x or below, as the corners of a staircase."""
    order = np.argsort(x, kind="stable")
    x, y = x[order], np.minimum.accumulate(y[order])
    keep = np.r_[True, np.diff(y) < 0]
    x, y = x[keep], y[keep]
    return np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1]


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
