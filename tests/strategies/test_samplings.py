"""What the samplings of a sensitivity study ask for."""

import numpy as np
import pytest
from pydantic import ValidationError
from SALib.sample import morris as salib_morris
from SALib.sample import sobol as salib_sobol

from divideropt.strategies import Morris, OneAtATime, Sobol
from toy_model import toy_problem

BOX = {"num_vars": 3, "names": ["x1", "x2", "x3"], "bounds": [[0.0, 1.0]] * 3}


def asked(strategy, seed=1):
    found, problem = [], toy_problem()

    def evaluate(designs):
        found.append(designs.copy())
        return problem.tell(problem.simulate(designs))

    strategy.run(problem, evaluate, seed)
    return found


def test_one_at_a_time_sweeps_each_variable_and_leaves_the_others():
    sweeps = asked(OneAtATime(points=5))
    assert len(sweeps) == 3
    for i, sweep in enumerate(sweeps):
        assert sweep[:, i].tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
        assert np.all(np.delete(sweep, i, axis=1) == 0.5)  # the toy's defaults


@pytest.mark.parametrize("second_order", [True, False])
def test_a_sobol_study_asks_for_salibs_sample_in_whole_blocks(second_order):
    strategy = Sobol(samples=256, second_order=second_order)
    found = asked(strategy, seed=7)
    block = 8 if second_order else 5
    assert {len(batch) % block for batch in found} == {0}
    assert len(found) > 1
    wanted = salib_sobol.sample(BOX, 256, calc_second_order=second_order, seed=7)
    assert np.concatenate(found).tobytes() == np.ascontiguousarray(wanted).tobytes()


def test_a_block_differs_from_its_first_row_in_one_variable_after_the_other():
    block = asked(Sobol(samples=2, second_order=False))[0][:5]
    for i in range(3):
        assert np.flatnonzero(block[1 + i] != block[0]).tolist() == [i]
        assert block[1 + i, i] == block[4, i]


def test_a_morris_study_asks_for_salibs_trajectories():
    found = np.concatenate(asked(Morris(trajectories=20, levels=6), seed=3))
    assert found.tobytes() == salib_morris.sample(BOX, 20, num_levels=6, seed=3).tobytes()
    steps = np.diff(found.reshape(20, 4, 3), axis=1)
    assert np.all((steps != 0.0).sum(axis=2) == 1)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sobol(samples=1000), "1000 is no power of two.*write 512 or 1024"),
        (lambda: Morris(levels=7), "7 is odd.*write 8"),
        (lambda: Morris(trajectories=23), "23 is not a multiple of 10.*write 30"),
        (lambda: OneAtATime(points=1), "greater than or equal to 2"),
    ],
)
def test_counts_that_would_spoil_a_study_are_refused(make, words):
    with pytest.raises(ValidationError, match=words):
        make()
