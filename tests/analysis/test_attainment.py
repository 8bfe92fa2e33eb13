"""Attainment surfaces against their definition."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from divideropt.analysis import attainment_surface, median_surface, nondominated, worst_surface

VALUES = st.integers(0, 5).map(float)


def runs(k):
    return st.lists(arrays(float, st.tuples(st.integers(0, 4), st.just(k)), elements=VALUES), min_size=1, max_size=5)


@given(st.sampled_from([2, 3]).flatmap(runs), st.data())
def test_it_dominates_what_so_many_runs_dominate(fronts, data):
    wanted = data.draw(st.integers(1, len(fronts)))
    surface = attainment_surface(fronts, wanted)
    lattice = np.stack(np.meshgrid(*[np.arange(6.0)] * fronts[0].shape[1]), axis=-1).reshape(-1, fronts[0].shape[1])

    def attained(front):
        return (front[:, None] <= lattice).all(axis=2).any(axis=0)

    assert (attained(surface) == (sum(attained(f).astype(int) for f in fronts) >= wanted)).all()
    assert nondominated(surface).all()


def test_median_and_worst_of_nested_fronts():
    """Runs whose fronts lie one above the other: the k-th surface is the k-th front."""
    line = np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0]])
    for count in range(1, 30):
        fronts = [line + shift for shift in np.random.default_rng(count).permutation(count)]
        for k in range(1, count + 1):
            assert sorted(attainment_surface(fronts, k).tolist()) == (line + k - 1).tolist()
        assert sorted(median_surface(fronts).tolist()) == (line + (count + 1) // 2 - 1).tolist()
        assert sorted(worst_surface(fronts).tolist()) == (line + count - 1).tolist()


def test_what_cannot_be_is_refused():
    with pytest.raises(ValueError, match="a surface of 3 of 2 runs"):
        attainment_surface([np.ones((1, 2))] * 2, 3)
    with pytest.raises(ValueError, match="4 objectives"):
        worst_surface([np.ones((1, 4))])
