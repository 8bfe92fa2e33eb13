"""The rightmost eigenvalue of a small dense matrix, compiled.

LAPACK takes more than twice as long at nine states. The method is the one it uses: Householder reflections to
Hessenberg form, then implicit double shifts (Golub and Van Loan, Matrix Computations, fourth edition, sections 7.4
and 7.5).
"""

import math

from divideropt.ode.compiled import compiled

EPSILON = 2.0**-52
SWEEPS = 30
"""Budget of sweeps an eigenvalue; three are usual. After every tenth the shift is an exceptional one."""


@compiled
def largest_real_part(a):  # type: ignore[no-untyped-def]
    """Return the largest real part of a matrix's eigenvalues; NaN where one is not found, or an entry is no number.

    Args:
        a: Shape (n, n), scaled so that its rows and columns are alike in size; destroyed.
    """
    _to_hessenberg(a)
    size = 0.0
    for i in range(a.shape[0]):
        for j in range(a.shape[0]):
            size += abs(a[i, j])
    if not size < math.inf:
        return math.nan
    best = -math.inf
    last, sweeps = a.shape[0] - 1, 0
    while last >= 0:
        first = _deflate(a, last, size)
        if first == last:
            best = max(best, a[last, last])
            last, sweeps = last - 1, 0
        elif first == last - 1:
            best = max(best, _of_pair(a, last))
            last, sweeps = last - 2, 0
        elif sweeps == SWEEPS:
            return math.nan
        else:
            sweeps += 1
            _sweep(a, first, last, sweeps % 10 == 0)
    return best


@compiled
def _to_hessenberg(a):  # type: ignore[no-untyped-def]
    """Reflect a matrix to Hessenberg form; what is below the subdiagonal is left as it falls, and is not read."""
    n = a.shape[0]
    for k in range(n - 2):
        below = 0.0
        for i in range(k + 2, n):
            below += a[i, k] * a[i, k]
        if below == 0.0:
            continue
        head = a[k + 1, k]
        length = math.copysign(math.sqrt(head * head + below), head)
        lead = head + length  # the reflection's vector: this, and the column below it
        share = 1.0 / (length * lead)
        for j in range(k + 1, n):
            total = lead * a[k + 1, j]
            for i in range(k + 2, n):
                total += a[i, k] * a[i, j]
            total *= share
            a[k + 1, j] -= total * lead
            for i in range(k + 2, n):
                a[i, j] -= total * a[i, k]
        for i in range(n):
            total = lead * a[i, k + 1]
            for j in range(k + 2, n):
                total += a[j, k] * a[i, j]
            total *= share
            a[i, k + 1] -= total * lead
            for j in range(k + 2, n):
                a[i, j] -= total * a[j, k]
        a[k + 1, k] = -length
        for i in range(k + 2, n):
            a[i, k] = 0.0


@compiled
def _deflate(a, last, size):  # type: ignore[no-untyped-def]
    """Return the first row of the unreduced block that ends at a row."""
    for i in range(last, 0, -1):
        beside = abs(a[i - 1, i - 1]) + abs(a[i, i])
        if abs(a[i, i - 1]) <= EPSILON * (beside if beside > 0.0 else size):
            return i
    return 0


@compiled
def _of_pair(a, last):  # type: ignore[no-untyped-def]
    """Return the largest real part of the eigenvalues of the two by two block that ends at a row."""
    p, q, x = a[last - 1, last - 1], a[last, last], a[last - 1, last] * a[last, last - 1]
    half = 0.5 * (p - q)
    square = half * half + x
    if square < 0.0:
        return 0.5 * (p + q)
    away = half + math.copysign(math.sqrt(square), half)
    if away == 0.0:
        return q
    return max(q + away, q - x / away)


@compiled
def _sweep(a, first, last, exceptional):  # type: ignore[no-untyped-def]
    """Chase one double shift down a block."""
    p, q = a[last - 1, last - 1], a[last, last]
    total, product = p + q, p * q - a[last - 1, last] * a[last, last - 1]
    if exceptional:
        off = abs(a[last, last - 1]) + abs(a[last - 1, last - 2])
        total, product = 1.5 * off, off * off
    top, next_ = a[first, first], a[first + 1, first]
    x = top * top + a[first, first + 1] * next_ - total * top + product
    y = next_ * (top + a[first + 1, first + 1] - total)
    z = next_ * a[first + 2, first + 1]
    for k in range(first, last):
        three = k < last - 1
        if not three:
            z = 0.0
        length = math.copysign(math.sqrt(x * x + y * y + z * z), x)
        if length != 0.0:
            lead = x + length
            v, w, share = y / lead, z / lead, lead / length
            for j in range(max(k - 1, first), last + 1):
                turn = a[k, j] + v * a[k + 1, j] + (w * a[k + 2, j] if three else 0.0)
                turn *= share
                a[k, j] -= turn
                a[k + 1, j] -= turn * v
                if three:
                    a[k + 2, j] -= turn * w
            for i in range(first, min(k + 3, last) + 1):
                turn = a[i, k] + v * a[i, k + 1] + (w * a[i, k + 2] if three else 0.0)
                turn *= share
                a[i, k] -= turn
                a[i, k + 1] -= turn * v
                if three:
                    a[i, k + 2] -= turn * w
        if k > first:
            a[k + 1, k - 1] = 0.0
            if three:
                a[k + 2, k - 1] = 0.0
        if k < last - 1:
            x, y = a[k + 1, k], a[k + 2, k]
            z = a[k + 3, k] if k + 3 <= last else 0.0
