"""Which points are verified, and what is said of them: against numbers put together by hand."""

from dataclasses import replace

import numpy as np
import pytest

from divideropt.analysis import marked, tally, worth_verifying
from divideropt.errors import StoreError
from divideropt.models import Outcome, Verdict
from divideropt.problem import Evaluations
from divideropt.store import TableSchema
from toy_model import toy_problem

PROBLEM = toy_problem()
SCHEMA = TableSchema.of(PROBLEM)


def table(values, outcomes=None, names=None, x1=None):
    """Results whose f1 and f2 are given, shape (n, 2); `spare` is 1."""
    n = len(values)
    designs = np.column_stack([np.arange(n) / 100 if x1 is None else x1, np.full((n, 2), 0.5)])
    quantities = np.column_stack([np.array(values, dtype=float), np.ones(n)])
    verdicts = [Verdict(o) for o in outcomes or [Outcome.OK] * n]
    names = names or [f"a-1/{i}" for i in range(n)]
    return SCHEMA.result_rows(names, ["a-1"] * n, Evaluations(designs, quantities, verdicts))


def line(n):
    """A front: f1 rises as |f2| falls."""
    return table([[0.1 + 0.8 * i / (n - 1), -(5.0 - 4.0 * i / (n - 1))] for i in range(n)])


def test_deviations_are_relative_to_the_reference_signed_and_have_a_floor():
    front = table([[2.0, -3.0], [0.0, 1.0], [1.0, 1e-3]])
    reference = table([[2.002, -3.0], [0.0, -1.0], [1.0, 0.0]])
    found = marked(front, reference, PROBLEM, SCHEMA, 0.01)
    assert found["verified"].to_pylist() == ["yes", "deviates", "deviates"]
    # 0.002 of 2.002; the sign counts: 2 of 1; 1e-3 of 1 % of the scale, which is 1
    assert found["deviation_f1"].to_pylist() == pytest.approx([0.002 / 2.002, 0.0, 0.0])
    assert found["deviation_f2"].to_pylist() == pytest.approx([0.0, 2.0, 0.1])


def test_the_tolerance_is_inclusive_and_every_objective_counts():
    front, reference = table([[1.25, 1.0]]), table([[1.0, 1.0]])
    assert marked(front, reference, PROBLEM, SCHEMA, 0.25)["verified"].to_pylist() == ["yes"]
    assert marked(front, reference, PROBLEM, SCHEMA, 0.2499)["verified"].to_pylist() == ["deviates"]


def test_another_outcome_deviates_whatever_the_numbers():
    front = table([[1.0, 1.0], [1.0, 1.0]])
    reference = table([[1.0, 1.0], [1.0, np.nan]], [Outcome.UNSETTLED, Outcome.OK])
    found = marked(front, reference, PROBLEM, SCHEMA, 0.01)
    assert found["verified"].to_pylist() == ["deviates", "deviates"]
    assert found["deviation_f2"].to_pylist() == [0.0, None]


def test_points_not_simulated_again_say_no_and_null_and_the_rest_is_as_it_was():
    front = line(5)
    reference = table([[9.0, 9.0], [0.1, -5.0]], names=["b-1/0", "a-1/0"], x1=[0.7, 0.0])
    found = marked(front, reference, PROBLEM, SCHEMA, 0.01)
    assert found["verified"].to_pylist() == ["yes", *["no"] * 4]
    assert found["deviation_f1"].to_pylist() == [0.0, None, None, None, None]
    assert found.select(front.column_names).equals(front)
    assert marked(found, reference, PROBLEM, SCHEMA, 0.01).equals(found), "marking again changes nothing"
    empty = marked(front.slice(0, 0), reference, PROBLEM, SCHEMA, 0.01)
    assert empty.schema.equals(SCHEMA.front, check_metadata=True)
    assert empty.num_rows == 0


def test_a_result_of_another_design_is_refused():
    with pytest.raises(StoreError, match="a-1/3 there is another design"):
        marked(line(5), table([[0.1, -5.0]], names=["a-1/3"]), PROBLEM, SCHEMA, 0.01)


def test_a_tally_counts_and_names_the_largest():
    front = table([[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]])
    reference = table([[1.001, 1.0], [1.0, 1.25]])
    found = tally(marked(front, reference, PROBLEM, SCHEMA, 0.01), SCHEMA)
    assert (found.points, found.agree, found.deviate) == (3, 1, 1)
    assert found.largest == pytest.approx({"f1": 0.001 / 1.001, "f2": 0.2})
    nothing = tally(marked(front, reference.slice(0, 0), PROBLEM, SCHEMA, 0.01), SCHEMA)
    assert (nothing.agree, nothing.deviate, nothing.largest) == (0, 0, {"f1": None, "f2": None})


def test_the_extremes_the_nearest_and_a_sample_are_chosen_each_once():
    front = line(200)
    ids = front["design_id"].to_pylist()
    # f1 = 0.1 + 0.8 t against 0.2, |f2| = 5 - 4 t against 2 with weight 2: the greater is least where they cross,
    # (0.8 t - 0.1)/0.2 = (3 - 4 t), so t = 0.4375, row 87.06
    nearest = {"a-1/85", "a-1/86", "a-1/87", "a-1/88", "a-1/89"}
    chosen = worth_verifying(front, PROBLEM, SCHEMA, 50)
    assert chosen == worth_verifying(front, PROBLEM, SCHEMA, 50)
    assert set(chosen[:2]) == {"a-1/0", "a-1/199"}
    assert set(chosen[2:7]) == nearest
    assert len(set(chosen)) == len(chosen) == 57
    assert set(chosen) < set(ids)
    assert len(worth_verifying(front, PROBLEM, SCHEMA, 0)) == 7
    assert set(worth_verifying(front, PROBLEM, SCHEMA, 1000)) == set(ids)
    assert worth_verifying(front.slice(0, 0), PROBLEM, SCHEMA, 50) == []
    assert worth_verifying(front, PROBLEM, SCHEMA, 0, extremes=False) == []
    assert len(set(worth_verifying(front, PROBLEM, SCHEMA, 50, extremes=False))) == 50


def test_without_goals_there_is_no_nearest():
    problem = replace(PROBLEM, objectives=tuple(replace(o, goal=None) for o in PROBLEM.objectives))
    assert set(worth_verifying(line(200), problem, SCHEMA, 0)) == {"a-1/0", "a-1/199"}
