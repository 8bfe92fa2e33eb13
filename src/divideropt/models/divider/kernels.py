"""The equations of motion (2.8)–(2.19), (3.1)–(3.4), compiled: rates and their Jacobian in one pass.

States, in order: Ps, Pa1, Pa2, Pb1, Pb2, ẋ, x, PL1, PL2 [Pa, m/s, m]. Everything a design fixes comes in one
record of `COEFFICIENTS`; the pilot stage is in it as two 3×3 matrices, folded once unless the spool is turned. The
record's options choose between the formulations; no equation stands twice.
"""

import math

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.ode.compiled import compiled
from divideropt.ode.linear import factorise, solve
from divideropt.ode.rosenbrock import RATES, SLOPES, STAGE_TIME, TIME, TIME_DIFFERENCE, advance, begin

STATES = ("Ps", "Pa1", "Pa2", "Pb1", "Pb2", "xdot", "x", "PL1", "PL2")
"""Names of the states, in the order of a state vector."""

N_STATES = len(STATES)

_VELOCITY, _POSITION = STATES.index("xdot"), STATES.index("x")

ROOT_BLEND = 100.0
"""Below this drop [Pa] the smooth root is a cubic: far below any drop that matters, far above rounding."""

TANH_DROP = 1e4
"""p_tan of (2.9) [Pa]."""

STEEPEST = 1.0
"""The signed root's infinite slope at 0 is replaced in the Jacobian, not in the rates, by that at this drop [Pa]."""

FRICTION_VELOCITY = 1e-6
"""ẋ_tan of (2.17) [m/s]: Coulomb friction is Fc tanh(ẋ/ẋ_tan)."""

STOP_STIFFNESS = 1e8
"""End stop [N/m]: the largest end force, some 2 kN, presses the spool 20 µm into it."""

STOP_DAMPING = 5e3
"""End stop [N s/m]: about critical for the stiffness and the mass of a spool, so that it does not chatter."""

