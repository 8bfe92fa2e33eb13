"""Integrals, crossings and extremes of a response, compiled.

Integrals are Gauss–Lobatto sums over the solver's own steps, and crossings are located on the steps' polynomials:
nothing here depends on a grid of samples.
"""

import math

import numpy as np

from divideropt.models.divider.kernels import STATES, load_flows
from divideropt.ode.base import NODE_WEIGHTS, NODES, lagrange_weights
from divideropt.ode.compiled import compiled
from divideropt.ode.polynomial import coefficients, value_at

BISECTIONS = 60
"""Halvings of the distance between two nodes: to the last bit."""

SAMPLES = 33
"""Places on a step at which a largest value is sought between the nodes."""

OVERSHOOT = 0.5
"""By how much of its range at the nodes the polynomial through them can exceed it: their Lebesgue constant is 1.8."""

_FINE = lagrange_weights(np.linspace(0.0, 1.0, SAMPLES))
_X, _FIRST, _SECOND = STATES.index("x"), STATES.index("PL1"), STATES.index("PL2")
_PRESSURES = STATES.index("xdot")  # the first states


@compiled
def largest_pressure(course):  # type: ignore[no-untyped-def]
    """Return the largest of Ps, Pa, Pb over a response [Pa]; NaN where there is no trajectory."""
    best = math.nan
    for phase in range(course.spans.size):
        best = _larger(best, _largest(course, phase, 0, _PRESSURES, 1.0))
    return best


@compiled
def largest_travel(course):  # type: ignore[no-untyped-def]
    """Return the largest distance of the spool from the centre [m]; NaN where there is no trajectory."""
    best = math.nan
    for phase in range(course.spans.size):
        best = _larger(best, _largest(course, phase, _X, _X + 1, 1.0))
        best = _larger(best, _largest(course, phase, _X, _X + 1, -1.0))
    return best


@compiled
def fill_flows(course):  # type: ignore[no-untyped-def]
    """Fill the load flows at the nodes of every step [m^3/s]."""
    edges, values, flows = course.edges, course.values, course.flows
    for phase in range(course.spans.size):
        d = course.designs[phase]
        for i in range(course.first[phase], course.first[phase + 1]):
            width = edges[i + 1] - edges[i]
            for m in range(NODES.size):
                time = edges[i] + NODES[m] * width
                both = load_flows(time, values[i, _FIRST, m], values[i, _SECOND, m], d)
                flows[i, 0, m], flows[i, 1, m] = both


@compiled
def settled(course, begin, stay, final, band):  # type: ignore[no-untyped-def]
    """Find from when on QL1 stays within a band around a flow.

    Args:
        course: A `Course` whose flows are filled.
        begin: First of its phases to look at.
        stay: Last of them.
        final: The flow [m^3/s].
        band: The band's half width [m^3/s].

    Returns:
        The time [s]; NaN if it ends outside.
    """
    edges, flows, first = course.edges, course.flows, course.first
    last = NODES.size - 1
    for phase in range(stay, begin - 1, -1):
        for i in range(first[phase + 1] - 1, first[phase] - 1, -1):
            for m in range(last, -1, -1):
                if not abs(flows[i, 0, m] - final) > band:
                    continue
                if m == last:
                    return math.nan if i == first[stay + 1] - 1 else edges[i + 1]
                width = edges[i + 1] - edges[i]
                place = _entry(course.values[i], m, edges[i], width, course.designs[phase], final, band)
                return edges[i] + width * place
    return edges[first[begin]]


@compiled
def integrals(course, begin, stay, reference, until):  # type: ignore[no-untyped-def]
    """Integrate QL1 - QL2 less a reference, and its magnitude.

    Args:
        course: A `Course` whose flows are filled.
        begin: First of the phases, at whose beginning the integral begins.
        stay: Last of them.
        reference: What to take off [m^3/s].
        until: Upper limit [s], within the phases.

    Returns:
        The two integrals [m^3].
    """
    edges, flows = course.edges, course.flows
    signed, magnitude = 0.0, 0.0
    for phase in range(begin, stay + 1):
        for i in range(course.first[phase], course.first[phase + 1]):
            width = edges[i + 1] - edges[i]
            if edges[i] >= until:
                break
            end = min((until - edges[i]) / width, 1.0)
            low, high, total = math.inf, -math.inf, 0.0
            for m in range(NODES.size):
                error = flows[i, 0, m] - flows[i, 1, m] - reference
                low, high, total = min(low, error), max(high, error), total + error * NODE_WEIGHTS[m]
            if end == 1.0 and (low >= 0.0 or high <= 0.0):
                part, size = total, abs(total)
            else:
                part, size = _part(course.values[i], end, edges[i], width, course.designs[phase], reference)
            signed += part * width
            magnitude += size * width
    return signed, magnitude


