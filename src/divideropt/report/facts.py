"""The variables, objectives and constraints of a report: how each is shown, and what was asked of it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.report.display import Axis, axis_of
from divideropt.report.front import Design


@dataclass(frozen=True)
class VariableFacts:
    """A variable: how it is shown, and its bounds in its unit."""

    axis: Axis
    lower: float
    upper: float


@dataclass(frozen=True)
class ObjectiveFacts:
    """An objective: its place, how it is shown, and goal, weight and reference in its unit, None where not given."""

    index: int
    axis: Axis
    goal: float | None
    weight: float
    reference: float | None


def variables_of(problem: Problem) -> tuple[VariableFacts, ...]:
    """Say of each variable how it is shown."""
    return tuple(
        VariableFacts(axis_of(v.parameter, (v.lower, v.upper)), v.lower, v.upper) for v in problem.space.variables
    )


def objectives_of(
    problem: Problem, front: Sequence[Design], reference: FloatArray | None
) -> tuple[ObjectiveFacts, ...]:
    """Say of each objective how it is shown; its unit is that of the front's values."""
    found = []
    for i, objective in enumerate(problem.objectives):
        point = None if reference is None else float(reference[i])
        values = [design.objectives[i] for design in front] or [point or objective.quantity.scale]
        found.append(ObjectiveFacts(i, axis_of(objective.quantity, values), objective.goal, objective.weight, point))
    return tuple(found)


def constraints_of(problem: Problem) -> tuple[str, ...]:
    """Word each constraint: `source pressure at least 1 MPa and at most 30 MPa`."""
    return tuple(f"{axis.words} {' and '.join(limits)}" for axis, limits in _limits(problem))


def bounds_of(problem: Problem) -> tuple[str, ...]:
    """Word each bound of the constraints by itself, in the order of what an optimiser is told of them."""
    return tuple(f"{axis.words} {limit}" for axis, limits in _limits(problem) for limit in limits)


def _limits(problem: Problem) -> Iterator[tuple[Axis, list[str]]]:
    for constraint in problem.constraints:
        bounds = {"at least": constraint.minimum, "at most": constraint.maximum}
        given = {word: bound for word, bound in bounds.items() if bound is not None}
        axis = axis_of(constraint.quantity, given.values() if any(given.values()) else [constraint.quantity.scale])
        yield axis, [f"{word} {axis.bound(bound)}" for word, bound in given.items()]
