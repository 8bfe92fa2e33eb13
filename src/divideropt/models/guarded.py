"""A batch through a model that may break down: only the design on which it does is blamed."""

from collections.abc import Sequence

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
        The quantities, shape (n, m), and a verdict a design. A design on which the model raises an exception, or for
        which it gives anything else than these, is `crashed`, its quantities NaN. A quantity of a magnitude that is
        not computed with comes as infinite if it is too large, as 0 if it is too small.
    """
    try:
        with np.errstate(all="ignore"):  # a failed design says so by its outcome
            answer = model.evaluate(designs)
        quantities, verdicts = _checked(answer, (len(designs), len(model.quantities)))
    except (Exception, SystemExit) as error:  # a model may be anybody's
        if len(designs) == 1:
            text = f"the model broke down: {words_of(error)}"
            return np.full((1, len(model.quantities)), np.nan), [Verdict(Outcome.CRASHED, text)]
        parts = [evaluate_guarded(model, row[None]) for row in designs]
        return np.concatenate([q for q, _ in parts]), [v for _, verdicts in parts for v in verdicts]
    return _computable(quantities), verdicts


def _checked(answer: tuple[FloatArray, Sequence[Verdict]], due: tuple[int, int]) -> tuple[FloatArray, list[Verdict]]:
    """Copy what a model answered; raises TypeError or ValueError with a sentence where it is not what is due."""
    quantities, verdicts = np.array(answer[0], dtype=np.float64), list(answer[1])
    if quantities.shape != due or len(verdicts) != due[0]:
        raise ValueError(
            f"`evaluate` gives quantities of shape {quantities.shape} and {len(verdicts)} verdicts, where {due} and "
            f"{due[0]} are due"
        )
    for verdict in verdicts:
        if not isinstance(verdict, Verdict) or not isinstance(verdict.outcome, Outcome):
            raise TypeError(f"`evaluate` gives {verdict!r}, where a Verdict with an Outcome is due")
    return quantities, verdicts


def _computable(quantities: FloatArray) -> FloatArray:
    """Replace, in place, what is too large or too small."""
    size = np.abs(quantities)
    too_large = size > LARGEST
    if too_large.any():
        quantities[too_large] = np.copysign(np.inf, quantities[too_large])
    quantities[(size > 0.0) & (size < LEAST)] = 0.0
    return quantities
