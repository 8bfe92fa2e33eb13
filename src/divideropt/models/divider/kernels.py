"""The equations of motion (2.8)–(2.19), (3.1)–(3.4), compiled: rates and their Jacobian in one pass.

States, in order: Ps, Pa1, Pa2, Pb1, Pb2, ẋ, x, PL1, PL2 [Pa, m/s, m]. Everything a design fixes comes in one
record of `COEFFICIENTS`; the pilot stage is in it as two 3×3 matrices, folded once unless the spool is turned. The
record's options choose between the formulations; no equation stands twice.
"""

import math

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.groove_kernels import fold_pilot, groove_excess
from divideropt.models.divider.states import FRICTION_VELOCITY, N_STATES
from divideropt.ode.compiled import compiled

ROOT_BLEND = 100.0
"""Below this drop [Pa] the smooth root is a cubic: far below any drop that matters, far above rounding."""

TANH_DROP = 1e4
"""p_tan of (2.9) [Pa]."""

STEEPEST = 1.0
"""The signed root's infinite slope at 0 is replaced in the Jacobian, not in the rates, by that at this drop [Pa]."""

STOP_STIFFNESS = 1e8
"""End stop [N/m]: the largest end force, some 2 kN, presses the spool 20 µm into it."""

STOP_DAMPING = 5e3
"""End stop [N s/m]: about critical for the stiffness and the mass of a spool, so that it does not chatter."""

STOP_ONSET = 1e-7
"""Depth [m] over which the damping sets in, so that the force is continuous at the touch."""

_STRETCHES = np.array([[0, 3], [3, 1], [0, 4], [4, 2]])
"""The balances between which the stretches of the grooves lie."""

SMALLEST_VOLUME = 1e-15
"""What C.3 puts for an end chamber that has vanished [m^3]."""


@compiled
def rates(t, y, design):  # type: ignore[no-untyped-def]
    """Return dy/dt.

    Args:
        t: Time [s]; it matters only where the inputs move.
        y: State, shape (9,).
        design: `COEFFICIENTS`, shape (1,); a call with a bare record costs numba four times as much.

    Returns:
        Rates, shape (9,).
    """
    out = np.empty(N_STATES)
    motion(t, y, design[0], out, None)
    return out


@compiled
def jacobian(t, y, design):  # type: ignore[no-untyped-def]
    """Return the matrix of derivatives of the rates by the states, shape (9, 9); arguments as in `rates`."""
    out = np.empty(N_STATES)
    jac = np.zeros((N_STATES, N_STATES))
    motion(t, y, design[0], out, jac)
    return jac