STOP_ONSET = 1e-7
"""Depth [m] over which the damping sets in, so that the force is continuous at the touch."""

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
    jac = np.zeros((N_STATES, N_STATES))
    motion(t, y, design[0], out, jac)
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
        jac: Receives the Jacobian, shape (9, 9); must hold zeros.
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

    # Source and flow chambers, (2.8), (2.11), (2.12).
    g = d.source_gain
    out[0] = g * (
        source_flow - Qs1 - Qs2
        + (p1[0, 0] * Ps + p1[0, 1] * Pa1 + p1[0, 2] * Pb1)
        + (p2[0, 0] * Ps + p2[0, 1] * Pa2 + p2[0, 2] * Pb2)
    )  # fmt: skip
    jac[0, 0] = g * (-Qs1_ - Qs2_ + p1[0, 0] + p2[0, 0]) * Ps_
    jac[0, 1] = g * (Qs1_ + p1[0, 1]) * Pa1_
    jac[0, 2] = g * (Qs2_ + p2[0, 1]) * Pa2_
    jac[0, 3] = g * p1[0, 2] * Pb1_
    jac[0, 4] = g * p2[0, 2] * Pb2_

    g = d.chamber_gain
    out[1] = g * (Qs1 - QL1 + (p1[1, 0] * Ps + p1[1, 1] * Pa1 + p1[1, 2] * Pb1))
    jac[1, 0] = g * (Qs1_ + p1[1, 0]) * Ps_
    jac[1, 1] = g * (-Qs1_ - QL1_ + p1[1, 1]) * Pa1_
    jac[1, 3] = g * p1[1, 2] * Pb1_
    jac[1, 6] = -g * QL1_x
    jac[1, 7] = g * QL1_ * PL1_
    out[2] = g * (Qs2 - QL2 + (p2[1, 0] * Ps + p2[1, 1] * Pa2 + p2[1, 2] * Pb2))
    jac[2, 0] = g * (Qs2_ + p2[1, 0]) * Ps_
    jac[2, 2] = g * (-Qs2_ - QL2_ + p2[1, 1]) * Pa2_
    jac[2, 4] = g * p2[1, 2] * Pb2_
    jac[2, 6] = -g * QL2_x
    jac[2, 8] = g * QL2_ * PL2_

    # End chambers, (2.38)–(2.41); the end seals leak to tank.
    swept = xdot * d.end_area
    Vb1 = max(d.end_volume + d.end_area * x, SMALLEST_VOLUME)
    g = d.bulk_modulus / Vb1
    out[3] = g * (p1[2, 0] * Ps + p1[2, 1] * Pa1 + p1[2, 2] * Pb1 - swept - d.seal_leakage * Pb1)
    jac[3, 0] = g * p1[2, 0] * Ps_
    jac[3, 1] = g * p1[2, 1] * Pa1_
    jac[3, 3] = g * (p1[2, 2] - d.seal_leakage) * Pb1_
    jac[3, 5] = -g * d.end_area * x_
    jac[3, 6] = -out[3] * d.end_area / Vb1 * x_
    Vb2 = max(d.end_volume - d.end_area * x, SMALLEST_VOLUME)
    g = d.bulk_modulus / Vb2
    out[4] = g * (p2[2, 0] * Ps + p2[2, 1] * Pa2 + p2[2, 2] * Pb2 + swept - d.seal_leakage * Pb2)
    jac[4, 0] = g * p2[2, 0] * Ps_
    jac[4, 2] = g * p2[2, 1] * Pa2_
    jac[4, 4] = g * (p2[2, 2] - d.seal_leakage) * Pb2_
    jac[4, 5] = g * d.end_area * x_
    jac[4, 6] = out[4] * d.end_area / Vb2 * x_

    # What a groove's entrance and exit take off the flows through it.
    if d.entrance_loss > 0.0:
        near, far = position * d.groove_angle, (1.0 - position) * d.groove_angle
        e, e_ = _excess(Ps - Pb1, near, d.entrance_loss, d)
        _carry(e, e_, 0, 3, Ps_, Pb1_, d.pilot_bypass * d.source_gain, d.bulk_modulus / Vb1, out, jac)
        jac[3, 6] -= 2.0 * e * d.bulk_modulus / Vb1 * d.end_area / Vb1 * x_
        e, e_ = _excess(Pb1 - Pa1, far, d.exit_loss, d)
        _carry(e, e_, 3, 1, Pb1_, Pa1_, d.bulk_modulus / Vb1, d.pilot_bypass * d.chamber_gain, out, jac)
        jac[3, 6] += 2.0 * e * d.bulk_modulus / Vb1 * d.end_area / Vb1 * x_
        e, e_ = _excess(Ps - Pb2, far, d.entrance_loss, d)
        _carry(e, e_, 0, 4, Ps_, Pb2_, d.pilot_bypass * d.source_gain, d.bulk_modulus / Vb2, out, jac)
        jac[4, 6] += 2.0 * e * d.bulk_modulus / Vb2 * d.end_area / Vb2 * x_
        e, e_ = _excess(Pb2 - Pa2, near, d.exit_loss, d)
        _carry(e, e_, 4, 2, Pb2_, Pa2_, d.bulk_modulus / Vb2, d.pilot_bypass * d.chamber_gain, out, jac)
        jac[4, 6] -= 2.0 * e * d.bulk_modulus / Vb2 * d.end_area / Vb2 * x_

    # Load lines, (3.1), (3.2).
    g = d.load_gain
    out[7] = g * (QL1 - QLo1)
    jac[7, 1] = g * QL1_ * Pa1_
    jac[7, 6] = g * QL1_x
    jac[7, 7] = g * (-QL1_ - QLo1_) * PL1_
    out[8] = g * (QL2 - QLo2)
    jac[8, 2] = g * QL2_ * Pa2_
    jac[8, 6] = g * QL2_x
    jac[8, 8] = g * (-QL2_ - QLo2_) * PL2_

    # The spool, (2.17), with C.3's transient flow force, both jets braking.
    drag_Pa1_, drag_Pa2_, drag_PL1_, drag_PL2_ = Pa1_, Pa2_, PL1_, PL2_
    if d.pressure_floor == 0:  # forces see the pressures as they are
        Pa1, Pa2, Pb1, Pb2, PL1, PL2 = y[1], y[2], y[3], y[4], y[7], y[8]
        Pa1_, Pa2_, Pb1_, Pb2_, PL1_, PL2_ = 1.0, 1.0, 1.0, 1.0, 1.0, 1.0
    rim = d.rim_thickness / 2.0
    drag = d.transient * (w1 * root_1 + w2 * root_2)
    friction = math.tanh(xdot / FRICTION_VELOCITY)
    stop, stop_x, stop_v = _stop_force(x, xdot, d)
    m = d.mass
    out[5] = (
        (Pb1 - Pb2) * d.end_area
        + rim * w1 * (PL1 - Pa1)
        - rim * w2 * (PL2 - Pa2)
        - (d.viscous_friction + drag) * xdot
        - d.coulomb_friction * friction
        + d.extra_force
        + stop
    ) / m
    jac[5, 1] = (-rim * w1 * Pa1_ - d.transient * w1 * root_1_ * xdot * drag_Pa1_) / m
    jac[5, 2] = (rim * w2 * Pa2_ - d.transient * w2 * root_2_ * xdot * drag_Pa2_) / m
    jac[5, 3] = d.end_area / m * Pb1_
    jac[5, 4] = -d.end_area / m * Pb2_
    friction_v = d.coulomb_friction * (1.0 - friction * friction) / FRICTION_VELOCITY
    jac[5, 5] = (-d.viscous_friction - drag - friction_v + stop_v) / m * x_
    brake_x = d.transient * (w1_x * root_1 + w2_x * root_2) * xdot
    jac[5, 6] = (rim * w1_x * (PL1 - Pa1) - rim * w2_x * (PL2 - Pa2) - brake_x + stop_x) / m
    jac[5, 7] = (rim * w1 * PL1_ + d.transient * w1 * root_1_ * xdot * drag_PL1_) / m
    jac[5, 8] = (-rim * w2 * PL2_ + d.transient * w2 * root_2_ * xdot * drag_PL2_) / m
    out[6] = xdot
    jac[6, 5] = x_


