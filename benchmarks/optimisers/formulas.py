"""A test problem of pymoo's as a model of ours."""

from collections.abc import Sequence

import numpy as np
from pymoo.core.problem import Problem as PymooProblem

from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict
from divideropt.models.base import FloatArray
from divideropt.problem import Constraint, DesignSpace, Objective, Problem, Variable


def problem_of(formula: PymooProblem, scale: FloatArray) -> Problem:
    """Make our problem of pymoo's.

    Args:
        formula: Its objectives are minimised, its constraints met where at most 0.
        scale: A typical size of each objective, shape (k,).

    Returns:
        The same in our words: what every player of the benchmark is told comes from it.
    """
    model = Formula(formula, scale)
    parameters, q = model.parameters, model.quantities
    return Problem(
        model=model,
        fixed={name: p.default for name, p in parameters.items()},
        space=DesignSpace(tuple(Variable(p, p.domain.lower, p.domain.upper) for p in parameters.values())),
        objectives=tuple(Objective(q[f"f{i}"]) for i in range(1, formula.n_obj + 1)),
        constraints=tuple(Constraint(q[f"g{i}"], maximum=0.0) for i in range(1, formula.n_ieq_constr + 1)),
    )


class Formula:
    """A model of no cost: x1, x2, … to f1, f2, … and g1, g2, …."""

    def __init__(self, formula: PymooProblem, scale: FloatArray) -> None:
        """Name its variables, objectives and constraints."""
        self._formula = formula
        bounds = zip(np.asarray(formula.xl).tolist(), np.asarray(formula.xu).tolist(), strict=True)
        self.parameters = {
            f"x{i}": Parameter(f"x{i}", "", f"x{i}", "a variable", (a + b) / 2, Domain(a, b))
            for i, (a, b) in enumerate(bounds, start=1)
        }
        names = [f"f{i}" for i in range(1, formula.n_obj + 1)]
        self.quantities = {
            name: Quantity(name, "", name, "an objective", float(size))
            for name, size in zip(names, scale, strict=True)
        }
        for i in range(1, formula.n_ieq_constr + 1):
            self.quantities[f"g{i}"] = Quantity(f"g{i}", "", f"g{i}", "a constraint", 1.0)

    def evaluate(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Compute a batch; see `divideropt.models.base.Model`."""
        F, G = self._formula.evaluate(designs, return_values_of=["F", "G"])
        return np.column_stack([F, G]), [_FINE] * len(designs)


_FINE = Verdict(Outcome.OK)