@compiled
def motion(t, y, d, out, jac):  # type: ignore[no-untyped-def]
    """Fill rates and Jacobian.

    Args:
        t: Time [s].
        y: State, shape (9,).
        d: A record of `COEFFICIENTS`.
        out: Receives the rates, shape (9,).
        jac: Receives the Jacobian, shape (9, 9), where it can hold something else than zero, as `pattern.py` has
            it; or None, for which another function is compiled that does without the slopes.
    """
    Ps, Ps_ = _floored(y[0], d.pressure_floor)
    Pa1, Pa1_ = _floored(y[1], d.pressure_floor)
    Pa2, Pa2_ = _floored(y[2], d.pressure_floor)
    Pb1, Pb1_ = _floored(y[3], d.pressure_floor)
    Pb2, Pb2_ = _floored(y[4], d.pressure_floor)
    PL1, PL1_ = _floored(y[7], d.pressure_floor)
    PL2, PL2_ = _floored(y[8], d.pressure_floor)
    xdot, x, x_ = y[5], y[6], 1.0
    if d.stop == 1 and abs(x) > d.stop_position:  # C.3 freezes the spool
        x, x_ = math.copysign(d.stop_position, x), 0.0
        xdot = 0.0

    # Inputs: as they stand, or on their way.
    source_flow, load_1, load_2, position = d.source_flow, d.load_1, d.load_2, d.spool_position
    p1, p2 = d.pilot_1, d.pilot_2
    if d.moving != 0:
        since = t - d.begin
        source_flow += d.source_flow_rate * since
        load_1, load_2 = load_coefficients(since, d)
        position += d.spool_position_rate * since
        if d.spool_position_rate != 0.0:
            fold_pilot(position, d)

    # Ports: area and chord of each, with their slopes by x.
    reach_1 = x
    inside = True
    if d.port_range == 1:
        low, high = d.port_offset - d.port_radius, d.port_offset + d.port_radius
        inside = low <= x <= high
        reach_1 = min(max(x, low), high)
    moves = x_ if reach_1 == x else 0.0
    Av1, Av1_e, w1, w1_e = _port(d.port_offset - reach_1, d)
    Av2, Av2_e, w2, w2_e = _port(d.port_offset + reach_1, d)
    Av1_x, w1_x, Av2_x, w2_x = -Av1_e * moves, -w1_e * moves, Av2_e * moves, w2_e * moves
    if not inside:
        w1, w2, w1_x, w2_x = 0.0, 0.0, 0.0, 0.0

    # Flows through the orifices; each with its slope by the drop.
    f, f_ = _root(Ps - Pa1, d.orifice_law)
    Qs1, Qs1_ = d.fixed_1 * f, d.fixed_1 * f_
    f, f_ = _root(Ps - Pa2, d.orifice_law)
    Qs2, Qs2_ = d.fixed_2 * f, d.fixed_2 * f_
    root_1, root_1_ = _root(Pa1 - PL1, d.orifice_law)
    QL1, QL1_, QL1_x = d.variable * Av1 * root_1, d.variable * Av1 * root_1_, d.variable * Av1_x * root_1
    root_2, root_2_ = _root(Pa2 - PL2, d.orifice_law)
    QL2, QL2_, QL2_x = d.variable * Av2 * root_2, d.variable * Av2 * root_2_, d.variable * Av2_x * root_2
    f, f_ = _root(PL1, d.orifice_law)
    QLo1, QLo1_ = load_1 * f, load_1 * f_
    f, f_ = _root(PL2, d.orifice_law)
    QLo2, QLo2_ = load_2 * f, load_2 * f_

    # What the pilot stage adds to supply, flow chambers and end chambers.
    supply_1, chamber_1, end_1 = _pilot_flows(p1, Ps, Pa1, Pb1)
    supply_2, chamber_2, end_2 = _pilot_flows(p2, Ps, Pa2, Pb2)

    # Source and flow chambers, (2.8), (2.11), (2.12); end chambers, (2.38)–(2.41), whose seals leak to tank; load
    # lines, (3.1), (3.2).
    swept = xdot * d.end_area
    Vb1 = max(d.end_volume + d.end_area * x, SMALLEST_VOLUME)
    Vb2 = max(d.end_volume - d.end_area * x, SMALLEST_VOLUME)
    source, chamber, load = d.source_gain, d.chamber_gain, d.load_gain
    end_gain_1, end_gain_2 = d.bulk_modulus / Vb1, d.bulk_modulus / Vb2
    out[0] = source * (source_flow - Qs1 - Qs2 + supply_1 + supply_2)
    out[1] = chamber * (Qs1 - QL1 + chamber_1)
    out[2] = chamber * (Qs2 - QL2 + chamber_2)
    out[3] = end_gain_1 * (end_1 - swept - d.seal_leakage * Pb1)
    out[4] = end_gain_2 * (end_2 + swept - d.seal_leakage * Pb2)
    out[7] = load * (QL1 - QLo1)
    out[8] = load * (QL2 - QLo2)

    # The spool, (2.17), with C.3's transient flow force, both jets braking.
    drag_Pa1_, drag_Pa2_, drag_PL1_, drag_PL2_ = Pa1_, Pa2_, PL1_, PL2_
    ends_1_, ends_2_, jets = Pb1_, Pb2_, (Pa1_, Pa2_, PL1_, PL2_)
    P1, P2, E1, E2, L1, L2 = Pa1, Pa2, Pb1, Pb2, PL1, PL2
    if d.pressure_floor == 0:  # forces see the pressures as they are
        P1, P2, E1, E2, L1, L2 = y[1], y[2], y[3], y[4], y[7], y[8]
        ends_1_, ends_2_, jets = 1.0, 1.0, (1.0, 1.0, 1.0, 1.0)
    rim = d.rim_thickness / 2.0
    drag = d.transient * (w1 * root_1 + w2 * root_2)
    friction, friction_v = _coulomb_friction(xdot, d)
    stop, stop_x, stop_v = _stop_force(x, xdot, d)
    m = d.mass
    out[5] = (
        (E1 - E2) * d.end_area
        + rim * w1 * (L1 - P1)
        - rim * w2 * (L2 - P2)
        - (d.viscous_friction + drag) * xdot
        - friction
        + d.extra_force
        + stop
    ) / m
    out[6] = xdot

    if jac is not None:
        jac[0, 0] = source * (-Qs1_ - Qs2_ + p1[0, 0] + p2[0, 0]) * Ps_
        jac[0, 1] = source * (Qs1_ + p1[0, 1]) * Pa1_
        jac[0, 2] = source * (Qs2_ + p2[0, 1]) * Pa2_
        jac[0, 3] = source * p1[0, 2] * Pb1_
        jac[0, 4] = source * p2[0, 2] * Pb2_

        jac[1, 0] = chamber * (Qs1_ + p1[1, 0]) * Ps_
        jac[1, 1] = chamber * (-Qs1_ - QL1_ + p1[1, 1]) * Pa1_
        jac[1, 3] = chamber * p1[1, 2] * Pb1_
        jac[1, 6] = -chamber * QL1_x
        jac[1, 7] = chamber * QL1_ * PL1_
        jac[2, 0] = chamber * (Qs2_ + p2[1, 0]) * Ps_
        jac[2, 2] = chamber * (-Qs2_ - QL2_ + p2[1, 1]) * Pa2_
        jac[2, 4] = chamber * p2[1, 2] * Pb2_
        jac[2, 6] = -chamber * QL2_x
        jac[2, 8] = chamber * QL2_ * PL2_

        jac[3, 0] = end_gain_1 * p1[2, 0] * Ps_
        jac[3, 1] = end_gain_1 * p1[2, 1] * Pa1_
        jac[3, 3] = end_gain_1 * (p1[2, 2] - d.seal_leakage) * Pb1_
        jac[3, 5] = -end_gain_1 * d.end_area * x_
        jac[3, 6] = -out[3] * d.end_area / Vb1 * x_
        jac[4, 0] = end_gain_2 * p2[2, 0] * Ps_
        jac[4, 2] = end_gain_2 * p2[2, 1] * Pa2_
        jac[4, 4] = end_gain_2 * (p2[2, 2] - d.seal_leakage) * Pb2_
        jac[4, 5] = end_gain_2 * d.end_area * x_
        jac[4, 6] = out[4] * d.end_area / Vb2 * x_

        jac[7, 1] = load * QL1_ * Pa1_
        jac[7, 6] = load * QL1_x
        jac[7, 7] = load * (-QL1_ - QLo1_) * PL1_
        jac[8, 2] = load * QL2_ * Pa2_
        jac[8, 6] = load * QL2_x
        jac[8, 8] = load * (-QL2_ - QLo2_) * PL2_

        jac[5, 1] = (-rim * w1 * jets[0] - d.transient * w1 * root_1_ * xdot * drag_Pa1_) / m
        jac[5, 2] = (rim * w2 * jets[1] - d.transient * w2 * root_2_ * xdot * drag_Pa2_) / m
        jac[5, 3] = d.end_area / m * ends_1_
        jac[5, 4] = -d.end_area / m * ends_2_
        jac[5, 5] = (-d.viscous_friction - drag - friction_v + stop_v) / m * x_
        brake_x = d.transient * (w1_x * root_1 + w2_x * root_2) * xdot
        jac[5, 6] = (rim * w1_x * (L1 - P1) - rim * w2_x * (L2 - P2) - brake_x + stop_x) / m
        jac[5, 7] = (rim * w1 * jets[2] + d.transient * w1 * root_1_ * xdot * drag_PL1_) / m
        jac[5, 8] = (-rim * w2 * jets[3] + d.transient * w2 * root_2_ * xdot * drag_PL2_) / m
        jac[6, 5] = x_

    # What a groove's entrance and exit take off the flows through it.
    if d.entrance_loss > 0.0:
        near, far = position * d.groove_angle, (1.0 - position) * d.groove_angle
        bypass_0, bypass_a = d.pilot_bypass * source, d.pilot_bypass * chamber
        fades_1, fades_2 = d.end_area / Vb1 * x_, -d.end_area / Vb2 * x_
        e, e_ = groove_excess(Ps - Pb1, near, d.entrance_loss, d)
        _carry(e, e_, _STRETCHES[0], (Ps_, Pb1_), (bypass_0, end_gain_1), (0.0, fades_1), out, jac)
        e, e_ = groove_excess(Pb1 - Pa1, far, d.exit_loss, d)
        _carry(e, e_, _STRETCHES[1], (Pb1_, Pa1_), (end_gain_1, bypass_a), (fades_1, 0.0), out, jac)
        e, e_ = groove_excess(Ps - Pb2, far, d.entrance_loss, d)
        _carry(e, e_, _STRETCHES[2], (Ps_, Pb2_), (bypass_0, end_gain_2), (0.0, fades_2), out, jac)
        e, e_ = groove_excess(Pb2 - Pa2, near, d.exit_loss, d)
        _carry(e, e_, _STRETCHES[3], (Pb2_, Pa2_), (end_gain_2, bypass_a), (fades_2, 0.0), out, jac)


