"""A model whose numbers are as large or as small as its options say."""

import numpy as np

from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict


class Vast:
    """Two objectives in conflict, of a size, over parameters of another."""

    def __init__(self, size=1.0, span=1.0):
        self.size, self.span = float(size), float(span)
        self.parameters = {n: Parameter(n, "", n, "a number", self.span, Domain()) for n in ("x1", "x2")}
        self.quantities = {n: Quantity(n, "", n, "a number", 1.0) for n in ("f1", "f2", "spare")}

    def evaluate(self, designs):
        x1, x2 = designs.T / self.span
        spread = 1.0 + 0.3 * np.sin(3.0 * x2)
        quantities = self.size * np.column_stack([x1 * spread, 1.3 - x1 + 0.1 * x2**2, x2])
        return quantities, [Verdict(Outcome.OK)] * len(designs)
