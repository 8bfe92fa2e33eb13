"""A design as a workshop would make it: its dimensions rounded to a step, and what the valve then does.

Rounded are the dimensions that a workshop makes to a figure (those with `made_of`) and that hang on a variable of
the campaign. What the campaign fixes is held: somebody chose it. A clearance is held always: it is a fit, two ground
parts measured against each other, and of another order than any step. All else follows from these.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_HALF_EVEN, Decimal

import numpy as np

from divideropt.models import Verdict
from divideropt.models.base import VALIDITY, FloatArray
from divideropt.models.dimensions import Dimensioned
from divideropt.problem import Evaluations, Problem, simulate
from divideropt.problem.criteria import Values

MICROMETRE = 1e-6
"""In m."""


@dataclass(frozen=True)
class Judged:
    """A design, its dimensions, and how the campaign judges it.

    Attributes:
        parameters: Every parameter by name.
        dimensions: Every dimension by name.
        objectives: As minimised, of signed quantities the magnitude; NaN where not defined. In the problem's order.
        constraints: The bounded quantities, likewise.
        verdict: How the simulation ended.
        feasible: Whether it ended well and every constraint is met.
        met: Whether each objective's goal is met, None where it has none.
        valid: Whether the model vouches for it (`within_validity`), None where it does not say.
    """

    parameters: Mapping[str, float]
    dimensions: Mapping[str, float]
    objectives: tuple[float, ...]
    constraints: tuple[float, ...]
    verdict: Verdict
    feasible: bool
    met: tuple[bool | None, ...]
    valid: bool | None


def rounded_names(problem: Problem, model: Dimensioned) -> tuple[str, ...]:
    """List the dimensions that are rounded, in the model's order."""
    variables = set(problem.space.names)
    return tuple(name for name, d in model.dimensions.items() if variables & set(d.made_of))


def rounded_design(
    problem: Problem, model: Dimensioned, parameters: Mapping[str, float], step: float
) -> dict[str, float]:
    """Round a design's dimensions to multiples of a step.

    Args:
        problem: Whose variables say what is rounded.
        model: Whose dimensions.
        parameters: Every parameter by name.
        step: In the dimensions' unit, which is m.

    Returns:
        Every parameter of the rounded design by name.

    Raises:
        ValueError: A dimension would be 0, or a parameter out of its domain, in a sentence.
    """
    row = dict(zip(model.dimensions, model.measured(_row(model, parameters))[0].tolist(), strict=True))
    exact = {name: row[name] for name in rounded_names(problem, model) if row[name] != 0.0}
    rounded = {name: _rounded(value, step) for name, value in exact.items()}
    if not all(rounded.values()):
        least = min(exact, key=lambda name: abs(exact[name]))
        raise ValueError(
            f"{least} is {in_drawing_units(exact[least])}, and rounded to multiples of {in_drawing_units(step)} it "
            f"would be 0; take a step below {in_drawing_units(2.0 * abs(exact[least]))}"
        )
    made = dict(model.remade(parameters, rounded))
    for name, value in made.items():
        parameter = model.parameters[name]
        if not parameter.domain.contains(value):
            unit = f" {parameter.unit}".rstrip()
            raise ValueError(
                f"rounded so, {name} would be {value:.6g}{unit}, but must be {parameter.domain}; take a finer step"
            )
    return made


def in_drawing_units(length: float) -> str:
    """Write a length in m as a drawing has it, `0.1 mm`; one below a micrometre in nanometres."""
    return f"{length * 1e3:.6g} mm" if abs(length) >= MICROMETRE else f"{length * 1e9:.6g} nm"


def judge(problem: Problem, model: Dimensioned, designs: Sequence[Mapping[str, float]]) -> list[Judged]:
    """Simulate designs in the campaign's own problem, scenarios and uncertainty included.

    Args:
        problem: The problem.
        model: Whose dimensions.
        designs: Every parameter of each by name.

    Returns:
        One a design, in their order.
    """
    if not designs:
        return []
    names = list(problem.model.parameters)
    rows = np.array([[design[name] for name in names] for design in designs])
    quantities, verdicts = simulate(problem.model, problem.fixed, names, rows)
    told = problem.tell(Evaluations(rows, quantities, verdicts))
    known = list(problem.model.quantities)
    objectives = Values(known, [o.quantity for o in problem.objectives]).of(quantities)
    constraints = Values(known, [c.quantity for c in problem.constraints]).of(quantities)
    dimensions = model.measured(rows)
    valid = quantities[:, known.index(VALIDITY)].tolist() if VALIDITY in known else [np.nan] * len(rows)
    return [
        Judged(
            designs[i],
            dict(zip(model.dimensions, dimensions[i].tolist(), strict=True)),
            tuple(objectives[i].tolist()),
            tuple(constraints[i].tolist()),
            verdicts[i],
            bool(told.feasible[i]),
            tuple(
                None if o.goal is None else bool(value <= o.goal)
                for o, value in zip(problem.objectives, objectives[i], strict=True)
            ),
            None if np.isnan(valid[i]) else bool(valid[i]),
        )
        for i in range(len(designs))
    ]


def _row(model: Dimensioned, parameters: Mapping[str, float]) -> FloatArray:
    return np.array([[parameters[name] for name in model.parameters]])


def _rounded(value: float, step: float) -> float:
    """The multiple of the step that is nearest, as the float that is nearest to it."""
    whole = Decimal(repr(step))
    return float((Decimal(repr(value)) / whole).to_integral_value(ROUND_HALF_EVEN) * whole)
