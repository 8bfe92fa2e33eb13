"""A model that costs nothing: two objectives in conflict, a region where it fails, a signed quantity."""

import os
import signal
from pathlib import Path

import numpy as np

from divideropt.models import Domain, Outcome, Parameter, Quantity, Verdict
from divideropt.problem import Constraint, DesignSpace, Objective, Problem, Variable

_UNIT = Domain(0.0, 1.0)


class Toy:
    """Minimise f1 = x1 and f2 = (1 + x2)/(0.1 + x1), which conflict; x3 only adds to f2."""

    def __init__(self, failing_below=0.05):
        self.failing_below = failing_below
        self.parameters = {n: Parameter(n, "", n, "a number", 0.5, _UNIT) for n in ("x1", "x2", "x3")}
        self.quantities = {
            "f1": Quantity("f1", "", "f1", "first objective", 1.0),
            "f2": Quantity("f2", "", "f2", "second objective", 1.0, signed=True),
            "spare": Quantity("spare", "m", "s", "what is left", 1.0),
        }

    def evaluate(self, designs):
        x1, x2, x3 = designs.T
        f2 = -(1 + x2) * (1 + (x3 - 0.3) ** 2) / (0.1 + x1)
        quantities = np.column_stack([x1, f2, x1 - 0.1])
        failed = x2 < self.failing_below
        quantities[failed, 1] = np.nan
        text = "x2 is too small"
        return quantities, [Verdict(Outcome.UNSETTLED, text) if f else Verdict(Outcome.OK) for f in failed]


class CheckedToy(Toy):
    """A toy with a reference, from which its f2 is off by `error`, and by `slip` more where x1 is above 0.5."""

    def __init__(self, error=1e-4, slip=0.0, failing_from=2.0):
        super().__init__()
        self.error, self.slip, self.failing_from = error, slip, failing_from

    def reference(self):
        return ExactToy(self.error, self.slip, self.failing_from)


class ExactToy(Toy):
    """The reference; it finds designs with x1 from `failing_from` on unsettled."""

    def __init__(self, error, slip, failing_from):
        super().__init__()
        self.error, self.slip, self.failing_from = error, slip, failing_from

    def evaluate(self, designs):
        quantities, verdicts = super().evaluate(designs)
        x1 = designs[:, 0]
        quantities[:, 1] *= 1.0 + self.error + self.slip * (x1 > 0.5)
        failing = Verdict(Outcome.UNSETTLED, "x1 is too large")
        return quantities, [failing if x >= self.failing_from else v for x, v in zip(x1, verdicts, strict=True)]


class DeadlyReference(CheckedToy):
    """Its reference kills its process, unless the file is there."""

    def __init__(self, file):
        super().__init__()
        self.file = file

    def reference(self):
        return self if Path(self.file).exists() else Deadly()


class Deadly(Toy):
    def evaluate(self, designs):
        os.kill(os.getpid(), signal.SIGKILL)


class BrokenReference(Toy):
    """Its reference cannot be made."""

    def reference(self):
        raise RuntimeError("no licence")


class OtherReference(Toy):
    """Its reference is another model."""

    def reference(self):
        other = Toy()
        del other.quantities["spare"]
        return other


def toy_problem(model=None):
    """The toy as a problem with goals and a constraint."""
    model = model or Toy()
    q = model.quantities
    return Problem(
        model=model,
        fixed={name: p.default for name, p in model.parameters.items()},
        space=DesignSpace(tuple(Variable(p, 0.0, 1.0) for p in model.parameters.values())),
        objectives=(Objective(q["f1"], goal=0.2, weight=1.0), Objective(q["f2"], goal=2.0, weight=2.0)),
        constraints=(Constraint(q["spare"], minimum=0.0),),
    )