@compiled
def centred_state(design):  # type: ignore[no-untyped-def]
    """Guess a state with the spool centred and the source flow halved, shape (9,)."""
    d = design[0]
    half = d.source_flow / 2.0
    y = np.zeros(N_STATES)
    y[7], y[8] = (half / d.load_1) ** 2, (half / d.load_2) ** 2
    port = (half / (d.variable * 0.5 * math.pi * d.port_radius * d.port_radius * d.arc_holes)) ** 2
    y[1], y[2] = y[7] + port, y[8] + port
    y[0] = max(y[1] + (half / d.fixed_1) ** 2, y[2] + (half / d.fixed_2) ** 2)
    y[3], y[4] = (y[0] + y[1]) / 2.0, (y[0] + y[2]) / 2.0
    return y


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
def newton(design, y, unknowns, balances, scale, reach, tolerance, loosest, iterations, halvings):  # type: ignore[no-untyped-def]
    """Solve some balances for some states by damped Newton steps.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        y: The start, shape (9,); receives the solution. The spool's velocity stays as it is.
        unknowns: Indices of the states to be found, shape (m,).
        balances: Indices of the rates that must vanish, shape (m,).
        scale: What divides those, shape (m,).
        reach: Largest distance of the spool from the centre [m].
        tolerance: Scaled residual at which it stops.
        loosest: Scaled residual that will do where no step improves it.
        iterations: Budget of steps.
        halvings: How often a step is halved before it is taken as lost.

    Returns:
        The largest scaled residual, or NaN where it is not small.
    """
    m = unknowns.size
    d = design[0]
    out, jac, spare = np.empty(N_STATES), np.zeros((N_STATES, N_STATES)), np.zeros((N_STATES, N_STATES))
    a, pivots, step, trial = np.empty((m, m)), np.empty(m, np.int64), np.empty(m), np.empty(N_STATES)
    motion(0.0, y, d, out, jac)
    size = _largest(out, balances, scale)
    for _ in range(iterations):
        if not size < math.inf:
            return math.nan
        if size <= tolerance:
            return size
        for i in range(m):
            for j in range(m):
                a[i, j] = jac[balances[i], unknowns[j]] / scale[i]
            step[i] = -out[balances[i]] / scale[i]
        if not factorise(a, pivots):
            return math.nan
        solve(a, pivots, step)
        improved = False
        share = 1.0
        for _ in range(halvings):
            _step_to(y, step, share, unknowns, reach, trial)
            motion(0.0, trial, d, out, spare)
            new = _largest(out, balances, scale)
            if new < size:
                improved = True
                break
            share *= 0.5
        if not improved:
            return size if size <= loosest else math.nan
        for i in range(N_STATES):
            y[i] = trial[i]
        size = new
        _clear(jac)
        motion(0.0, y, d, out, jac)
    return math.nan


