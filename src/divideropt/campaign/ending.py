"""Why a run ends: its termination's rules, asked after every batch, or its strategy, that asks for no more.

A rule is a function of what was told, in its order and in its batches, and of nothing else: a run that is resumed or
replayed ends at the same batch.
"""

from collections import deque
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from divideropt.analysis import hypervolume, nondominated
from divideropt.campaign.plan import Run
from divideropt.campaign.termination import StagnationConfig
from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told
from divideropt.store import EndingRecord, Store

LOOKS = 4
"""Hypervolumes that are computed in a window; each may take milliseconds where the front is large."""

COSTLY_LOOKS = 1
"""The same from five objectives on, where one may take seconds."""


class Reason(StrEnum):
    """Why a run ended."""

    BUDGET = "budget"
    GOALS = "goals"
    STAGNATION = "stagnation"
    EXHAUSTED = "exhausted"
    BRANCHED = "branched"


@dataclass(frozen=True)
class Ended:
    """The end of a run.

    Attributes:
        reason: Why it ended.
        text: That in words.
        evaluations: After how many evaluations.
    """

    reason: Reason
    text: str
    evaluations: int


class Watch:
    """Hears what a run is told, and says when it is over."""

    def __init__(self, run: Run, problem: Problem, reference: FloatArray | None) -> None:
        """Begin.

        Args:
            run: With its termination, if it has one.
            problem: Its objectives have goals where a rule asks for them.
            reference: The hypervolume's reference point, shape (k,); there where a rule asks for it.
        """
        rules = run.termination
        self._run = run
        self._goals = np.array([o.goal for o in problem.objectives], dtype=float) if rules and rules.goals else None
        self._growth: _Growth | None = None
        if rules and rules.stagnation and reference is not None:
            self._growth = _Growth(rules.stagnation, reference)
        self._count = self._largest = 0

    def hear(self, told: Told) -> Ended | None:
        """Hear a batch; say how the run ends if a rule ends it here."""
        before, self._count = self._count, self._count + len(told.F)
        self._largest = max(self._largest, len(told.F))
        if self._goals is not None:
            reached = told.feasible & (self._goals >= told.F).all(axis=1)
            if reached.any():
                design = f"{self._run.name}/{before + int(reached.argmax())}"
                return Ended(Reason.GOALS, f"{design} reaches every goal", self._count)
        if self._growth is not None and self._growth.ceased(told):
            rule = self._growth.rule
            words = f"the hypervolume gained less than {rule.gain:g} % in {rule.window} evaluations"
            return Ended(Reason.STAGNATION, words, self._count)
        return None

    def no_more(self) -> Ended:
        """Say how a run ends whose strategy asks for no more."""
        budget = self._run.budget
        rest = budget - self._count
        if rest == 0:
            return Ended(Reason.BUDGET, f"its budget of {budget} evaluations is spent", self._count)
        if rest < self._largest:
            words = f"its budget of {budget} evaluations is spent but for {rest}, into which no batch fits"
            return Ended(Reason.BUDGET, words, self._count)
        return Ended(Reason.EXHAUSTED, "its strategy found nothing new to ask for", self._count)


def keep_ending(store: Store, run: Run, ended: Ended) -> None:
    """Keep in the store how a run ended.

    Raises:
        DiskError: The disk refused.
        StoreInUseError: The store is another's now.
    """
    store.write_ending(run.name, EndingRecord(str(ended.reason), ended.text, ended.evaluations, _asked(run)))


def keep_branched(store: Store, run: Run, branch: Run, batch: int, logged: int) -> None:
    """Keep in the store that a run is gone on with as another.

    Args:
        store: The store.
        run: The run.
        branch: The other.
        batch: From which batch on they differ.
        logged: Evaluations in the log of `run`.

    Raises:
        DiskError: The disk refused.
        StoreInUseError: The store is another's now.
    """
    words = f"{branch.name} goes on from its first {batch} batches, since batch {batch} came out differently there"
    store.write_ending(run.name, EndingRecord(str(Reason.BRANCHED), words, logged, _asked(run)))


def kept_ending(store: Store, run: Run, evaluations: int) -> Ended | None:
    """Return how a run with so many logged evaluations ended; None where it has not, or may go on.

    Raises:
        DamagedFileError: The store's record is damaged.
    """
    record = store.read_ending(run.name)
    if record is None or record.evaluations != evaluations:
        return None
    if record.asked != _asked(run) and record.reason != Reason.BRANCHED:
        return None
    return Ended(Reason(record.reason), record.text, record.evaluations)


def _asked(run: Run) -> dict[str, Any]:
    rules = run.termination
    return {"budget": run.budget, "termination": None if rules is None else rules.as_written()}


class _Growth:
    """The growth of the hypervolume of all that was told, looked at whenever a part of the window is full."""

    def __init__(self, rule: StagnationConfig, reference: FloatArray) -> None:
        self.rule = rule
        self._reference = reference
        self._front = np.empty((0, len(reference)))
        self._fresh: list[FloatArray] = []
        self._count = 0
        self._volumes: deque[tuple[int, float]] = deque()
        """Evaluations and hypervolume of each look, the oldest the last that is a window or more behind."""

    def ceased(self, told: Told) -> bool:
        """Hear a batch; say whether the growth over the window is below the rule's gain.

        Before anything feasible is within the reference point there is no growth to speak of, and no end.
        """
        part = -(-self.rule.window // (LOOKS if len(self._reference) < 5 else COSTLY_LOOKS))
        before, self._count = self._count, self._count + len(told.F)
        self._fresh.append(told.F[told.feasible & (self._reference > told.F).all(axis=1)])
        if before // part == self._count // part:
            return False
        front = np.concatenate([self._front, *self._fresh])
        self._front, self._fresh = front[nondominated(front)], []
        volume, begin = hypervolume(self._front, self._reference), self._count - self.rule.window
        self._volumes.append((self._count, volume))
        while len(self._volumes) > 1 and self._volumes[1][0] <= begin:
            self._volumes.popleft()
        then, old = self._volumes[0]
        return then <= begin and old > 0.0 and volume - old < self.rule.gain / 100.0 * old
