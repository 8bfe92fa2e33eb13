"""How the runs came on: what each had reached after so many evaluations, and a strategy's runs put together."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from divideropt.analysis import Course, course_of
from divideropt.report.facts import ObjectiveFacts
from divideropt.report.runs import RunFacts, marks_of


@dataclass(frozen=True)
class Line:
    """One run: what it had reached after each number of evaluations, infinite where that was nothing yet."""

    run: str
    strategy: str
    marks: tuple[int, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class Track:
    """One figure of merit over the evaluations.

    Attributes:
        name: `hypervolume`, `attainment` or `least`.
        title: What it is, with its unit.
        lines: The runs that have begun, in the campaign's order.
        courses: The runs of each strategy put together, as far as the shortest of them goes.
    """

    name: str
    title: str
    lines: tuple[Line, ...]
    courses: Mapping[str, Course]


def tracks_of(runs: Sequence[RunFacts], objectives: Sequence[ObjectiveFacts]) -> tuple[Track, ...]:
    """Say how the runs came on, as far as it can be measured.

    Args:
        runs: The campaign's.
        objectives: Those that every run minimises.

    Returns:
        The hypervolume, where there is a reference point; the best goal attainment, where every objective has a goal;
        the least value, where there is one objective only.
    """
    begun = [run for run in runs if run.evaluations]
    axis = objectives[0].axis
    found = []
    if any(run.hypervolumes for run in begun):
        found.append(_track("hypervolume", "hypervolume", begun, len(objectives), lambda run: run.hypervolumes))
    if any(run.attainments for run in begun):
        found.append(_track("attainment", "best max λ", begun, len(objectives), lambda run: run.attainments))
    if begun and len(objectives) == 1:
        title = f"least {axis.label}"
        found.append(_track("least", title, begun, 1, lambda run: [axis.scaled(value) for value in run.least]))
    return tuple(found)


def _track(
    name: str, title: str, runs: Sequence[RunFacts], objectives: int, history: Callable[[RunFacts], Sequence[float]]
) -> Track:
    lines = tuple(Line(run.name, run.strategy, run.marks, tuple(history(run))) for run in runs)
    strategies = dict.fromkeys(run.strategy for run in runs)
    return Track(
        name,
        title,
        lines,
        {s: _course([line for line in lines if line.strategy == s], objectives) for s in strategies},
    )


def _course(lines: Sequence[Line], objectives: int) -> Course:
    """Put runs together at the marks of the shortest, which all of them have."""
    common = marks_of(min(line.marks[-1] for line in lines), objectives)
    at = [dict(zip(line.marks, line.values, strict=True)) for line in lines]
    return course_of(common, [[values[mark] for mark in common] for values in at])
