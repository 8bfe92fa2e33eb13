"""Models whose sensitivity indices are known in closed form, and one that fails in a known part of its box."""

from itertools import combinations

import numpy as np
from SALib.sample import sobol

from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict

A, B = 7.0, 0.1
"""Of the Ishigami function, as Ishigami and Homma (1990) took them."""

G_COEFFICIENTS = (0.0, 0.5, 3.0, 9.0, 99.0, 99.0)
"""Of the G-function: from a variable that matters most to two that hardly do (Saltelli and Sobol' 1995)."""


class Ishigami:
    """sin x1 + a sin² x2 + b x3⁴ sin x1 of three variables within ±π."""

    def __init__(self):
        domain = Domain(-np.pi, np.pi)
        self.parameters = {n: Parameter(n, "", n, "an angle", 0.0, domain) for n in ("x1", "x2", "x3")}
        self.quantities = {
            "f": Quantity("f", "", "f", "the function", 1.0),
            "constant": Quantity("constant", "", "", "always 3", 1.0),
        }

    def evaluate(self, designs):
        x1, x2, x3 = designs.T
        f = np.sin(x1) + A * np.sin(x2) ** 2 + B * x3**4 * np.sin(x1)
        return np.column_stack([f, np.full(len(f), 3.0)]), [Verdict(Outcome.OK)] * len(f)


class SmallIshigami(Ishigami):
    """The same in numbers of some 1e-15."""

    def evaluate(self, designs):
        quantities, verdicts = super().evaluate(designs)
        return 1e-15 * quantities, verdicts


class GFunction:
    """The product of (|4 x_i - 2| + a_i)/(1 + a_i), of six variables within 0 and 1."""

    def __init__(self):
        names = [f"x{i + 1}" for i in range(len(G_COEFFICIENTS))]
        self.parameters = {n: Parameter(n, "", n, "a number", 0.5, Domain(0.0, 1.0)) for n in names}
        self.quantities = {"g": Quantity("g", "", "g", "the function", 1.0)}

    def evaluate(self, designs):
        a = np.array(G_COEFFICIENTS)
        g = ((np.abs(4 * designs - 2) + a) / (1 + a)).prod(axis=1)
        return g[:, None], [Verdict(Outcome.OK)] * len(g)


class Failing:
    """x1 + x2 + x3 in the unit cube, which fails where x1 is below `below`; `kept` is there all the same."""

    def __init__(self, below=0.25):
        self.below = below
        self.parameters = {n: Parameter(n, "", n, "a number", 0.5, Domain(0.0, 1.0)) for n in ("x1", "x2", "x3")}
        self.quantities = {
            "lost": Quantity("lost", "", "", "the sum, not defined where the design fails", 1.0),
            "kept": Quantity("kept", "", "", "the sum", 1.0, signed=True),
        }

    def evaluate(self, designs):
        failed = designs[:, 0] < self.below
        total = designs.sum(axis=1)
        text = "x1 is too small"
        verdicts = [Verdict(Outcome.UNSETTLED, text) if f else Verdict(Outcome.OK) for f in failed]
        return np.column_stack([np.where(failed, np.nan, total), -total]), verdicts


def ishigami_indices():
    """First-order, total and second-order indices by variable or pair (Homma and Saltelli 1996)."""
    v1 = (1 + B * np.pi**4 / 5) ** 2 / 2
    v2 = A**2 / 8
    v13 = B**2 * np.pi**8 * (1 / 18 - 1 / 50)
    v = v1 + v2 + v13
    first = {"x1": v1 / v, "x2": v2 / v, "x3": 0.0}
    total = {"x1": (v1 + v13) / v, "x2": v2 / v, "x3": v13 / v}
    second = {("x1", "x2"): 0.0, ("x1", "x3"): v13 / v, ("x2", "x3"): 0.0}
    return first, total, second


def g_indices():
    """First-order, total and second-order indices: V_i = 1/(3 (1 + a_i)²), and of a product V = Π (1 + V_i) - 1."""
    v = 1 / (3 * (1 + np.array(G_COEFFICIENTS)) ** 2)
    variance = np.prod(1 + v) - 1
    names = [f"x{i + 1}" for i in range(len(v))]
    first = dict(zip(names, v / variance, strict=True))
    total = {n: v[i] * np.prod(np.delete(1 + v, i)) / variance for i, n in enumerate(names)}
    second = {(names[i], names[j]): v[i] * v[j] / variance for i, j in combinations(range(len(v)), 2)}
    return first, total, second


def sample(model, samples, second_order=True, seed=1):
    """Designs of a Sobol study of a model over its parameters' domains."""
    names = list(model.parameters)
    bounds = [[p.domain.lower, p.domain.upper] for p in model.parameters.values()]
    description = {"num_vars": len(names), "names": names, "bounds": bounds}
    return sobol.sample(description, samples, calc_second_order=second_order, seed=seed)
