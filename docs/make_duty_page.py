"""`docs/model/duty.md`: what the front of `divider.yaml` does with the ratio set and over a duty, and what is better.

Run the three campaigns, then `python docs/make_duty_page.py results/divider results/ratio results/duty`; a minute.
"""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
from modelpages.blocks import fill
from modelpages.tables import fixed, table
from scipy.optimize import brentq

from divideropt.analysis import hypervolume, nondominated
from divideropt.campaign.config import Campaign
from divideropt.campaign.load import stored_campaign
from divideropt.campaign.plan import build_problem, dividers, reference_of
from divideropt.models.base import FloatArray
from divideropt.models.divider import Divider, Scenario, load_step
from divideropt.models.divider.scenarios import BASE, Scenarios, column_of
from divideropt.problem import Objective, Problem
from divideropt.problem.aggregate import goal_attainment
from divideropt.store import Store

PAGE = Path(__file__).parent / "model" / "duty.md"
CAMPAIGNS = ("divider", "ratio", "duty")
BETWEEN = 37.5 / 6e4
"""A source flow between those of `duty.yaml` [m^3/s]."""

COLUMNS: Mapping[str, tuple[str, float, int]] = {
    "steady_state_error": ("`steady_state_error` [%]", 1.0, 2),
    "ratio_bias": ("`ratio_bias` [%]", 1.0, 2),
    "load_regulation": ("`load_regulation` [%]", 1.0, 2),
    "dynamic_error": ("`dynamic_error` [mL]", 1e6, 2),
    "source_pressure": ("`source_pressure` [MPa]", 1e-6, 2),
    "settling_time": ("`settling_time` [ms]", 1e3, 0),
}
"""What is tabulated of a design in a scenario: heading, factor from SI, digits."""

HEADINGS = tuple(heading for heading, _, _ in COLUMNS.values())

VARIABLES = (("r [mm]", 1e3, 2), ("b [mm]", 1e3, 2), ("ΔPt [MPa]", 1e-6, 2), ("ΔPo/ΔPt", 1.0, 3), ("FO", 1.0, 3))
"""Of all three campaigns: heading, factor from SI, digits."""

LEFT_OUT = "_2"
"""Ends the names of the scenarios of `duty.yaml` that are not tabulated: another with left and right exchanged."""

Results = Mapping[str, FloatArray]
"""Quantities of some designs by name, each of shape (n,)."""


@dataclass(frozen=True)
class Front:
    """A campaign's combined front, and the problem it was found for."""

    name: str
    folder: Path

    @cached_property
    def table(self) -> pd.DataFrame:
        """The front as stored."""
        return pd.read_parquet(self.folder / "fronts" / "combined.parquet")

    @cached_property
    def campaign(self) -> Campaign:
        """The campaign as resolved."""
        return stored_campaign(Store(self.folder))

    @cached_property
    def problem(self) -> Problem:
        """What was optimised."""
        return build_problem(self.campaign)

    def results(self, designs: FloatArray) -> Results:
        """Every quantity of designs, shape (n, d), under the problem."""
        return dict(zip(self.problem.model.quantities, self.problem.simulate(designs).quantities.T, strict=True))

    @cached_property
    def designs(self) -> FloatArray:
        """The variables, shape (n, d)."""
        return self.table[list(self.problem.space.names)].to_numpy()

    @cached_property
    def best(self) -> int:
        """Row of the best design by goal attainment."""
        told = self.problem.tell(self.problem.simulate(self.designs))
        return int(np.argmin(goal_attainment(told.F, self.problem.objectives)))

    @property
    def label(self) -> str:
        """Name of the best design and of its campaign."""
        return f"`{self.name}.yaml`, `{self.table['design_id'][self.best]}`"


def main(folders: Sequence[Path]) -> None:
    """Write the page."""
    centred, ratio, duty = (Front(name, folder) for name, folder in zip(CAMPAIGNS, folders, strict=True))
    blocks = {
        "turned-alone": turned_alone(centred),
        "turned-front": turned_front(centred),
        "ratio-centred": by_scenario(centred, ratio),
        "rotated": rotated(centred, ratio),
        "ratio-fronts": fronts_table(centred, ratio),
        "ratio-lost": lost(centred, ratio),
        "ratio-new": by_scenario(ratio, ratio),
        "duty-centred": by_scenario(centred, duty),
        "duty-fronts": fronts_table(centred, duty),
        "duty-lost": lost(centred, duty),
        "duty-new": by_scenario(duty, duty),
        "designs": designs_table((centred, ratio, duty)),
        "between": between(duty),
        "cost": cost((centred, ratio, duty)),
    }
    PAGE.write_text(fill(PAGE.read_text("utf-8"), blocks), "utf-8")
    print(PAGE)


def turned_alone(front: Front) -> str:
    """Tabulate the best design with its spool turned and the load orifices left as they are."""
    rows = []
    for position in (0.5, 0.3):
        for load in (1, 2):
            scenario = Scenario(spool_position=position, events=(load_step(load, 15e6),))
            rows.append([f"{position:g}", str(load), *cells(measured(front, scenario))])
    return table(["φ/φ0", "load that steps", *HEADINGS], rows, numbers_from=0)