@compiled
def _step_to(y, step, share, unknowns, reach, trial):  # type: ignore[no-untyped-def]
    """Fill the state a share of a step away; pressures stay positive, the spool within reach."""
    for i in range(N_STATES):
        trial[i] = y[i]
    for i in range(unknowns.size):
        trial[unknowns[i]] += share * step[i]
    for i in range(N_STATES):
        if i not in (_VELOCITY, _POSITION):
            trial[i] = max(trial[i], 0.0)
    trial[_POSITION] = min(max(trial[_POSITION], -reach), reach)


@compiled
def _largest(out, balances, scale):  # type: ignore[no-untyped-def]
    """Return the largest scaled residual; NaN where one is."""
    size = 0.0
    for i in range(balances.size):
        value = abs(out[balances[i]]) / scale[i]
        if math.isnan(value):
            return value
        size = max(size, value)
    return size


@compiled
def residual_scales(design, y, pressure):  # type: ignore[no-untyped-def]
    """Return what divides each rate, shape (9,): that of a pressure as if the source flow filled its volume.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        y: State, shape (9,).
        pressure: On the end area it makes the force that divides a force [Pa].
    """
    d = design[0]
    flow = d.source_flow
    scale = np.ones(N_STATES)
    scale[0] = flow * d.source_gain
    scale[1] = scale[2] = flow * d.chamber_gain
    scale[3] = flow * d.bulk_modulus / (d.end_volume + d.end_area * y[_POSITION])
    scale[4] = flow * d.bulk_modulus / (d.end_volume - d.end_area * y[_POSITION])
    scale[_VELOCITY] = pressure * d.end_area / d.mass
    scale[7] = scale[8] = flow * d.load_gain
    return scale


@compiled
def run(design, first, last, limit, s, k, y, f0, f, jac, slope, lu, pivots, U, u, rtol, atol, bound, edges, values):  # type: ignore[no-untyped-def]
    """Integrate by `divideropt.ode.rosenbrock`: the loop that supplies its right-hand side.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        first: First time [s].
        last: Last time [s].
        limit: Budget of steps.
        s: With those that follow up to `u`, the arrays of a `Workspace`; `y` holds the start.
        k: See `s`.
        y: See `s`.
        f0: See `s`.
        f: See `s`.
        jac: See `s`.
        slope: See `s`.
        lu: See `s`.
        pivots: See `s`.
        U: See `s`.
        u: See `s`.
        rtol: Relative tolerance.
        atol: Absolute tolerance a state, shape (9,).
        bound: Where the spool's position ends the run [m]; infinity if nowhere.
        edges: Receives the times, shape (limit + 1,).
        values: Receives the states at the nodes of each step, shape (limit, 9, NODES_PER_STEP).

    Returns:
        How it ended, as `advance`.
    """
    d = design[0]
    spare = np.zeros((N_STATES, N_STATES))
    edges[0] = first
    _clear(jac)
    motion(first, y, d, f0, jac)
    begin(s, k, first, last, limit, y, f0, rtol, atol)
    while True:
        if d.moving != 0:
            _time_slope(s[TIME], TIME_DIFFERENCE * (last - first), y, d, f, slope, spare)
        wanted = RATES
        while wanted == RATES:
            wanted = advance(
                s, k, y, f0, f, jac, slope, lu, pivots, U, u, rtol, atol, _POSITION, bound, edges, values
            )
            if wanted == RATES:
                motion(s[STAGE_TIME], u, d, f, spare)
        if wanted != SLOPES:
            return wanted
        _clear(jac)
        motion(s[TIME], y, d, f0, jac)


