import dataclasses

import numpy as np
import pytest

from divideropt.problem import Told
from divideropt.problem.problem import INFEASIBLE_MERIT
from divideropt.strategies import reference_directions
from divideropt.strategies.archive import UTOPIA_MARGIN, Archive, Scale, reached
from toy_model import toy_problem


def archive_of(*batches):
    """Return an archive that was told batches of (designs, objectives, violations)."""
    answers = iter(batches)

    def evaluate(designs):
        _, F, violation = next(answers)
        return Told(F, np.column_stack([np.zeros(len(F)), violation]))

    problem = toy_problem()
    objectives = problem.objectives[:1] * batches[0][1].shape[1]
    archive = Archive(dataclasses.replace(problem, objectives=objectives), evaluate)
    for designs, *_ in batches:
        archive.score(designs)
        archive.settle()
    return archive


def batch(F, violation=0.0):
    """Objectives and violations with designs that tell them apart."""
    F = np.array(F, dtype=float)
    designs = np.random.default_rng(len(F)).random((len(F), 3))
    return designs, F, np.broadcast_to(np.asarray(violation, dtype=float), len(F))


def front_of(X, F):
    """Return the non-dominated, one by one, the first of equals."""
    dominated = [((f >= F).all(axis=1) & (f > F).any(axis=1)).any() for f in F]
    repeated = [(F[:i] == f).all(axis=1).any() for i, f in enumerate(F)]
    kept = ~np.array(dominated) & ~np.array(repeated)
    return sorted(map(tuple, np.column_stack([X, F])[kept]))


@pytest.mark.parametrize("objectives", [1, 2, 3])
def test_its_front_is_that_of_all_it_was_told(objectives):
    """Also where objectives are equal: they are whole numbers here."""
    random = np.random.default_rng(1)
    batches = []
    for i in range(60):
        n = int(random.integers(1, 30))
        F = random.integers(0, 40, (n, objectives)).astype(float)
        F[:, -1] += 100 // (i + 1)  # later batches are better
        batches.append((random.random((n, 3)), F, np.where(random.random(n) < 0.2, 1.0, 0.0)))
    archive = archive_of(*batches)
    X, F, violation = (np.concatenate(parts) for parts in zip(*batches, strict=True))
    feasible = violation <= 0.0
    assert sorted(map(tuple, np.column_stack([archive.X, archive.F]))) == front_of(X[feasible], F[feasible])


def test_settling_without_news_changes_nothing():
    archive = archive_of(batch([[1, 2], [2, 1], [2, 2]]))
    before = archive.F.tobytes()
    archive.settle()
    assert archive.F.tobytes() == before
    assert len(archive.F) == 2


def test_before_anything_is_feasible_it_knows_the_least_violation():
    first, second = batch([[1, 2], [2, 1]], [0.5, 0.3]), batch([[0, 0], [9, 9], [3, 3]], [0.7, 0.4, 0.2])
    archive = archive_of(first, second)
    assert not archive.feasible
    assert archive.F.tolist() == [[0, 0]]  # the front of the infeasible
    design, merit = archive.nearest(lambda F: F.sum(axis=1))
    assert design.tolist() == second[0][2].tolist()
    assert merit == INFEASIBLE_MERIT + 0.2


def test_one_feasible_design_displaces_the_infeasible_however_good():
    last = batch([[5, 5], [0, 0]], [0.0, 1.0])
    archive = archive_of(batch([[1, 2], [2, 1]], 0.5), last, batch([[0, 1]], 2.0))
    assert archive.feasible
    assert archive.F.tolist() == [[5, 5]]
    design, merit = archive.nearest(lambda F: F.sum(axis=1))
    assert design.tolist() == last[0][0].tolist()
    assert merit == 10.0


def test_a_scale_begins_below_the_ideal_point_and_has_the_median_for_its_unit():
    archive = archive_of(batch([[1, 90], [2, 50], [5, 40], [6, 20], [1000, 10]]))
    scale = archive.scale()
    assert scale.unit.tolist() == [4, 30]  # the outlier at 1000 counts as one design
    assert np.allclose(scale.utopia, [1 - UTOPIA_MARGIN * 4, 10 - UTOPIA_MARGIN * 30])
    assert (scale.utopia < archive.F.min(axis=0)).all()
    scaled = scale.of(archive.F)
    assert np.allclose(scaled.min(axis=0), UTOPIA_MARGIN)
    assert np.allclose(np.median(scaled, axis=0), 1.0 + UTOPIA_MARGIN)


def test_below_the_utopian_point_everything_scales_to_just_above_zero():
    scaled = Scale(np.array([1.0, 1.0]), np.array([2.0, 4.0])).of(np.array([[0.0, 3.0], [-1e9, 1.0]]))
    assert scaled[0, 1] == 0.5
    assert ((scaled > 0.0) & ((scaled < 1e-300) | (scaled == 0.5))).all()


def test_an_objective_that_is_flat_has_the_unit_one_and_one_without_a_median_its_extent():
    tied = Archive(toy_problem(), lambda designs: Told(designs, np.zeros((len(designs), 1))))
    tied.F = np.array([[7.0, 0.0, 4.0], [7.0, 0.0, 3.0], [7.0, 8.0, 1.0]])
    assert tied.scale().unit.tolist() == [1.0, 8.0, 2.0]


@pytest.mark.parametrize("objectives", [1, 2, 3])
def test_what_is_reached_is_the_least_greatest_quotient(objectives):
    random = np.random.default_rng(2)
    archive = archive_of((random.random((200, 3)), random.random((200, objectives)), np.zeros(200)))
    scale, weights = archive.scale(), reference_directions(objectives, 40)
    expected = [min(((f - scale.utopia) / scale.unit / w).max() for f in archive.F) for w in weights]
    assert reached(archive, scale, weights) == pytest.approx(expected, rel=1e-12)
