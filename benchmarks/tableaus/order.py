"""The orders of a method, seen on a problem with a known solution."""

import math
from types import ModuleType

import numpy as np

from divideropt.models.base import FloatArray

SPAN, COARSE, FINE = 1.0, 16, 32
"""How far [-], in how many steps."""

MIDDLES = (0.25, 0.5, 0.75)
"""Where in the steps the interpolation is looked at."""


def orders(tableau: ModuleType) -> tuple[float, float, float]:
    """Return the orders of the steps, of the error estimate and of the interpolation.

    The problem is nonlinear and driven, so that all coefficients matter: y1 = exp(sin t), y2 = 1/(1+t).
    """
    coarse, fine = (_errors(tableau, steps) for steps in (COARSE, FINE))
    gains = np.log(np.array(coarse) / np.array(fine)) / math.log(FINE / COARSE)
    return float(gains[0]), float(gains[1]) - 1.0, float(gains[2])


def _errors(tableau: ModuleType, steps: int) -> tuple[float, float, float]:
    """Return the error at the end, the mean estimate of a step and the largest error between the steps."""
    h, y = SPAN / steps, _solution(0.0)
    between, estimates = 0.0, 0.0
    for i in range(steps):
        t = i * h
        start, increments = y, _increments(tableau, t, y, h)
        y = start + tableau.A[-1] @ increments + increments[-1]
        estimates += float(np.abs(increments[-1]).max())
        k = tableau.H @ increments
        for place in MIDDLES:
            inner = y + (1.0 - place) * (k[0] + place * (k[1] + place * k[2]))
            value = (1.0 - place) * start + place * inner
            between = max(between, float(np.abs(value - _solution(t + place * h)).max()))
    return float(np.abs(y - _solution(SPAN)).max()), estimates / steps, between


def _increments(tableau: ModuleType, t: float, y: FloatArray, h: float) -> FloatArray:
    """Return the increments of a step, shape (stages, 2)."""
    jacobian, slope = _derivatives(t, y)
    matrix = np.eye(len(y)) / (tableau.GAMMA * h) - jacobian
    increments = np.zeros((tableau.STAGES, len(y)))
    for i in range(tableau.STAGES):
        rates = _rates(t + tableau.PLACES[i] * h, y + tableau.A[i] @ increments)
        right_side = rates + tableau.C[i] @ increments / h + h * tableau.SLOPES[i] * slope
        increments[i] = np.linalg.solve(matrix, right_side)
    return increments


def _solution(t: float) -> FloatArray:
    return np.array([math.exp(math.sin(t)), 1.0 / (1.0 + t)])


def _rates(t: float, y: FloatArray) -> FloatArray:
    return np.array([y[0] * (math.cos(t) + y[1] * (1.0 + t) - 1.0), -y[1] * y[1] * y[0] / math.exp(math.sin(t))])


def _derivatives(t: float, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the rates' derivatives by y and by t."""
    share = math.exp(-math.sin(t))
    by_state = [
        [math.cos(t) + y[1] * (1.0 + t) - 1.0, y[0] * (1.0 + t)],
        [-y[1] * y[1] * share, -2.0 * y[1] * y[0] * share],
    ]
    by_time = [y[0] * (y[1] - math.sin(t)), y[1] * y[1] * y[0] * share * math.cos(t)]
    return np.array(by_state), np.array(by_time)
