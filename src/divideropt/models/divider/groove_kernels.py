"""The grooves of the pilot stage, compiled: flows folded into coefficients, and what a loss at their ends takes off.

`pilot.py` says what the coefficients mean; the equations of motion use them.
"""

import math

import numpy as np

from divideropt.ode.compiled import compiled


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
        # Element by element: an array expression takes numba seconds to compile.
        rows[0, 0], rows[0, 1], rows[0, 2] = to_end + to_chamber, -to_chamber, -to_end
        rows[1, 0], rows[1, 1], rows[1, 2] = to_end - to_chamber, to_chamber, -to_end
        rows[2, 0], rows[2, 1], rows[2, 2] = rows[1, 0], to_chamber + out, -to_end - out
        rows[3, 0], rows[3, 1], rows[3, 2] = 0.0, -out, out
        rows[4, 0], rows[4, 1], rows[4, 2] = -along, along - across, across
        rows[5, 0], rows[5, 1], rows[5, 2] = along, -along - across, across
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
def gather(rows, bypass, net):  # type: ignore[no-untyped-def]
    """Gather a side's flows into the balances of supply, flow chamber and end chamber, shape (3, 3)."""
    for i in range(3):
        net[0, i] = -2.0 * bypass * rows[0, i]
        net[1, i] = bypass * (2.0 * rows[3, i] + rows[5, i])
        net[2, i] = 2.0 * rows[2, i] - rows[4, i]


@compiled
def groove_excess(drop, angle, loss, d):  # type: ignore[no-untyped-def]
    """Return what a loss adds to the laminar flow through a stretch of one groove (negative), and its slope.

    The flow q is the root of R q + k q |q| = drop, with R the stretch's laminar resistance and k the loss.
    """
    laminar = d.groove_conductance * d.groove_length / angle
    resistance = 1.0 / laminar
    root = math.sqrt(resistance * resistance + 4.0 * loss * abs(drop))
    return drop * (2.0 / (resistance + root) - laminar), 1.0 / root - laminar


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
        q1 += groove_excess(y[0] - y[3], near, d.entrance_loss, d)[0]
        q2 += groove_excess(y[0] - y[4], far, d.entrance_loss, d)[0]
    return q1, q2