@compiled
def flows_of(states, times, design):  # type: ignore[no-untyped-def]
    """Return the load flows of many states, shape (n, 2).

    Args:
        states: Shape (n, 9).
        times: When, shape (n,).
        design: `COEFFICIENTS`, shape (1,).
    """
    flows = np.empty((times.size, 2))
    for i in range(times.size):
        flows[i, 0], flows[i, 1] = load_flows(times[i], states[i, 7], states[i, 8], design[0])
    return flows


@compiled
def load_coefficients(since, d):  # type: ignore[no-untyped-def]
    """Return CdL AL √(2/ρ) of both loads, `since` seconds after their pressures began to move."""
    first = d.load_flow / math.sqrt(d.load_pressure_1 + d.load_pressure_1_rate * since)
    second = d.load_flow / math.sqrt(d.load_pressure_2 + d.load_pressure_2_rate * since)
    return first, second


@compiled
def _pilot_flows(p, Ps, Pa, Pb):  # type: ignore[no-untyped-def]
    """Return what the folded pilot stage of one side adds to supply, flow chamber and end chamber."""
    return (
        p[0, 0] * Ps + p[0, 1] * Pa + p[0, 2] * Pb,
        p[1, 0] * Ps + p[1, 1] * Pa + p[1, 2] * Pb,
        p[2, 0] * Ps + p[2, 1] * Pa + p[2, 2] * Pb,
    )