@compiled
def _larger(best, value):  # type: ignore[no-untyped-def]
    """The larger of two; the other where one is NaN."""
    return best if math.isnan(value) or best >= value else value


@compiled
def _largest(course, phase, low, high, sign):  # type: ignore[no-untyped-def]
    """Largest value of some states over a phase, times a sign; sought again between the nodes beside the largest."""
    values, begin, after = course.values, course.first[phase], course.first[phase + 1]
    best, where = math.nan, begin
    for i in range(begin, after):
        for state in range(low, high):
            top, _ = _extremes(values, i, state, sign)
            if not best >= top:
                best, where = top, i
    for i in range(max(where - 1, begin), min(where + 2, after)):
        for state in range(low, high):
            top, bottom = _extremes(values, i, state, sign)
            if top + OVERSHOOT * (top - bottom) > best:
                best = max(best, _largest_sample(values, i, state, sign))
    return best


@compiled
def _extremes(values, i, state, sign):  # type: ignore[no-untyped-def]
    """Largest and smallest value of a state at the nodes of a step, times a sign."""
    top = bottom = sign * values[i, state, 0]
    for m in range(1, NODES.size):
        value = sign * values[i, state, m]
        top, bottom = max(top, value), min(bottom, value)
    return top, bottom


@compiled
def _largest_sample(values, i, state, sign):  # type: ignore[no-untyped-def]
    """Largest of many samples of a state on a step, times a sign."""
    best = -math.inf
    for k in range(SAMPLES):
        value = 0.0
        for m in range(NODES.size):
            value += _FINE[k, m] * values[i, state, m]
        best = max(best, sign * value)
    return best


@compiled
def _entry(nodes, m, begin, width, d, final, band):  # type: ignore[no-untyped-def]
    """Place on a step, between two of its nodes, at which QL1 enters a band around a flow."""
    c = _pressures(nodes)
    low, high = NODES[m], NODES[m + 1]
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if abs(_flows_at(c, middle, begin, width, d)[0] - final) > band:
            low = middle
        else:
            high = middle
    return high


@compiled
def _part(nodes, end, begin, width, d, reference):  # type: ignore[no-untyped-def]
    """Integrate the error and its magnitude over [0, end] of a step, piece by piece between its zeros."""
    c = _pressures(nodes)
    signed, magnitude, cut = 0.0, 0.0, 0.0
    place, here = 0.0, _error_at(c, 0.0, begin, width, d, reference)
    for m in range(1, NODES.size):
        after = NODES[m] * end
        there = _error_at(c, after, begin, width, d, reference)
        if here * there < 0.0:
            low, high = place, after
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                if _error_at(c, middle, begin, width, d, reference) * here > 0.0:
                    low = middle
                else:
                    high = middle
            piece = _piece(c, cut, high, begin, width, d, reference)
            signed, magnitude, cut = signed + piece, magnitude + abs(piece), high
        place, here = after, there
    piece = _piece(c, cut, end, begin, width, d, reference)
    return signed + piece, magnitude + abs(piece)


@compiled
def _piece(c, left, right, begin, width, d, reference):  # type: ignore[no-untyped-def]
    """Integrate the error over a part of a step, in shares of its width."""
    total = 0.0
    for m in range(NODES.size):
        total += NODE_WEIGHTS[m] * _error_at(c, left + (right - left) * NODES[m], begin, width, d, reference)
    return total * (right - left)


@compiled
def _pressures(nodes):  # type: ignore[no-untyped-def]
    """Coefficients of the polynomials of PL1 and PL2 on a step, shape (2, NODES_PER_STEP)."""
    c = np.empty((2, NODES.size))
    coefficients(nodes[_FIRST], c[0])
    coefficients(nodes[_SECOND], c[1])
    return c


@compiled
def _error_at(c, theta, begin, width, d, reference):  # type: ignore[no-untyped-def]
    flows = _flows_at(c, theta, begin, width, d)
    return flows[0] - flows[1] - reference


@compiled
def _flows_at(c, theta, begin, width, d):  # type: ignore[no-untyped-def]
    """Load flows at a place on a step, from the pressures' polynomials there."""
    return load_flows(begin + theta * width, value_at(theta, c[0]), value_at(theta, c[1]), d)