@compiled
def _clear(matrix):  # type: ignore[no-untyped-def]
    """Fill a matrix with zeros."""
    for i in range(N_STATES):
        for j in range(N_STATES):
            matrix[i, j] = 0.0


@compiled
def _time_slope(t, step, y, d, f, slope, spare):  # type: ignore[no-untyped-def]
    """Fill ∂f/∂t by a central difference; `f` and `spare` are work."""
    motion(t + step, y, d, slope, spare)
    motion(t - step, y, d, f, spare)
    for i in range(N_STATES):
        slope[i] = (slope[i] - f[i]) / (2.0 * step)


@compiled
def fold_pilot(position, d):  # type: ignore[no-untyped-def]
    """Fold the pilot stage: what both grooves of a side add to supply, flow chamber and end chamber.

    Args:
        position: φ/φ0.
        d: A record of `COEFFICIENTS`; receives `pilot_1` and `pilot_2`, each shape (3, 3): a row a balance, a column
            for each of Ps, Pa, Pb [m^3/(s Pa)].
    """
    near, far = position * d.groove_angle, (1.0 - position) * d.groove_angle
    conductance, length, leakage = d.groove_conductance, d.groove_length, d.groove_leakage
    gather(fold_side(d.pilot, conductance, length, leakage, near, far, 1.0), d.pilot_bypass, d.pilot_1)
    gather(fold_side(d.pilot, conductance, length, leakage, far, near, d.leakage_sign), d.pilot_bypass, d.pilot_2)


@compiled
def fold_side(pilot, conductance, length, leakage, near, far, leakage_sign):  # type: ignore[no-untyped-def]
    """Fold the grooves of one side, whose tap lies the angle `near` from the supply and `far` from the outlet.

    Args:
        pilot: A `Pilot`.
        conductance: G = b⁴/(185 μ r √c) [m^3/(s Pa)].
        length: √c [rad], (A.13).
        leakage: r δ³/(6 μ h) [m^3/(s Pa)].
        near: Angle from supply to tap.
        far: Angle from tap to outlet.
        leakage_sign: Of the profile's part in the end chamber's leakage.

    Returns:
        Coefficients of (Ps, Pa, Pb), shape (6, 3), rows inlet, arriving, tap, outlet (one groove), end_leakage,
        chamber_leakage (both).
    """
    rows = np.empty((6, 3))
    across = leakage * (near + far) / 2.0
    if pilot == 0:
        # c P'' = P - (Pa + Pb)/2 in half angles, which neither overflow nor cancel: coth v ∓ 1/sinh v = tanh(v/2)^±1.
        tanh_near, tanh_far = math.tanh(near / length / 2.0), math.tanh(far / length / 2.0)
        to_end, to_chamber = conductance / tanh_near / 2.0, conductance * tanh_near / 2.0
        out = conductance / tanh_far / 2.0
        along = leakage * length * tanh_near
        _fill(rows, 0, to_end + to_chamber, -to_chamber, -to_end)
        _fill(rows, 1, to_end - to_chamber, to_chamber, -to_end)
        _fill(rows, 2, to_end - to_chamber, to_chamber + out, -to_end - out)
        _fill(rows, 3, 0.0, -out, out)
        _fill(rows, 4, -along, along - across, across)
        _fill(rows, 5, along, -along - across, across)
        return rows
    # (2.20)-(2.33), (2.42) about the chambers' mean pressure, end flows as (A.29), (A.30); or, as coded in C.3,
    # (A.22)-(A.25), (A.31)-(A.38) about zero.
    mean = 0.5 if pilot == 1 else 0.0
    sin_near, cos_near = math.sin(near / length), math.cos(near / length)
    sin_far, cos_far = math.sin(far / length), math.cos(far / length)
    for i in range(3):
        share = mean if i > 0 else 0.0  # of Pa and Pb in their mean
        ps, pa, pb = -share, -share, -share
        if i == 0:
            ps += 1.0
        elif i == 1:
            pa += 1.0
        else:
            pb += 1.0
        at_supply = (pb - ps * cos_near) / sin_near  # Cd1, Cb2
        at_outlet = (pb - pa * cos_far) / sin_far  # Cb1, Cd2
        profile = -ps * sin_near + at_supply * (cos_near - 1.0) - pa * sin_far - at_outlet * (1.0 - cos_far)
        rows[0, i] = -conductance * at_supply
        rows[1, i] = conductance * (ps * sin_near - at_supply * cos_near)
        rows[2, i] = rows[1, i] - conductance * (at_outlet * cos_far - pa * sin_far)
        rows[3, i] = conductance * at_outlet
        rows[4, i] = across * (pb - pa) + leakage_sign * leakage * length * profile
        rows[5, i] = across * (pb - pa) - leakage * length * profile
    return rows


