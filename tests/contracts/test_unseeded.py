"""The guard against unseeded generators bites, whatever draws and however it was imported."""

import contextlib
import copy
import os
import random
import secrets
from random import shuffle as imported_shuffle

import numpy as np
import pytest
from numpy.random import default_rng as imported_default_rng
from numpy.random import rand as imported_rand
from pymoo.algorithms.moo.nsga3 import NSGA3 as PymooNSGA3  # noqa: N811
from pymoo.util.ref_dirs import get_reference_directions

from divideropt.strategies.ask_tell import drive
from toy_model import toy_problem
from unseeded import UnseededError, seeded_only

DRAWS = {
    "rand": lambda: np.random.rand(3),  # noqa: NPY002
    "seed": lambda: np.random.seed(1),  # noqa: NPY002
    "shuffle": lambda: np.random.shuffle([1, 2]),  # noqa: NPY002
    "imported rand": lambda: imported_rand(3),  # noqa: NPY002
    "imported default_rng": lambda: imported_default_rng(None),
    "Generator": lambda: np.random.Generator(np.random.MT19937()),
    "choice": lambda: random.choice([1, 2]),
    "imported shuffle": lambda: imported_shuffle([1, 2, 3]),
    "SystemRandom": lambda: random.SystemRandom().random(),
    "urandom": lambda: os.urandom(4),
    "secrets": lambda: secrets.randbits(8),
    "default_rng": lambda: _called(np.random, "default_rng"),
    "RandomState": lambda: _called(np.random, "RandomState"),
    "SeedSequence": lambda: _called(np.random, "SeedSequence"),
    "random": lambda: _called(random, "random"),
    "Random": lambda: _called(random, "Random"),
}


def _called(module, name):
    return getattr(module, name)()


@pytest.mark.parametrize("name", DRAWS)
def test_what_no_seed_governs_fails(name):
    with pytest.raises(UnseededError), seeded_only():
        DRAWS[name]()


def test_it_fails_where_the_failure_is_swallowed():
    with pytest.raises(UnseededError, match=r"random\.random"), seeded_only(), contextlib.suppress(AssertionError):
        random.random()


def test_what_a_seed_governs_passes_and_draws_the_same():
    def draw():
        return [
            np.random.default_rng(1).random(),
            np.random.RandomState(2).rand(),
            np.random.Generator(np.random.PCG64(3)).random(),
            random.Random(4).random(),
            np.random.default_rng(np.random.SeedSequence(5).spawn(2)[1]).random(),
            copy.deepcopy(np.random.default_rng(6)).random(),
        ]

    with seeded_only():
        inside = draw()
    assert inside == draw()


class Unseeded:
    """A strategy that breaks the contract."""

    def run(self, problem, evaluate, seed):
        evaluate(problem.space.sample(4, np.random.default_rng()))


def test_a_strategy_that_ignores_its_seed_fails():
    problem = toy_problem()
    with pytest.raises(UnseededError), seeded_only():
        Unseeded().run(problem, lambda designs: problem.tell(problem.simulate(designs)), 1)


def test_nsga3_as_pymoo_has_it_fails():
    """Its tournament has no seed for a tie of violations; ours has, see `divideropt.strategies.nsga3`."""
    problem = toy_problem()

    def score(designs):
        told = problem.tell(problem.simulate(designs))
        return told.F, told.G

    algorithm = PymooNSGA3(get_reference_directions("das-dennis", 2, n_partitions=5), pop_size=12)
    with pytest.raises(UnseededError, match="without a seed"), seeded_only():
        drive(algorithm, problem.space, (2, problem.constraint_count), score, 6, seed=1)