def turned_front(front: Front) -> str:
    """Say what the whole front does with its spool turned and the load orifices left as they are."""
    columns = []
    for position in (0.5, 0.3):
        problem = in_scenario(front, Scenario(spool_position=position, events=(load_step(2, 15e6),)))
        found = problem.simulate(front.designs)
        ok = np.array([verdict.ok for verdict in found.verdicts])
        values = dict(zip(problem.model.quantities, found.quantities.T, strict=True))
        columns.append((ok, np.abs(values["steady_state_error"]), np.abs(values["ratio_bias"])))
    (_, centred, _), (ok, error, bias) = columns
    about = ok & (np.abs(centred - 0.4) < 0.05)
    low, middle, high = np.quantile(error[about], (0.0, 0.5, 1.0))
    part = np.median(bias[about] / error[about])
    return (
        f"{int(ok.sum())} of the {len(ok)} designs on that front end ok at φ/φ0 = 0.3 with a step of load 2. The "
        f"{int(about.sum())} of them whose error is\n0.35 to 0.45 % with the spool centred have {fixed(low, 1)} to "
        f"{fixed(high, 1)} % there, {fixed(middle, 1)} % in the median; the bias is {fixed(part, 2)} times as large "
        "as the error (median)."
    )


def by_scenario(found: Front, asked: Front) -> str:
    """Tabulate the best design of a front in a problem's scenarios, of `duty.yaml` those where load 1 steps."""
    results = asked.results(found.designs[found.best][None])
    rows = [
        [f"`{name}`", *cells({q: results[column_of(name, q)] for q in COLUMNS})]
        for name in scenarios(asked)
        if asked.name != "duty" or not name.endswith(LEFT_OUT)
    ]
    return table([f"scenario; {found.label}", *HEADINGS], rows, numbers_from=1)


def rotated(front: Front, ratio: Front) -> str:
    """Say what is left of the error when the spool is turned on until the flows before the step are as wanted."""
    rows = []
    for name in ("low_load_1", "low_load_2"):
        plain = scenarios(ratio)[name].scenario
        wanted = 1.0 - plain.spool_position

        def lacking(position: float, plain: Scenario = plain, wanted: float = wanted) -> float:
            found = measured(front, replace(plain, spool_position=position))
            return share(found) - float(found["load_regulation"][0]) / 100.0 - wanted

        position = brentq(lacking, 0.05, plain.spool_position, xtol=1e-8)
        before, after = measured(front, plain), measured(front, replace(plain, spool_position=position))
        numbers = [cell(before, "steady_state_error"), cell(before, "ratio_bias"), fixed(position, 3)]
        off = [
            fixed(100.0 * abs(s / w - 1.0), 2)
            for s, w in zip((share(after), 1 - share(after)), (wanted, 1 - wanted), strict=True)
        ]
        rows.append([f"`{name}`", *numbers, cell(after, "load_regulation"), *off])
    header = [
        "scenario",
        "`steady_state_error` as set [%]",
        "`ratio_bias` as set [%]",
        "φ/φ0 that makes 70 : 30 before the step",
    ]
    header += ["`load_regulation` there [%]", "error of load 1 after the step [%]", "of load 2 [%]"]
    return table(header, rows, numbers_from=1)


def fronts_table(centred: Front, asked: Front) -> str:
    """Lay the front of `divider.yaml`, simulated again under a problem, beside the problem's own."""
    objectives, reference = asked.problem.objectives, reference_of(asked.campaign)
    assert reference is not None
    told = [asked.problem.tell(asked.problem.simulate(front.designs)) for front in (centred, asked)]
    values = [t.F[t.feasible] for t in told]
    stays = np.split(nondominated(np.concatenate(values)), [len(values[0])])
    rows = []
    for front, points, kept in zip((centred, asked), values, stays, strict=True):
        least = [fixed(float(points[:, i].min()) * unit(o)[1], 2) for i, o in enumerate(objectives)]
        best = fixed(float(goal_attainment(points, objectives).min()), 3)
        numbers = [str(len(front.designs)), str(len(points)), *least, best, fixed(hypervolume(points, reference), 4)]
        rows.append([f"`{front.name}.yaml`", *numbers, str(int(kept.sum()))])
    names = [f"least `{o.quantity.name}` [{unit(o)[0]}]" for o in objectives]
    header = ["front of", "designs", "feasible here", *names, "best max λ", "hypervolume", "not beaten by the other"]
    return table(header, rows, numbers_from=1)


