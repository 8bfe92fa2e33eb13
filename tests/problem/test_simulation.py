"""A model that breaks down on one design costs that design only."""

import os
import subprocess
import sys

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from divideropt.models import Outcome, Verdict
from divideropt.models.divider import PARAMETERS, Divider, parameter_set
from divideropt.problem import simulate
from toy_model import Toy


class Fragile(Toy):
    def evaluate(self, designs):
        if (designs[:, 0] > 0.9).any():
            raise RuntimeError("x1 is too much for me")
        return super().evaluate(designs)


def test_only_the_guilty_design_is_blamed():
    model = Fragile()
    fixed = {name: p.default for name, p in model.parameters.items()}
    designs = np.array([[0.2, 0.5], [0.95, 0.5], [0.4, 0.01]])
    quantities, verdicts = simulate(model, fixed, ["x1", "x2"], designs)
    assert [v.outcome for v in verdicts] == [Outcome.OK, Outcome.CRASHED, Outcome.UNSETTLED]
    assert "RuntimeError: x1 is too much for me" in verdicts[1].text
    assert np.isnan(quantities[1]).all()
    honest, _ = Toy().evaluate(np.array([[0.2, 0.5, 0.5]]))
    assert np.array_equal(quantities[0], honest[0])


class Vast(Toy):
    def evaluate(self, designs):
        return np.array([[1.7e308, -1e51, 1e50], [1e-310, -1e-51, -1e-50]]), [Verdict(Outcome.OK)] * 2


def test_a_quantity_that_nothing_can_be_computed_with_is_infinite_or_zero():
    fixed = {name: p.default for name, p in Vast().parameters.items()}
    quantities, verdicts = simulate(Vast(), fixed, ["x1"], np.array([[0.2], [0.3]]))
    assert quantities.tolist() == [[np.inf, -np.inf, 1e50], [0.0, 0.0, -1e-50]]
    assert all(verdict.ok for verdict in verdicts)


class Careless(Toy):
    def __init__(self, answer):
        super().__init__()
        self.answer = answer

    def evaluate(self, designs):
        return self.answer(*super().evaluate(designs))


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (lambda quantities, verdicts: None, "TypeError"),
        (
            lambda quantities, verdicts: (quantities[:, :2], verdicts),
            "(1, 2) and 1 verdicts, where (1, 3) and 1",
        ),
        (lambda quantities, verdicts: (quantities, verdicts[1:]), "shape (1, 3) and 0 verdicts"),
        (lambda quantities, verdicts: (quantities, ["ok"] * len(verdicts)), "gives 'ok', where a Verdict"),
        (lambda quantities, verdicts: (quantities, [Verdict("bad")] * len(verdicts)), "with an Outcome is due"),
        (lambda quantities, verdicts: ([["a", "b", "c"]] * len(verdicts), verdicts), "could not convert"),
    ],
)
def test_a_model_that_answers_with_anything_else_breaks_down_and_the_log_stays_sound(answer, words):
    model = Careless(answer)
    fixed = {name: p.default for name, p in model.parameters.items()}
    quantities, verdicts = simulate(model, fixed, ["x1"], np.array([[0.2], [0.3]]))
    assert np.isnan(quantities).all()
    assert [v.outcome for v in verdicts] == [Outcome.CRASHED] * 2
    assert words in verdicts[0].text


def test_absurd_dimensions_are_a_row_like_any_other():
    assert "radial_clearance" in PARAMETERS
    designs = np.array([[1e200], [2.9e-6], [1e-120]])
    quantities, verdicts = simulate(Divider(), parameter_set("thesis_base"), ["radial_clearance"], designs)
    assert verdicts[1].ok
    assert not verdicts[0].ok
    assert not verdicts[2].ok
    assert np.isfinite(quantities[1]).all()


def test_the_number_of_threads_around_it_changes_no_bit():
    """Unlimited, two threads of OpenBLAS change the last bits of what SciPy's Radau finds."""
    found = []
    for threads in (1, 2):
        with threadpool_limits(threads, user_api="blas"):
            quantities, _ = simulate(
                Divider().reference(), parameter_set("thesis_base"), ["spool_radius"], np.array([[9e-3]])
            )
        found.append(quantities.tobytes())
    assert found[0] == found[1]


def test_linear_algebra_runs_on_one_thread_and_is_let_go_afterwards():
    class Curious(Toy):
        def evaluate(self, designs):
            seen.extend(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")
            return super().evaluate(designs)

    seen: list[int] = []
    model = Curious()
    with threadpool_limits(2, user_api="blas"):
        simulate(model, dict.fromkeys(model.parameters, 0.5), [], np.empty((1, 0)))
        after = [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]
    if not seen:
        pytest.skip("no BLAS here whose threads can be counted")
    assert set(seen) == {1}
    assert set(after) == {2}


class Wordless(Exception):
    def __str__(self):
        raise RuntimeError("no words")


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (ValueError("one\nand\r\n  two"), "ValueError: one and two"),
        (Wordless(), "Wordless"),
        (KeyError(), "KeyError"),
        (RuntimeError("x" * 1000), "RuntimeError: " + "x" * 186 + "…"),
    ],
)
def test_what_a_model_breaks_down_with_is_said_in_one_line(error, words):
    class Breaking(Toy):
        def evaluate(self, designs):
            raise error

    model = Breaking()
    fixed = {name: p.default for name, p in model.parameters.items()}
    _, verdicts = simulate(model, fixed, ["x1"], np.array([[0.5], [0.6]]))
    assert [v.text for v in verdicts] == [f"the model broke down: {words}"] * 2


LATE = """
from threadpoolctl import threadpool_info
from divideropt.problem.simulation import one_thread
with one_thread():
    import scipy.linalg
    print(*(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"))
"""


def test_what_scipy_brings_later_runs_on_one_thread_too():
    two = {**os.environ, "OPENBLAS_NUM_THREADS": "2"}
    run = subprocess.run([sys.executable, "-c", LATE], env=two, capture_output=True, text=True, check=True)
    assert set(run.stdout.split()) == {"1"}
