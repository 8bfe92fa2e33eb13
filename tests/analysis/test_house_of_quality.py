"""The rule of the house on made-up indices, and the author's numbers as the thesis prints them."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from divideropt.analysis.house_of_quality import house_of_quality, scores
from divideropt.models.divider import PARAMETERS, QUANTITIES
from divideropt.models.divider.thesis_house import THESIS_HOUSE
from divideropt.problem import Constraint, DesignSpace, Objective, Problem, Variable
from divideropt.report.house_words import house_sentence

OPTIMISED = ("spool_radius", "groove_width", "total_pressure_drop", "fixed_drop_ratio", "centred_opening")
BOUNDS = ((6e-3, 16e-3), (0.6e-3, 2e-3), (2e6, 10e6), (0.3, 0.99), (0.1, 0.9))


def valve(weights=(3.0, 3.0, 1.0)):
    q = QUANTITIES
    return Problem(
        model=None,  # the house asks for no simulation
        fixed={},
        space=DesignSpace(tuple(Variable(PARAMETERS[n], *b) for n, b in zip(OPTIMISED, BOUNDS, strict=True))),
        objectives=tuple(
            Objective(q[n], weight=w)
            for n, w in zip(("steady_state_error", "dynamic_error", "source_pressure"), weights, strict=True)
        ),
        constraints=(Constraint(q["source_pressure"], maximum=3e7), Constraint(q["stability_margin"], minimum=0.0)),
    )


def table(rows, treatment="working", samples=64, half=0.01):
    return pd.DataFrame(
        [
            {
                "quantity": quantity,
                "variable": variable,
                "with": None,
                "kind": "ST",
                "value": value,
                "low": value - half,
                "high": value + half,
                "samples": samples,
                "treatment": treatment,
                "used": 1.0,
            }
            for quantity, values in rows.items()
            for variable, value in zip(OPTIMISED, values, strict=True)
        ]
    )


INDICES = {
    "steady_state_error": (0.8, 0.2, 0.05, 0.0125, 0.005),
    "dynamic_error": (0.4, 0.4, 0.4, 0.4, 0.4),
    "source_pressure": (0.0, 0.0, 0.2, 0.1, 0.9),
}


def test_scores_go_with_the_root_of_the_share_of_the_largest():
    assert scores([0.8, 0.45, 0.2, 0.05, 0.0125, 0.012], [0.01] * 6) == (4, 3, 2, 1, 1, 0)
    assert scores([0.8, 0.8 * (3.5 / 4) ** 2 * 1.0001, 0.8 * (3.5 / 4) ** 2 * 0.9999], [0.1] * 3) == (4, 4, 3)


def test_an_index_whose_interval_reaches_zero_scores_nothing():
    assert scores([0.8, 0.4, 0.4], [0.7, 0.0, -0.1]) == (4, 0, 0)
    assert scores([0.1, 0.2], [-0.1, -0.1]) == (0, 0)


def test_the_house_has_the_authors_rows_with_the_campaigns_weights():
    more = table(INDICES | {"source_pressure": (9.0,) * 5}, samples=32)
    other = table({"steady_state_error": (9.0,) * 5}, treatment="worst")
    house = house_of_quality(pd.concat([table(INDICES), more, other]), valve((3.0, 2.0, 1.5)), thesis=True)
    steady, dynamic, losses, stability, cost = house.rows
    assert steady.scores == (4, 2, 1, 1, 0)
    assert dynamic.scores == (4, 4, 4, 4, 4)
    assert (losses.quantity, losses.scores) == ("source_pressure", (0, 0, 2, 1, 4))
    assert stability.scores is None
    assert [row.importance for row in house.rows] == ["3", "2", "1.5", "D", ""]
    assert (cost.quantity, cost.scores[2:]) == (None, (0, 0, 0))
    assert max(cost.scores) == 4
    assert house.importance == pytest.approx(
        [(3 * a + 2 * 4 + 1.5 * c) / (4 * 6.5) for a, c in zip(steady.scores, losses.scores, strict=True)]
    )


def test_the_authors_numbers_are_those_of_table_3_2():
    house = house_of_quality(table(INDICES), valve(), thesis=True)
    printed = "3 4 3 4 2 1 | 3 3 3 4 2 3 | 1 0 1 4 2 3 | D 4 2 3 1 1"
    rows = [
        " ".join(["D" if row.author_weight is None else f"{row.author_weight:g}", *map(str, row.author)])
        for row in house.rows[:4]
    ]
    assert " | ".join(rows) == printed


def test_the_authors_numbers_are_those_of_table_3_1():
    """As the scan has its rows: without the blanks, which are zeros with us."""
    printed = ["3 4 3 4 4 2 1 4", "3 3 3 1 4 2 3 1", "1 1 4 2 3", "D 4 2 1 3 1 1 1", "2 2 2 4 3"]
    columns = ("spool_radius", "groove_width", "radial_clearance", *OPTIMISED[2:], "rim_thickness")
    for row, text in zip(THESIS_HOUSE, printed, strict=True):
        numbers = [str(row.scores[name]) for name in columns if row.scores[name]]
        assert " ".join(["D" if row.weight is None else f"{row.weight:g}", *numbers]) == text


def test_the_importance_of_his_numbers_leaves_cost_and_demands_out():
    house = house_of_quality(table(INDICES), valve(), thesis=True)
    assert house.author_importance == pytest.approx([21 / 28, 19 / 28, 28 / 28, 14 / 28, 15 / 28])


def test_an_objective_that_the_author_did_not_have_counts_too():
    problem = valve()
    regulation = Objective(replace(QUANTITIES["load_regulation"], name="worst.load_regulation"), weight=3.0)
    problem = replace(problem, objectives=(regulation, *problem.objectives[1:]))
    indices = INDICES | {"worst.load_regulation": (0.0, 0.0, 0.0, 0.1, 0.9)}
    house = house_of_quality(table(indices), problem, thesis=True)
    assert [row.words for row in house.rows[:5]] == [row.words for row in THESIS_HOUSE]
    (more,) = house.rows[5:]
    assert (more.words, more.weight, more.scores) == ("worst load regulation", 3.0, (0, 0, 0, 1, 4))
    assert (more.author, more.author_weight) == (None, None)
    assert house.rows[0].importance == ""  # his first criterion is none of the campaign's
    losses = (0, 0, 2, 1, 4)
    assert house.importance == pytest.approx(
        [(3 * a + 3 * 4 + c) / (4 * 7) for a, c in zip(more.scores, losses, strict=True)]
    )
    assert house.author_importance == house_of_quality(table(INDICES), valve(), thesis=True).author_importance


def test_the_sentence_follows_from_the_numbers():
    house = house_of_quality(table(INDICES | {"dynamic_error": (0.4, 0.0, 0.0, 0.0, 0.0)}), valve(), thesis=True)
    assert house.worthwhile == ("spool_radius",)
    text = house_sentence(house, {name: name for name in OPTIMISED})
    assert text.startswith("Worth optimising: spool_radius (0.86). Below 0.25")
    assert f"Of {len(house.differences)} numbers" in text
    assert "judge otherwise of groove_width (0.68)" in text


def test_a_model_of_somebodys_own_has_the_computed_house_alone():
    house = house_of_quality(table(INDICES, treatment="all"), valve(), thesis=False)
    assert [row.words for row in house.rows] == [
        "steady state error",
        "dynamic error",
        "source pressure",
        "stability margin",
    ]
    assert all(row.author is None for row in house.rows)
    assert house.author_importance is None
    assert house.differences == ()
    assert "author" not in house_sentence(house, {name: name for name in OPTIMISED})


def test_an_index_without_an_interval_is_no_score_of_0():
    """A resample in which nothing varies leaves the interval undefined: nothing is known, which is not 0."""
    problem = valve()
    made = table({"steady_state_error": [0.5, 0.3, 0.2, 0.1, 0.0]})
    assert house_of_quality(made, problem, thesis=True).rows[0].scores is not None
    made["low"] = np.nan
    assert house_of_quality(made, problem, thesis=True).rows[0].scores is None