@compiled
def _fill(rows, i, ps, pa, pb):  # type: ignore[no-untyped-def]
    """Fill a row; element by element, since an array expression takes numba seconds to compile."""
    rows[i, 0], rows[i, 1], rows[i, 2] = ps, pa, pb


@compiled
def gather(rows, bypass, net):  # type: ignore[no-untyped-def]
    """Gather a side's flows into the balances of supply, flow chamber and end chamber, shape (3, 3)."""
    for i in range(3):
        net[0, i] = -2.0 * bypass * rows[0, i]
        net[1, i] = bypass * (2.0 * rows[3, i] + rows[5, i])
        net[2, i] = 2.0 * rows[2, i] - rows[4, i]


@compiled
def load_coefficients(since, d):  # type: ignore[no-untyped-def]
    """Return CdL AL √(2/ρ) of both loads, `since` seconds after their pressures began to move."""
    first = d.load_flow / math.sqrt(d.load_pressure_1 + d.load_pressure_1_rate * since)
    second = d.load_flow / math.sqrt(d.load_pressure_2 + d.load_pressure_2_rate * since)
    return first, second


@compiled
def _excess(drop, angle, loss, d):  # type: ignore[no-untyped-def]
    """Return what a loss adds to the laminar flow through a stretch of one groove (negative), and its slope.

    The flow q is the root of R q + k q |q| = drop, with R the stretch's laminar resistance and k the loss.
    """
    laminar = d.groove_conductance * d.groove_length / angle
    resistance = 1.0 / laminar
    root = math.sqrt(resistance * resistance + 4.0 * loss * abs(drop))
    return drop * (2.0 / (resistance + root) - laminar), 1.0 / root - laminar


@compiled
def _carry(e, e_, here, there, here_, there_, gain_here, gain_there, out, jac):  # type: ignore[no-untyped-def]
    """Take a flow and its slope in both grooves from one balance to another."""
    out[here] -= 2.0 * gain_here * e
    jac[here, here] -= 2.0 * gain_here * e_ * here_
    jac[here, there] += 2.0 * gain_here * e_ * there_
    out[there] += 2.0 * gain_there * e
    jac[there, here] += 2.0 * gain_there * e_ * here_
    jac[there, there] -= 2.0 * gain_there * e_ * there_


@compiled
def groove_inlets(y, d):  # type: ignore[no-untyped-def]
    """Return Qc1i and Qc2i [m^3/s], from the supply into one groove of either side, at a state under constant inputs.

    Args:
        y: State, shape (9,).
        d: A record of `COEFFICIENTS`.
    """
    near, far = d.spool_position * d.groove_angle, (1.0 - d.spool_position) * d.groove_angle
    first = fold_side(d.pilot, d.groove_conductance, d.groove_length, d.groove_leakage, near, far, 1.0)[0]
    second = fold_side(d.pilot, d.groove_conductance, d.groove_length, d.groove_leakage, far, near, 1.0)[0]
    q1 = first[0] * y[0] + first[1] * y[1] + first[2] * y[3]
    q2 = second[0] * y[0] + second[1] * y[2] + second[2] * y[4]
    if d.entrance_loss > 0.0:
        q1 += _excess(y[0] - y[3], near, d.entrance_loss, d)[0]
        q2 += _excess(y[0] - y[4], far, d.entrance_loss, d)[0]
    return q1, q2


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
