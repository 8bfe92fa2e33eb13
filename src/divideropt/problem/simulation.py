"""Designs in, results out, whatever the model does: the one place that calls `Model.evaluate`."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib import import_module

import numpy as np
from threadpoolctl import ThreadpoolController

from divideropt.models.base import FloatArray, Model, Verdict
from divideropt.models.guarded import evaluate_guarded


def simulate(
    model: Model, fixed: Mapping[str, float], names: Sequence[str], designs: FloatArray
) -> tuple[FloatArray, list[Verdict]]:
    """Simulate designs that give some of a model's parameters.

    Args:
        model: By what.
        fixed: Every parameter by name, in the model's units.
        names: The parameters that the designs give instead.
        designs: One row a design, one column a name, shape (n, len(names)).

    Returns:
        The quantities, shape (n, m), and a verdict a design. A design on which the model raises an exception is
        `crashed`, its quantities NaN; the others are not touched by it. The linear algebra runs on one thread: with
        another number of them its last bits would be others, and a run could not be repeated with other workers.
    """
    parameters = list(model.parameters)
    full = np.empty((len(designs), len(parameters)))
    full[:] = [fixed[name] for name in parameters]
    full[:, [parameters.index(name) for name in names]] = designs
    with one_thread():
        return evaluate_guarded(model, full)


@contextmanager
def one_thread() -> Iterator[None]:
    """Run the linear algebra on one thread until this is left; inside another of these, do nothing.

    To set the number of threads takes longer than to simulate a design, so whoever simulates many enters once.
    """
    if _entered:
        yield
        return
    with _linear_algebra().limit(limits=1, user_api="blas"):
        _entered.append(True)
        try:
            yield
        finally:
            _entered.clear()


_entered: list[bool] = []
"""Holds something while the linear algebra runs on one thread."""


@cache
def _linear_algebra() -> ThreadpoolController:
    """Find the libraries, once: it takes milliseconds. SciPy has one of its own, not there before its first use."""
    import_module("scipy.linalg")
    return ThreadpoolController()