@compiled
def _carry(e, e_, balances, slopes, gains, fades, out, jac):  # type: ignore[no-untyped-def]
    """Take a flow and its slope in both grooves from one balance to another; a gain fades as its volume grows."""
    here, there = balances[0], balances[1]
    out[here] -= 2.0 * gains[0] * e
    out[there] += 2.0 * gains[1] * e
    if jac is not None:
        jac[here, here] -= 2.0 * gains[0] * e_ * slopes[0]
        jac[here, there] += 2.0 * gains[0] * e_ * slopes[1]
        jac[there, here] += 2.0 * gains[1] * e_ * slopes[0]
        jac[there, there] -= 2.0 * gains[1] * e_ * slopes[1]
        if fades[0] != 0.0:
            jac[here, 6] += 2.0 * gains[0] * e * fades[0]
        if fades[1] != 0.0:
            jac[there, 6] -= 2.0 * gains[1] * e * fades[1]


@compiled
def load_flows(t, first, second, d):  # type: ignore[no-untyped-def]
    """Return QL1 and QL2 [m^3/s] through the load orifices, (3.3), (3.4).

    Args:
        t: Time [s]; it matters only where the inputs move.
        first: PL1 [Pa].
        second: PL2 [Pa].
        d: A record of `COEFFICIENTS`.
    """
    load_1, load_2 = d.load_1, d.load_2
    if d.moving != 0:
        load_1, load_2 = load_coefficients(t - d.begin, d)
    return load_1 * _root(max(first, 0.0), d.orifice_law)[0], load_2 * _root(max(second, 0.0), d.orifice_law)[0]


