"""Integrals, crossings and extremes of a response, compiled.

Integrals are Gauss–Lobatto sums over the solver's own steps, and crossings are located on the steps' polynomials:
nothing here depends on a grid of samples.
"""

import math

import numpy as np

from divideropt.models.divider.kernels import load_flows
from divideropt.models.divider.states import STATES
from divideropt.ode.base import NODE_WEIGHTS, NODES, lagrange_weights
from divideropt.ode.compiled import compiled
from divideropt.ode.polynomial import coefficients, value_at

ITERATIONS = 60
"""Budget for a crossing; eight are usual."""

RESOLUTION = 1e-15
"""Of a crossing, in shares of the step."""

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
    outside = _value_at(c, NODES[m], 0.0, final, begin, width, d)
    edge = final + math.copysign(band, outside)
    return _crossing(c, NODES[m], NODES[m + 1], 0.0, edge, begin, width, d)


@compiled
def _part(nodes, end, begin, width, d, reference):  # type: ignore[no-untyped-def]
    """Integrate QL1 - QL2 less a reference, and its magnitude, over [0, end] of a step, between its zeros."""
    c = _pressures(nodes)
    signed, magnitude, cut = 0.0, 0.0, 0.0
    place, here = 0.0, _value_at(c, 0.0, 1.0, reference, begin, width, d)
    for m in range(1, NODES.size):
        after = NODES[m] * end
        there = _value_at(c, after, 1.0, reference, begin, width, d)
        if here * there < 0.0:
            zero = _crossing(c, place, after, 1.0, reference, begin, width, d)
            piece = _piece(c, cut, zero, begin, width, d, reference)
            signed, magnitude, cut = signed + piece, magnitude + abs(piece), zero
        place, here = after, there
    piece = _piece(c, cut, end, begin, width, d, reference)
    return signed + piece, magnitude + abs(piece)


@compiled
def _piece(c, left, right, begin, width, d, reference):  # type: ignore[no-untyped-def]
    """Integrate QL1 - QL2 less a reference over a part of a step, in shares of its width."""
    total = 0.0
    for m in range(NODES.size):
        total += NODE_WEIGHTS[m] * _value_at(c, left + (right - left) * NODES[m], 1.0, reference, begin, width, d)
    return total * (right - left)


@compiled
def _crossing(c, left, right, share, reference, begin, width, d):  # type: ignore[no-untyped-def]
    """Find where `_value_at` changes its sign between two places: false position, by Illinois.

    Dowell and Jarratt, "A modified regula falsi method for computing the root of an equation", BIT 11 (1971).
    """
    low = _value_at(c, left, share, reference, begin, width, d)
    high = _value_at(c, right, share, reference, begin, width, d)
    place, kept = right, 0
    for _ in range(ITERATIONS):
        before, place = place, left + (right - left) * (low / (low - high))
        if not abs(place - before) > RESOLUTION:
            break
        value = _value_at(c, place, share, reference, begin, width, d)
        if value * high > 0.0:
            right, high = place, value
            low *= 0.5 if kept == -1 else 1.0
            kept = -1
        else:
            left, low = place, value
            high *= 0.5 if kept == 1 else 1.0
            kept = 1
    return place


@compiled
def _pressures(nodes):  # type: ignore[no-untyped-def]
    """Coefficients of the polynomials of PL1 and PL2 on a step, shape (2, NODES_PER_STEP)."""
    c = np.empty((2, NODES.size))
    coefficients(nodes[_FIRST], c[0])
    coefficients(nodes[_SECOND], c[1])
    return c


@compiled
def _value_at(c, theta, share, reference, begin, width, d):  # type: ignore[no-untyped-def]
    """QL1, less a share of QL2, less a reference, at a place on a step, from the pressures' polynomials there."""
    flows = load_flows(begin + theta * width, value_at(theta, c[0]), value_at(theta, c[1]), d)
    return flows[0] - share * flows[1] - reference
