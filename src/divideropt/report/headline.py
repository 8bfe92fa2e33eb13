"""What a campaign came to, goal by goal: the best design by goal attainment, and how much of the front meets what."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from divideropt.report.facts import ObjectiveFacts
from divideropt.report.front import Design


@dataclass(frozen=True)
class Aim:
    """An objective: how far the front goes in it, what the best design reaches, and who meets its goal.

    Attributes:
        facts: The objective.
        least: Its least value on the front.
        greatest: Its greatest.
        reached: What the best design has; None without one.
        met: Whether that meets the goal; None without a goal or a best design.
        meeting: Designs of the front that meet it; None without a goal.
    """

    facts: ObjectiveFacts
    least: float
    greatest: float
    reached: float | None
    met: bool | None
    meeting: int | None

    @property
    def lack(self) -> float:
        """By how much the best design misses the goal, in the quantity's unit; below 0 where it does better."""
        goal = self.facts.goal
        return 0.0 if self.reached is None or goal is None else self.reached - goal


@dataclass(frozen=True)
class Headline:
    """What came out.

    Attributes:
        best: The best design by goal attainment; None without a feasible design, or a goal for every objective.
        within: The best of the front that keeps to what the model assumes, where the best of all does not; else None.
        goals: How many objectives have a goal.
        aims: The objectives; empty without a front.
        designs: How many the front has.
        meeting: How many designs of the front meet so many goals, the most goals first; without those none meets.
    """

    best: Design | None
    within: Design | None
    goals: int
    aims: tuple[Aim, ...]
    designs: int
    meeting: Mapping[int, int]

    @property
    def met(self) -> int:
        """How many goals the best design meets."""
        return sum(aim.met is True for aim in self.aims)

    @property
    def all_met(self) -> int:
        """How many designs of the front meet every goal."""
        return self.meeting.get(self.goals, 0)


def headline_of(front: Sequence[Design], best: Sequence[Design], objectives: Sequence[ObjectiveFacts]) -> Headline:
    """Sum up.

    Args:
        front: The combined front, the best by goal attainment first.
        best: The best of each strategy by goal attainment.
        objectives: With goals or not.
    """
    first = min(best, key=lambda design: (design.attainment is None, design.attainment), default=None)
    goals = sum(facts.goal is not None for facts in objectives)
    counts = Counter(sum(met is True for met in design.met) for design in front) if goals else Counter[int]()
    meeting = {count: counts[count] for count in sorted(counts, reverse=True) if count}
    aims = tuple(_aim(facts, front, first) for facts in objectives if front)
    beyond = first is not None and first.valid is False
    within = next((design for design in front if beyond and design.valid), None)
    return Headline(first, within, goals, aims, len(front), meeting)


def _aim(facts: ObjectiveFacts, front: Sequence[Design], best: Design | None) -> Aim:
    i = facts.index
    values = [design.objectives[i] for design in front]
    return Aim(
        facts,
        min(values),
        max(values),
        None if best is None else best.objectives[i],
        None if best is None else best.met[i],
        None if facts.goal is None else sum(design.met[i] is True for design in front),
    )
