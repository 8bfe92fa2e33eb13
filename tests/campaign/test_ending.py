"""The rules that end a run, on batches made by hand."""

import numpy as np
import pytest

from divideropt.campaign.ending import LOOKS, Reason, Watch
from divideropt.campaign.plan import Run
from divideropt.campaign.termination import TerminationConfig
from divideropt.problem import Told
from divideropt.strategies import NSGA2
from toy_model import toy_problem

REFERENCE = np.array([1.0, 20.0])
"""Of the toy's objectives, whose goals are 0.2 and 2."""


def watch(termination=None, budget=(10, 100), reference=REFERENCE):
    rules = None if termination is None else TerminationConfig.model_validate(termination)
    return Watch(
        Run("nsga2-1", "nsga2", NSGA2(*budget), 1, NSGA2(*budget).budget(3), rules), toy_problem(), reference
    )


def told(*points, feasible=True):
    """A batch of points (f1, f2)."""
    F = np.array(points, dtype=float)
    return Told(F, np.full((len(F), 2), 0.0 if feasible else 1.0))


def volume_points(volume, count):
    """So many points, of which the first alone dominates that share of the box."""
    return [(1.0 - volume, 0.0), *[(1.0, 20.0)] * (count - 1)]


def test_goals_end_a_run_with_the_first_feasible_design_that_reaches_each():
    one = watch({"goals": True})
    assert one.hear(told((0.2, 2.1), (0.1, 5.0))) is None  # each goal is reached, by another design
    assert one.hear(told((0.1, 1.0), feasible=False)) is None
    ended = one.hear(told((0.5, 5.0), (0.2, 2.0), (0.1, 1.0)))
    assert (ended.reason, ended.evaluations) == (Reason.GOALS, 6)
    assert ended.text == "nsga2-1/4 reaches every goal"


def heard(one, volumes, size=10):
    """Hear batches of those hypervolumes, until the run ends."""
    for volume in volumes:
        ended = one.hear(told(*volume_points(volume, size)))
        if ended is not None:
            return ended
    return None


def test_stagnation_ends_a_run_when_a_window_brought_less_than_the_gain():
    rule = {"stagnation": {"window": 40, "gain": "1 %"}}
    volumes = [0.5, 0.6, 0.7, 0.7, 0.7, 0.7, 0.7, 0.7, 0.7]
    ended = heard(watch(rule), volumes)
    # 0.7 is there after 30 evaluations, and nothing more 40 later
    assert (ended.reason, ended.evaluations) == (Reason.STAGNATION, 70)
    assert ended.text == "the hypervolume gained less than 1 % in 40 evaluations"


@pytest.mark.parametrize(("gain", "ends"), [("2.4 %", False), ("2.6 %", True)])
def test_the_gain_is_a_share_of_the_volume_a_window_ago(gain, ends):
    """2.5 % are gained in each window of four batches."""
    volumes = [0.4 * 1.025 ** (i / 4) for i in range(30)]
    ended = heard(watch({"stagnation": {"window": 40, "gain": gain}}), volumes)
    assert (ended is not None) == ends


def test_nothing_stagnates_before_something_feasible_is_within_the_reference_point():
    one = watch({"stagnation": {"window": 20, "gain": "1 %"}})
    for _ in range(20):
        assert one.hear(told(*[(0.1, 1.0)] * 10, feasible=False)) is None
        assert one.hear(told(*[(1.5, 1.0)] * 10)) is None


def test_stagnation_is_looked_at_by_the_count_of_evaluations_alone():
    """In batches of one, and in batches larger than the window."""
    rule = {"stagnation": {"window": 40, "gain": "1 %"}}
    assert heard(watch(rule), [0.5] * 200, size=1).evaluations == 40 + 40 // LOOKS
    assert heard(watch(rule), [0.5] * 20, size=100).evaluations == 200


def test_a_window_never_ends_a_run_that_is_no_longer_than_it():
    assert heard(watch({"stagnation": {"window": 100, "gain": "1 %"}}), [0.5] * 10) is None


def test_goals_come_before_stagnation():
    one = watch({"goals": True, "stagnation": {"window": 20, "gain": "100 %"}})
    assert heard(one, [0.5] * 2) is None
    assert one.hear(told(*[(0.1, 1.0)] * 10)).reason == Reason.GOALS
    other = watch({"stagnation": {"window": 20, "gain": "100 %"}})
    assert heard(other, [0.5] * 2) is None
    assert other.hear(told(*[(0.1, 1.0)] * 10)).reason == Reason.STAGNATION


@pytest.mark.parametrize(
    ("batches", "reason", "words"),
    [
        ([10] * 10, Reason.BUDGET, "its budget of 100 evaluations is spent"),
        ([10] * 9 + [6], Reason.BUDGET, "its budget of 100 evaluations is spent but for 4, into which no batch fits"),
        ([10] * 6, Reason.EXHAUSTED, "its strategy found nothing new to ask for"),
    ],
)
def test_a_strategy_that_asks_for_no_more_has_spent_its_budget_or_knows_nothing_new(batches, reason, words):
    one = watch(budget=(10, 10))
    for size in batches:
        assert one.hear(told(*[(0.5, 5.0)] * size)) is None
    assert (one.no_more().reason, one.no_more().text) == (reason, words)


def test_the_same_batches_end_at_the_same_place():
    random = np.random.default_rng(1)
    points = [random.random((12, 2)) * [1.0, 20.0] for _ in range(60)]
    rule = {"stagnation": {"window": 100, "gain": "0.5 %"}}
    ends = []
    for _ in range(2):
        one = watch(rule)
        ends.append(next(e for e in (one.hear(told(*batch)) for batch in points) if e is not None))
    assert ends[0] == ends[1]
    assert 100 < ends[0].evaluations < 720