def lost(centred: Front, asked: Front) -> str:
    """Say why designs of the front of `divider.yaml` are not feasible under a problem."""
    found = asked.problem.simulate(centred.designs)
    told = asked.problem.tell(found)
    outcomes = Counter(str(verdict.outcome) for verdict in found.verdicts if not verdict.ok)
    broken = int((~told.feasible).sum()) - outcomes.total()
    words = [f"{count} `{name}`" for name, count in outcomes.most_common()]
    return (
        f"Of the {len(told.F)} designs of `divider.yaml`, {int((~told.feasible).sum())} are not feasible there: in a "
        f"scenario they end {', '.join(words)};\n{broken} end ok everywhere and break a constraint."
    )


def designs_table(fronts: Sequence[Front]) -> str:
    """Tabulate the best design of each front, and what it does under each problem."""
    rows = []
    for front in fronts:
        design = front.designs[front.best]
        variables = [
            fixed(float(v) * factor, digits) for v, (_, factor, digits) in zip(design, VARIABLES, strict=True)
        ]
        attained = []
        for asked in fronts:
            told = asked.problem.tell(asked.problem.simulate(design[None]))
            value = float(goal_attainment(told.F, asked.problem.objectives)[0])
            attained.append(fixed(value, 2) if told.feasible[0] else "not feasible")
        rows.append([front.label, *variables, *attained])
    header = [
        "best of",
        *(heading for heading, _, _ in VARIABLES),
        *(f"max λ in `{front.name}.yaml`" for front in fronts),
    ]
    return table(header, rows, numbers_from=1)


def between(duty: Front) -> str:
    """Say whether a flow between the ends of `duty.yaml` is ever worse than both."""
    assert isinstance(duty.problem.model, Scenarios)
    model, ends = duty.problem.model, scenarios(duty)
    full = [name for name in ends if name.startswith("full_")]
    models = {name: replace(ends[name], scenario=replace(ends[name].scenario, source_flow=BETWEEN)) for name in full}
    middle = Scenarios({BASE: ends[BASE], **models}, (), model.changes)
    problem = replace(duty.problem, model=middle, objectives=(), constraints=())
    found = problem.simulate(duty.designs)
    columns = dict(zip(middle.quantities, found.quantities.T, strict=True))
    ok = np.array([verdict.ok for verdict in found.verdicts])
    stored = duty.results(duty.designs)
    words = []
    for objective in duty.problem.objectives:
        plain = objective.quantity.name.removeprefix("worst.")
        there = np.abs([columns[column_of(name, plain)] for name in full]).max(axis=0)
        worst = np.abs(stored[objective.quantity.name])
        words.append(f"{int((there > worst)[ok].sum())} in `{plain}`")
    return (
        f"At {BETWEEN * 6e4:g} L/min, {int(ok.sum())} of the {len(ok)} designs on the front of `duty.yaml` end ok "
        f"in all eight scenarios.\nOf those, so many are worse there than at both ends: {', '.join(words)}."
    )


def cost(fronts: Sequence[Front]) -> str:
    """Tabulate how much was simulated, and how the simulations ended."""
    rows = []
    for front in fronts:
        parts = front.folder.glob("evaluations/*/part-*.parquet")
        outcomes = pd.concat([pd.read_parquet(path, columns=["outcome"]) for path in sorted(parts)])["outcome"]
        verified = front.table["verified"].value_counts()
        count = len(scenarios(front))
        words = f"{verified.get('yes', 0)} / {verified.get('deviates', 0)}"
        ok = f"{100.0 * (outcomes == 'ok').mean():.0f}"
        rows.append([f"`{front.name}.yaml`", str(count), str(len(outcomes)), ok, str(len(front.table)), words])
    header = ["campaign", "scenarios", "evaluations", "ended ok [%]", "front", "verified: yes / deviates"]
    return table(header, rows, numbers_from=1)


def scenarios(front: Front) -> Mapping[str, Divider]:
    """The divider under each scenario of a front's problem."""
    return dividers(front.problem.model)


def measured(front: Front, scenario: Scenario) -> Results:
    """Quantities of the best design of a front in another scenario."""
    problem = in_scenario(front, scenario)
    found = problem.simulate(front.designs[front.best][None])
    return dict(zip(problem.model.quantities, found.quantities.T, strict=True))


def in_scenario(front: Front, scenario: Scenario) -> Problem:
    """A front's problem with another scenario in place of all, and nothing to reach."""
    model = replace(scenarios(front)[BASE], scenario=scenario)
    return replace(front.problem, model=model, objectives=(), constraints=())


def share(found: Results) -> float:
    """Load 1's share of both loads' flow at the end."""
    first, second = (float(found[f"load_flow_{i}"][0]) for i in (1, 2))
    return first / (first + second)


def cells(found: Results) -> list[str]:
    """Write a design's quantities."""
    return [cell(found, name) for name in COLUMNS]


def cell(found: Results, name: str) -> str:
    """Write one of them, without its sign."""
    _, factor, digits = COLUMNS[name]
    return fixed(abs(float(found[name][0])) * factor, digits)


def unit(objective: Objective) -> tuple[str, float]:
    """The unit that is printed, and the factor to it."""
    return {"%": ("%", 1.0), "m^3": ("mL", 1e6), "Pa": ("MPa", 1e-6)}[objective.quantity.unit]


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:4]])
