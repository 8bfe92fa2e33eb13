"""A batch through a model that may break down: only the design on which it does is blamed."""

import numpy as np

from divideropt.errors import words_of
from divideropt.models.base import FloatArray, Model, Outcome, Verdict
from divideropt.units import LARGEST, LEAST


def evaluate_guarded(model: Model, designs: FloatArray) -> tuple[FloatArray, list[Verdict]]:
    """Evaluate a batch; where that raises, one design at a time, so that only the guilty one is blamed.

    Args:
        model: By what.
        designs: Shape (n, d), columns as in the model's `parameters`.

    Returns:
        The quantities, shape (n, m), and a verdict a design. A design on which the model raises an exception is
        `crashed`, its quantities NaN. A quantity of a magnitude that is not computed with comes as infinite if it is
        too large, as 0 if it is too small.
    """
    try:
        with np.errstate(all="ignore"):  # a failed design says so by its outcome
            quantities, verdicts = model.evaluate(designs)
    except (Exception, SystemExit) as error:  # a model may be anybody's
        if len(designs) == 1:
            text = f"the model broke down: {words_of(error)}"
            return np.full((1, len(model.quantities)), np.nan), [Verdict(Outcome.CRASHED, text)]
        parts = [evaluate_guarded(model, row[None]) for row in designs]
        return np.concatenate([q for q, _ in parts]), [v for _, verdicts in parts for v in verdicts]
    return _computable(np.array(quantities, dtype=np.float64)), list(verdicts)


def _computable(quantities: FloatArray) -> FloatArray:
    """Replace, in place, what is too large or too small."""
    size = np.abs(quantities)
    too_large = size > LARGEST
    if too_large.any():
        quantities[too_large] = np.copysign(np.inf, quantities[too_large])
    quantities[(size > 0.0) & (size < LEAST)] = 0.0
    return quantities