@compiled
def signed_root(drops, law):  # type: ignore[no-untyped-def]
    """Return the signed square root of pressure drops [Pa] as the orifices have it, shape (n,) as given."""
    out = np.empty_like(drops)
    for i in range(drops.size):
        out[i] = _root(drops[i], law)[0]
    return out


@compiled
def _floored(p, floor):  # type: ignore[no-untyped-def]
    """Return what a flow law sees of a pressure, by a `PressureFloor`, and its slope."""
    return (0.0, 0.0) if p < 0.0 and floor != 2 else (p, 1.0)


@compiled
def _root(drop, law):  # type: ignore[no-untyped-def]
    """Return the signed square root of a drop and its slope, by an `OrificeLaw`."""
    size = abs(drop)
    if law == 0 and size < ROOT_BLEND:
        a, b = 1.25 / math.sqrt(ROOT_BLEND), -0.25 / (ROOT_BLEND * ROOT_BLEND * math.sqrt(ROOT_BLEND))
        return drop * (a + b * drop * drop), a + 3.0 * b * drop * drop
    if law == 2:
        share, root = math.tanh(drop / TANH_DROP), math.sqrt(size)
        steep = (1.0 - share * share) / TANH_DROP * root
        return share * root, steep + (0.5 * abs(share) / root if size > 0.0 else 0.0)
    return math.copysign(math.sqrt(size), drop), 0.5 / math.sqrt(max(size, STEEPEST))


@compiled
def _port(e, d):  # type: ignore[no-untyped-def]
    """Return area, its slope by e, chord width, its slope by e: (2.15), (2.18), with `e` = d0 ∓ x."""
    rv = d.port_radius
    if d.port_range == 2 and abs(e) > rv:
        return math.nan, math.nan, math.nan, math.nan
    if d.port_range == 0 and abs(e) >= rv:
        return (0.0 if e > 0.0 else d.arc_holes * math.pi * rv * rv), 0.0, 0.0, 0.0
    half = math.sqrt(rv * rv - e * e)
    area = d.arc_holes * rv * rv * math.acos(e / rv) - d.chord_holes * e * half
    if half > 0.0:
        slope = -d.arc_holes * rv * rv / half - d.chord_holes * (half - e * e / half)
        return area, slope, d.rim_holes * 2.0 * half, -d.rim_holes * 2.0 * e / half
    return area, 0.0, d.rim_holes * 2.0 * half, 0.0


@compiled
def _coulomb_friction(xdot, d):  # type: ignore[no-untyped-def]
    """Return Coulomb friction [N], against the motion, and its slope by ẋ."""
    if d.coulomb_friction == 0.0:
        return 0.0, 0.0
    share = math.tanh(xdot / FRICTION_VELOCITY)
    return d.coulomb_friction * share, d.coulomb_friction * (1.0 - share * share) / FRICTION_VELOCITY


@compiled
def _stop_force(x, xdot, d):  # type: ignore[no-untyped-def]
    """Return the end stop's force on the spool [N] and its slopes by x and ẋ."""
    depth = abs(x) - d.stop_position
    if d.stop != 0 or depth <= 0.0:
        return 0.0, 0.0, 0.0
    side = math.copysign(1.0, x)
    onset = min(depth / STOP_ONSET, 1.0)
    push = STOP_STIFFNESS * depth + STOP_DAMPING * onset * side * xdot
    if push <= 0.0:  # a stop does not pull
        return 0.0, 0.0, 0.0
    onset_x = side / STOP_ONSET if onset < 1.0 else 0.0
    slope = STOP_STIFFNESS * side + STOP_DAMPING * onset_x * side * xdot
    return -side * push, -side * slope, -STOP_DAMPING * onset


def zero_state() -> FloatArray:
    """Return the state of the cold start: all zero."""
    return np.zeros(N_STATES)
