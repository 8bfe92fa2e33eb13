"""What was tried, behind the front: all of it or an even sample, nothing that failed."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from divideropt.problem import FAILURE_VIOLATION, Told
from divideropt.report.figures import BEHIND, MARGIN, projections
from divideropt.report.tried import MOST_TRIED, read_tried


def log(values: np.ndarray, violation: np.ndarray) -> SimpleNamespace:
    """What is asked of a log's summary."""
    return SimpleNamespace(told=Told(values, violation[:, None]), shared=0)


def test_all_are_kept_where_they_are_few_but_those_that_failed():
    values = np.arange(12.0).reshape(6, 2)
    violation = np.array([0.0, 3.0, FAILURE_VIOLATION, 0.0, FAILURE_VIOLATION + 2.0, 1e-9])
    tried = read_tried({"a-1": log(values[:4], violation[:4]), "b-1": log(values[4:], violation[4:])})
    assert tried.objectives.tolist() == [[0, 1], [2, 3], [6, 7], [10, 11]]
    assert tried.feasible.tolist() == [True, False, True, False]
    assert (tried.considered, tried.failed) == (4, 2)


def test_of_many_every_run_and_every_part_of_it_has_its_share():
    sizes = {"a-1": 70_000, "b-1": 700, "c-1": 20_000}
    logs = {
        name: log(np.column_stack([np.full(n, i), np.arange(n) / n]), np.zeros(n))
        for i, (name, n) in enumerate(sizes.items())
    }
    tried = read_tried(logs)
    assert len(tried) == MOST_TRIED
    step = sum(sizes.values()) / MOST_TRIED
    for i, n in enumerate(sizes.values()):
        times = tried.objectives[tried.objectives[:, 0] == i, 1]
        assert abs(len(times) - n / step) <= 1
        assert np.diff(times).max() <= (step + 1) / n, "no gap in any run"
    assert tried.objectives[[0, -1]].tolist() == [[0, 0], [2, 19_999 / 20_000]]
    again = read_tried(logs)
    assert np.array_equal(again.objectives, tried.objectives)


def test_the_report_counts_what_its_store_has(data):
    assert data.tried.considered + data.tried.failed == sum(run.evaluations for run in data.runs)
    assert len(data.tried) == data.tried.considered
    assert data.tried.feasible.sum() == sum(run.feasible for run in data.runs)
    front = {design.objectives for design in data.front}
    assert front <= {tuple(row) for row in data.tried.objectives.tolist()}


def test_a_front_of_which_all_is_drawn_has_axes_around_it_and_a_little_behind(data):
    (_, figure), *_ = projections(data)
    facts = data.objectives[0]
    values = [facts.axis.scaled(design.objectives[0]) for design in data.front] + [facts.axis.scaled(facts.goal)]
    low, high = figure.layout.xaxis.range
    wide = max(values) - min(values)
    assert low < min(values) < max(values) < high <= max(values) + (BEHIND + MARGIN) * wide * 1.001
    far = replace(data.tried, objectives=data.tried.objectives * 1e6)
    (_, figure), *_ = projections(replace(data, tried=far))
    assert figure.layout.xaxis.range[1] < max(values) + (BEHIND + 2 * MARGIN) * wide
