"""On a box that is not the unit's: distances count in parts of it."""

import dataclasses

import numpy as np
import pytest

from divideropt.problem import DesignSpace, Told, Variable
from divideropt.problem.problem import FAILURE_VIOLATION
from divideropt.strategies import reference_directions
from divideropt.strategies.archive import Archive
from divideropt.strategies.local_model import points_wanted
from divideropt.strategies.polishing import LARGEST_REACH, LEAST_GAIN, RESOLUTION, SMALLEST_REACH, Polisher
from toy_model import toy_problem

LOWER, UPPER = np.array([-2.0, 0.0, 100.0]), np.array([2.0, 1e-3, 300.0])
DIRECTIONS = reference_directions(2, 16)


def tell(designs):
    """Two bowls, and a constraint that cuts off a corner, in parts of the box; the front is a line between them."""
    u = (designs - LOWER) / (UPPER - LOWER)
    F = np.column_stack([((u - c) ** 2).sum(axis=1) for c in (0.3, 0.7)])
    return Told(F, np.column_stack([np.zeros(len(u)), u.sum(axis=1) - 2.4]))


class Known:
    """A polisher and an archive that know the same."""

    def __init__(self, count, seed=1):
        problem = toy_problem()
        box = zip(problem.space.variables, LOWER, UPPER, strict=True)
        space = DesignSpace(tuple(Variable(v.parameter, low, up) for v, low, up in box))
        self.archive = Archive(dataclasses.replace(problem, space=space), tell)
        self.polisher = Polisher(space)
        self.designs = np.empty((0, 3))
        self.add(space.sample(count, np.random.default_rng(seed)))

    def add(self, designs):
        told = self.archive.score(designs)
        self.archive.settle()
        self.polisher.hear(designs, told)
        self.designs = np.concatenate([self.designs, designs])
        return told

    def propose(self, most=100, directions=DIRECTIONS):
        self.scale = self.archive.scale()
        return self.polisher.propose(self.archive, self.scale, directions, most)


def apart(designs, others):
    """Distances in the variable where they are greatest, in parts of the box, shape (n, m)."""
    return (np.abs(designs[:, None] - others[None]) / (UPPER - LOWER)).max(axis=2)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_no_design_is_proposed_that_is_all_but_known(seed):
    known, blocks = Known(80, seed), []
    for _ in range(12):
        designs, visits = known.propose()
        assert len(designs) == len(visits)
        if len(designs):
            blocks.append(len(designs))
            assert apart(designs, known.designs).min() >= RESOLUTION - 1e-12
            assert (apart(designs, designs) + np.eye(len(designs))).min() >= RESOLUTION - 1e-12
            known.polisher.learn(designs, known.add(designs), known.scale, visits)
    assert sum(blocks) > 20  # or nothing had been shown


def test_polishing_comes_close_to_the_front():
    known = Known(80)
    for _ in range(12):
        designs, visits = known.propose()
        known.polisher.learn(designs, known.add(designs), known.scale, visits)
    t = (known.archive.F[:, 0] / 0.48) ** 0.5  # the front: f1 = 0.48 t², f2 = 0.48 (1 - t)²
    within = t <= 1.0
    beyond = (known.archive.F[:, 1] / 0.48) ** 0.5 - (1.0 - t)
    assert within.sum() > 10
    assert np.median(beyond[within]) < 2e-3


def test_nothing_is_proposed_before_enough_is_known_for_a_model():
    enough = points_wanted(3)
    designs, visits = Known(enough).propose()
    assert designs.shape == (0, 3)
    assert visits == []
    assert len(Known(enough + 1).propose()[0]) > 0


def test_no_more_are_proposed_than_asked_for_the_first_directions_first():
    all_of_them, _ = Known(80).propose()
    few, visits = Known(80).propose(most=3)
    assert len(few) == len(visits) == 3
    assert few.tobytes() == all_of_them[:3].tobytes()


def test_every_proposal_stays_in_the_box_and_within_reach_of_its_member():
    known = Known(80)
    designs, visits = known.propose()
    parts = (designs - LOWER) / (UPPER - LOWER)
    for part, visit in zip(parts, visits, strict=True):
        assert ((part >= 0.0) & (part <= 1.0)).all()
        assert np.abs(part - visit.member).max() <= visit.reach + 1e-12
        scaled = known.scale.of(tell((LOWER + visit.member * (UPPER - LOWER))[None]).F)
        assert visit.attained == pytest.approx((scaled / visit.direction).max(), rel=1e-9)
        assert any((visit.direction == direction).all() for direction in DIRECTIONS)


def first_visit(known):
    """One proposal for the middle direction alone."""
    designs, visits = known.propose(directions=DIRECTIONS[7:8])
    assert len(designs) == 1
    return designs, visits[0]


def disappointing(known, designs):
    """What is told where a step has brought nothing."""
    return Told(tell(designs).F + 10.0, np.zeros((len(designs), 2)))


def test_a_step_that_brings_nothing_is_held_to_half_the_reach_from_there_on():
    known = Known(80)
    designs, visit = first_visit(known)
    known.polisher.learn(designs, disappointing(known, designs), known.scale, [visit])
    _, again = first_visit(known)
    assert again.member.tobytes() == visit.member.tobytes()
    assert again.reach == 0.5 * visit.reach


def test_a_step_that_is_not_feasible_is_one_that_brings_nothing():
    known = Known(80)
    designs, visit = first_visit(known)
    good = tell(designs)
    known.polisher.learn(designs, Told(good.F, good.G + 9.0), known.scale, [visit])
    assert first_visit(known)[1].reach == 0.5 * visit.reach


def test_the_reach_never_falls_below_its_floor():
    known = Known(80)
    designs, visit = first_visit(known)
    for _ in range(20):
        tiny = dataclasses.replace(visit, reach=known_reach(known, visit))
        known.polisher.learn(designs, disappointing(known, designs), known.scale, [tiny])
    assert known_reach(known, visit) == SMALLEST_REACH


def known_reach(known, visit):
    """How far a step from a member may go now; its steps may be too short to promise anything."""
    return known.polisher._reaches.get(visit.member.tobytes(), visit.reach)


def test_from_a_design_that_has_gained_a_step_may_go_twice_as_far():
    known = Known(80)
    designs, visit = first_visit(known)
    for _ in range(2):  # held well below the radius of the model, which would cap it
        known.polisher.learn(designs, disappointing(known, designs), known.scale, [visit])
        designs, visit = first_visit(known)
    known.polisher.learn(designs, known.add(designs), known.scale, [visit])
    _, further = first_visit(known)
    assert further.member == pytest.approx((designs[0] - LOWER) / (UPPER - LOWER))
    assert further.attained < visit.attained * (1.0 - LEAST_GAIN)
    assert further.reach == 2.0 * visit.reach
    assert further.reach < LARGEST_REACH


def test_designs_that_failed_are_not_fitted():
    honest, deceived = Known(80), Known(80)
    failed = LOWER + (UPPER - LOWER) * np.random.default_rng(9).random((60, 3))
    nonsense = Told(np.full((60, 2), 1e4), np.column_stack([np.full(60, FAILURE_VIOLATION), np.full(60, 1e6)]))
    deceived.polisher.hear(failed, nonsense)
    assert honest.propose()[0].tobytes() == deceived.propose()[0].tobytes()
