"""The compiled loop over a batch against the way by single responses, which is checked elsewhere."""

import numpy as np
import pytest

from divideropt.models.base import Outcome
from divideropt.models.divider import Divider, Event, Scenario, load_step
from divideropt.models.divider import model as model_module
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.divider.record import parameter_rows
from divideropt.models.divider.result_record import NOT_FOLLOWED

RAMP = Scenario(
    events=(
        load_step(1, 15e6, at=0.1, over=0.02),
        Event(0.6, 0.05, spool_position=0.4),
        Event(0.9, source_flow=9e-4),
    ),
    settled=False,
    end_time=1.4,
)
SCENARIOS = {"standard": Scenario(), "ramps": RAMP}


@pytest.fixture
def batch(box_designs) -> np.ndarray:
    return np.array([list(p.values()) for p in box_designs(24)])


@pytest.mark.parametrize("friction", [0.0, 5.0])
@pytest.mark.parametrize("scenario", SCENARIOS)
@pytest.mark.parametrize("formulation", ["conservative", "text", "listing"])
def test_a_batch_is_its_designs_one_by_one(batch, formulation, scenario, friction) -> None:
    batch[:, list(PARAMETERS).index("coulomb_friction")] = friction
    model = Divider(formulation, SCENARIOS[scenario])
    quantities, verdicts = model.evaluate(batch)
    for row, verdict, design in zip(quantities, verdicts, batch, strict=True):
        expected = measure(model.respond(dict(zip(PARAMETERS, design.tolist(), strict=True))))
        np.testing.assert_array_equal(row, expected[0])
        assert verdict == expected[1]


def test_most_designs_are_followed_and_none_is_judged_without(batch) -> None:
    found = Divider()._batch(batch)
    assert np.count_nonzero(found.judgements["finding"] == NOT_FOLLOWED) == 0
    outcomes = [v.outcome for v in Divider().evaluate(batch)[1]]
    assert {Outcome.OK, Outcome.AT_STOP} <= set(outcomes)


@pytest.mark.parametrize("threads", [2, 5])
def test_threads_change_nothing(batch, threads) -> None:
    alone, shared = Divider().evaluate(batch), Divider(threads=threads).evaluate(batch)
    np.testing.assert_array_equal(alone[0], shared[0])
    assert list(alone[1]) == list(shared[1])


def test_neighbours_change_nothing(batch) -> None:
    whole = Divider().evaluate(batch)[0]
    np.testing.assert_array_equal(whole[::-1], Divider().evaluate(batch[::-1])[0])
    np.testing.assert_array_equal(whole[7:8], Divider().evaluate(batch[7:8])[0])


def test_a_design_that_is_not_followed_goes_the_other_way(monkeypatch, batch) -> None:
    straight = Divider().evaluate(batch)
    monkeypatch.setattr(model_module, "simulate_batch", _follow_none)
    other = Divider().evaluate(batch)
    np.testing.assert_array_equal(straight[0], other[0])
    assert list(straight[1]) == list(other[1])


def _follow_none(rows, *others) -> None:
    found = others[-3]
    found[2]["finding"] = NOT_FOLLOWED


def test_the_row_has_the_parameters_in_order(batch) -> None:
    rows = parameter_rows(batch)
    for i, name in enumerate(PARAMETERS):
        np.testing.assert_array_equal(rows[name], batch[:, i])
