"""The KKT residual on problems whose stationary points are known on paper."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from divideropt.analysis.differences import NODES, STEP, neighbours, slopes_at
from divideropt.analysis.optimality import optimality
from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict
from divideropt.problem import Constraint, DesignSpace, Objective, Problem, Variable


class Formulas:
    """A model of given formulas, on a box that is not that of 0 and 1, with a side on which it fails."""

    def __init__(self, formulas, signed=(), fails=lambda u: False, count=2, unit=1.0):
        self.formulas, self.fails, self.unit = formulas, fails, unit
        names = [f"x{i}" for i in range(count)]
        self.parameters = {n: Parameter(n, "", n, "a number", 0.0, Domain()) for n in names}
        self.quantities = {n: Quantity(n, "", n, "a result", 1.0, signed=n in signed) for n in formulas}

    def evaluate(self, designs):
        u = (designs / self.unit).T
        quantities = np.column_stack([f(u) * np.ones(len(designs)) for f in self.formulas.values()])
        failed = [self.fails(row) for row in u.T]
        return quantities, [Verdict(Outcome.CRASHED if f else Outcome.OK) for f in failed]


def measure(model, objectives, at, constraints=(), scales=None):
    """The residual at a point, whose coordinates are parts of the box."""
    problem = Problem(
        model=model,
        fixed=dict.fromkeys(model.parameters, 0.0),
        space=DesignSpace(tuple(Variable(p, 0.0, model.unit) for p in model.parameters.values())),
        objectives=tuple(Objective(model.quantities[name]) for name in objectives),
        constraints=tuple(Constraint(model.quantities[n], low, high) for n, low, high in constraints),
    )
    design = np.array(at, dtype=float) * model.unit
    here = problem.simulate(design[None])
    around = problem.simulate(neighbours(design, problem.space))
    return optimality(problem, np.array(scales or [1.0] * len(objectives)), design, here.quantities[0], around)


def bowl(a, b):
    return lambda u: (u[0] - a) ** 2 + (u[1] - b) ** 2


BOWLS = {"f": bowl(0.3, 0.5), "g": bowl(0.7, 0.5)}
"""Their Pareto set is the segment between (0.3, 0.5) and (0.7, 0.5)."""


@pytest.mark.parametrize("at", [(0.3, 0.5), (0.4, 0.5), (0.62, 0.5), (0.7, 0.5)])
def test_it_is_zero_on_the_pareto_set(at):
    assert measure(Formulas(BOWLS), ["f", "g"], at).residual == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize(
    ("at", "rate"),
    [
        ((0.5, 0.6), 0.2),  # both gradients have 0.2 across the segment, and opposite shares along it
        ((0.3, 0.1), 0.8),
        ((0.8, 0.5), 0.2),  # beyond the end that is nearer: the lesser gradient
    ],
)
def test_off_it_the_residual_is_the_rate_at_which_both_can_be_improved(at, rate):
    found = measure(Formulas(BOWLS), ["f", "g"], at)
    assert found.residual == pytest.approx(rate, rel=1e-9)
    assert found.floor < 1e-9


def test_one_objective_has_the_length_of_its_gradient():
    assert measure(Formulas(BOWLS), ["f"], (0.6, 0.9)).residual == pytest.approx(2 * math.hypot(0.3, 0.4), rel=1e-9)


def test_a_bound_of_the_box_holds_what_would_leave_it():
    model = Formulas({"f": lambda u: u[0] + u[1], "g": lambda u: 1 - u[0] + u[1]})
    assert measure(model, ["f", "g"], (0.5, 0.3)).residual == pytest.approx(1.0, rel=1e-9)
    assert measure(model, ["f", "g"], (0.5, 0.0)).residual == pytest.approx(0.0, abs=1e-10)
    assert measure(model, ["f", "g"], (0.5, 0.9 * STEP)).residual == pytest.approx(0.0, abs=1e-10)
    assert measure(model, ["f", "g"], (0.5, 1.1 * STEP)).residual == pytest.approx(1.0, rel=1e-9)
    assert measure(model, ["f", "g"], (0.5, 1.0)).residual == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("scale", [1.0, 1e-9, 1e9])
def test_an_active_constraint_holds_too_and_an_inactive_one_does_not(scale):
    model = Formulas(BOWLS | {"c": lambda u: scale * (u[0] + 2 * u[1])})
    at = (0.5, 0.6)
    for bound in (("c", 1.7 * scale, None), ("c", 1.7 * scale, 9 * scale)):
        assert measure(model, ["f", "g"], at, [bound]).residual == pytest.approx(0.0, abs=1e-9)
    for bound in (("c", None, 1.7 * scale), ("c", 1.6 * scale, None), ("c", -9 * scale, 9 * scale)):
        assert measure(model, ["f", "g"], at, [bound]).residual == pytest.approx(0.2, rel=1e-9)


def test_units_change_nothing():
    model = Formulas(BOWLS | {"c": lambda u: u[0] - u[1]})
    same = Formulas({"f": BOWLS["f"], "g": lambda u: 1e-6 * BOWLS["g"](u), "c": model.formulas["c"]}, unit=1e-4)
    at = (0.45, 0.8)
    expected = measure(model, ["f", "g"], at, [("c", -0.35, None)])
    found = measure(same, ["f", "g"], at, [("c", -0.35, None)], [1.0, 1e-6])
    assert found.residual == pytest.approx(expected.residual, rel=1e-9)
    assert expected.residual > 0.1


def test_it_is_the_least_that_another_solver_finds():
    random = np.random.default_rng(5)
    for _ in range(20):
        slopes = random.normal(size=(4, 3)) + 0.8
        names = ["f", "g", "h", "c"]
        formulas = {n: (lambda u, s=s: s @ u) for n, s in zip(names, slopes, strict=True)}
        model = Formulas(formulas, count=3)
        at = (0.5, 0.0, 0.5)
        bound = float(slopes[3] @ at)
        found = measure(model, names[:3], at, [("c", None, bound)])
        columns = np.column_stack([*slopes[:3], slopes[3], [0.0, -1.0, 0.0]])
        peer = minimize(
            lambda z, a=columns: np.sum((a @ z) ** 2),
            np.array([1 / 3, 1 / 3, 1 / 3, 0.1, 0.1]),
            bounds=[(0.0, None)] * 5,
            constraints={"type": "eq", "fun": lambda z: z[:3].sum() - 1.0},
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 500},
        )
        assert found.residual == pytest.approx(math.sqrt(peer.fun), abs=1e-5)


def test_there_is_a_direction_that_improves_all_at_that_rate():
    at = np.array([0.2, 0.8])
    rate = measure(Formulas(BOWLS), ["f", "g"], at).residual
    angles = np.linspace(0.0, 2 * np.pi, 100_001)
    ways = np.column_stack([np.cos(angles), np.sin(angles)])
    gradients = np.array([2 * (at - [0.3, 0.5]), 2 * (at - [0.7, 0.5])])
    assert rate == pytest.approx((-ways @ gradients.T).min(axis=1).max(), rel=1e-6)


@pytest.mark.parametrize("at", [0.5, 0.5 + 0.66 * STEP, 0.5 - STEP, 0.5 + 1.5 * STEP])
def test_at_a_kink_it_is_not_defined(at):
    model = Formulas({"f": lambda u: np.abs(u[0] - 0.5) + u[1], "g": lambda u: 1 - u[1]})
    assert not measure(model, ["f", "g"], (at, 0.4)).defined
    assert measure(model, ["f", "g"], (0.5 + 2.1 * STEP, 0.4)).residual == pytest.approx(math.sqrt(0.2), rel=1e-6)


def test_a_kink_of_a_constraint_counts_only_where_that_is_active():
    model = Formulas(BOWLS | {"c": lambda u: np.abs(u[0] - 0.5)})
    assert not measure(model, ["f", "g"], (0.5, 0.6), [("c", None, 0.5 * STEP)]).defined
    assert measure(model, ["f", "g"], (0.5, 0.6), [("c", None, 0.2)]).defined


def test_curvature_is_no_kink():
    model = Formulas({"f": lambda u: np.exp(6 * (u[0] - 1)) + u[1], "g": lambda u: 40 * (u[1] - 0.4) ** 2 - u[0]})
    assert measure(model, ["f", "g"], (0.99, 0.4)).defined


def test_a_signed_objective_is_held_at_zero_and_what_is_left_is_asked_of_the_others():
    formulas = {"s": lambda u: u[0] - 0.5, "g": bowl(0.8, 0.5), "h": bowl(0.8, 0.7)}
    model = Formulas(formulas, signed=("s",))
    on, beside = (0.5, 0.6), (0.5, 0.9)
    assert measure(model, ["s", "g"], (0.5, 0.5)).residual == pytest.approx(0.0, abs=1e-10)
    assert measure(model, ["s", "g"], on).residual == pytest.approx(0.2, rel=1e-9)
    assert measure(model, ["s", "g", "h"], on).residual == pytest.approx(0.0, abs=1e-10)
    assert measure(model, ["s", "g", "h"], beside).residual == pytest.approx(0.4, rel=1e-9)
    assert measure(model, ["s"], beside).residual == 0.0


def test_away_from_zero_it_counts_by_its_magnitude():
    model = Formulas({"s": lambda u: u[0] - 0.5, "g": lambda u: u[0]}, signed=("s",))
    assert measure(model, ["s", "g"], (0.3, 0.5)).residual == pytest.approx(0.0, abs=1e-10)
    assert measure(model, ["s", "g"], (0.7, 0.5)).residual == pytest.approx(1.0, rel=1e-9)
    bounds = [("s", None, 0.2)]
    outside = Formulas({"s": model.formulas["s"], "g": lambda u: u[0]}, signed=("s",))
    assert measure(outside, ["g"], (0.3, 0.5), bounds).residual == pytest.approx(0.0, abs=1e-10)
    assert measure(outside, ["g"], (0.7, 0.5), bounds).residual == pytest.approx(1.0, rel=1e-9)


def test_a_side_that_fails_is_a_bound_and_the_slope_comes_from_the_other():
    model = Formulas({"f": lambda u: u[0] ** 2 + u[1]}, fails=lambda u: u[0] < 0.5 - 0.1 * STEP)
    found = measure(model, ["f"], (0.5, 0.0))
    assert found.residual == pytest.approx(0.0, abs=1e-10)
    assert measure(model, ["f"], (0.5, 0.5)).residual == pytest.approx(1.0, rel=1e-9)
    rising = Formulas({"f": lambda u: -(u[0] ** 2) + u[1]}, fails=model.fails)
    assert measure(rising, ["f"], (0.5, 0.0)).residual == pytest.approx(1.0, rel=1e-6)


def test_where_both_sides_fail_it_is_not_defined():
    model = Formulas(BOWLS, fails=lambda u: abs(u[0] - 0.5) > 0.1 * STEP)
    assert not measure(model, ["f", "g"], (0.5, 0.5)).defined


@pytest.mark.parametrize("noise", [1e-6, 1e-5, 1e-4])
def test_the_floor_grows_with_the_noise_and_covers_what_it_makes(noise):
    """A residual of 0 comes out as noise; with the floor as one standard deviation in each direction."""
    random = np.random.default_rng(11)
    noisy = {n: (lambda u, f=f: f(u) + noise * random.normal(size=len(u[0]))) for n, f in BOWLS.items()}
    points = [measure(Formulas(noisy), ["f", "g"], (x, 0.5)) for x in np.linspace(0.35, 0.65, 200)]
    residuals, floors = np.array([(p.residual, p.floor) for p in points if p.defined]).T
    assert len(residuals) > 0.95 * len(points)
    assert np.median(floors) == pytest.approx(0.9 * noise / STEP, rel=0.5)
    assert 0.2 < np.median(residuals / floors) < 1.0
    assert (residuals <= 3 * floors).mean() > 0.95


def test_the_error_of_a_slope_is_what_noise_makes_of_it():
    random = np.random.default_rng(3)
    space = DesignSpace((Variable(Parameter("x", "", "x", "", 0.5, Domain()), 0.0, 1.0),))
    design = np.array([0.5])
    found = [
        slopes_at(
            design,
            space,
            *np.split(random.normal(size=(2 * NODES - 1, 1)), [1]),
            np.ones(2 * (NODES - 1), dtype=bool),
        )
        for _ in range(5_000)
    ]
    middle = np.array([slopes.gradients[0, 0] for slopes in found])
    errors = np.array([slopes.errors[0, 0] for slopes in found])
    assert math.sqrt(np.mean(errors**2)) == pytest.approx(middle.std(), rel=0.05)


@pytest.mark.parametrize("at", [0.0, 0.5 * STEP, 1.5 * STEP, 0.5, 1 - 1.5 * STEP, 1 - 0.5 * STEP, 1.0])
def test_neighbours_stay_in_the_box_and_slopes_are_exact_for_polynomials(at):
    space = DesignSpace((Variable(Parameter("x", "", "x", "", 0.5, Domain()), -2.0, 6.0),))
    design = np.array([-2.0 + 8.0 * at])
    around = neighbours(design, space)
    assert len(np.unique(around)) == 2 * (NODES - 1)
    assert (design != around).all()
    assert around.min() >= -2.0
    assert around.max() <= 6.0
    slopes = slopes_at(design, space, (design / 8) ** 4, (around / 8) ** 4, np.ones(2 * (NODES - 1), dtype=bool))
    assert slopes.gradients[0, 0] == pytest.approx(4 * (design[0] / 8) ** 3, abs=1e-9)


def test_noise_is_told_from_a_kink():
    """Noise whose third differences would be slopes of 0.2; a kink of 0.5 in noise that is a tenth of that."""
    random = np.random.default_rng(7)

    def noisy(formula, noise):
        return lambda u: formula(u) + noise * random.normal(size=len(u[0]))

    for noise, kink, defined in ((0.045 * STEP, 0.0, True), (0.0045 * STEP, 0.5, False), (0.0, 0.5, False)):
        model = Formulas(
            {"f": noisy(lambda u, k=kink: u[1] + k * np.abs(u[0] - 0.5), noise), "g": lambda u: 1 - u[0]}
        )
        found = [measure(model, ["f", "g"], (0.5, y)).defined for y in np.linspace(0.2, 0.8, 100)]
        assert np.mean([f is defined for f in found]) > 0.95
