"""Known Pareto fronts, where pymoo has none in itself, and exact hypervolumes, where points are too few for one."""

from math import pi

import moocore
import numpy as np

from divideropt.models.base import FloatArray

from .welded_beam import front

DENSE = 20_001
"""Points on a front that is a curve: their hypervolume is then the curve's to some 1e-5."""

CORNER = 1.1
"""The reference point of the hypervolume, in each objective between the front's ideal (0) and nadir (1)."""


def osy() -> FloatArray:
    """Osyczka and Kundu's front, its five pieces after Deb (2001), section 8.3.3; shape (n, 2)."""
    t = np.linspace(0.0, 1.0, DENSE // 5)
    one, none = np.ones_like(t), np.zeros_like(t)
    long = 1.0 + 4.0 * t
    along = 4.056 + 0.944 * t
    pieces = [
        (5.0 * one, one, long, none, 5.0 * one, none),
        (5.0 * one, one, long, none, one, none),
        (along, (along - 2.0) / 3.0, one, none, one, none),
        (none, 2.0 * one, 1.0 + 2.732 * t, none, one, none),
        (t, 2.0 - t, one, none, one, none),
    ]
    x = np.concatenate([np.column_stack(piece) for piece in pieces])
    offset = np.array([2.0, 2.0, 1.0, 4.0, 1.0])
    f1 = -((x[:, :5] - offset) ** 2 @ np.array([25.0, 1.0, 1.0, 1.0, 1.0]))
    return _front(np.column_stack([f1, (x**2).sum(axis=1)]))


def tnk() -> FloatArray:
    """Tanaka's front: what is not dominated of its first constraint's boundary within the second; shape (n, 2)."""
    angle = np.linspace(0.0, pi / 2, 10 * DENSE)[1:-1]
    radius = np.sqrt(1.0 + 0.1 * np.cos(16.0 * angle))
    x = np.column_stack([radius * np.sin(angle), radius * np.cos(angle)])
    return _front(x[((x - 0.5) ** 2).sum(axis=1) <= 0.5])


def truss() -> FloatArray:
    """The two-bar truss's front, of volume and stress, after pymoo's `Truss2D`; shape (n, 2).

    The nodes' distance y is 2 on its first part, where volume times stress is 400; on its second one bar has the
    greatest area and y grows to 3.
    """
    light = np.geomspace(0.004, 0.02 * np.sqrt(5.0), DENSE)
    y = np.linspace(2.0, 3.0, DENSE)[1:]
    volume = 0.0025 * (16.0 + y**2) / np.sqrt(1.0 + y**2) + 0.01 * np.sqrt(1.0 + y**2)
    stress = 8000.0 * np.sqrt(1.0 + y**2) / y
    return np.column_stack([np.concatenate([light, volume]), np.concatenate([400.0 / light, stress])])


def welded_beam() -> FloatArray:
    """The welded beam's front, of cost and deflection, between the points of `welded_beam.front`; shape (n, 2)."""
    places = np.log(front())
    cost = np.linspace(places[0, 0], places[-1, 0], DENSE)
    return np.asarray(np.exp(np.column_stack([cost, np.interp(cost, places[:, 0], places[:, 1])])))


def dtlz7() -> FloatArray:
    """Its front in three objectives, four patches, from a grid; shape (n, 3)."""
    f = np.linspace(0.0, 1.0, 201)
    f1, f2 = (a.ravel() for a in np.meshgrid(f, f))
    return _front(np.column_stack([f1, f2, 6.0 - _dtlz7_term(f1) - _dtlz7_term(f2)]))


def dtlz1_volume() -> float:
    """The hypervolume above the plane Σ f = 1, objectives over the nadir's."""
    return CORNER**3 - 1.0 / 6.0


def dtlz2_volume() -> float:
    """The hypervolume above the octant of a sphere, objectives over the nadir's."""
    return CORNER**3 - pi / 6.0


def dtlz7_volume(ideal: FloatArray, span: FloatArray) -> float:
    """The hypervolume of DTLZ7's front, between its ideal and nadir.

    Its last objective is 6 - s(f1) - s(f2), so that the dominated height over (f1, f2) is the reference's less 6, and
    the running maxima of s at f1 and at f2: two integrals of one variable.
    """
    ends = ideal + CORNER * span
    sides, integrals = [], []
    for low, end in zip(ideal[:2], ends[:2], strict=True):
        f = np.linspace(low, end, 1_000_001)
        reached = np.maximum.accumulate(np.where(f <= 1.0, _dtlz7_term(f), 0.0))
        sides.append(end - low)
        integrals.append(np.trapezoid(reached, f))
    volume = sides[0] * sides[1] * (ends[2] - 6.0) + sides[1] * integrals[0] + sides[0] * integrals[1]
    return float(volume / span.prod())


def _dtlz7_term(f: FloatArray) -> FloatArray:
    return np.asarray(f * (1.0 + np.sin(3.0 * pi * f)))


def _front(F: FloatArray) -> FloatArray:
    return np.asarray(F[moocore.is_nondominated(F)])
