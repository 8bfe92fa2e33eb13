"""Small dense linear systems, compiled: factors with partial pivoting, and their use."""

from divideropt.ode.compiled import compiled


@compiled
def factorise(a, pivots):  # type: ignore[no-untyped-def]
    """Factorise a matrix in place.

    Args:
        a: Shape (n, n); receives the factors of its rows in another order.
        pivots: Receives that order, shape (n,), integers.

    Returns:
        Whether it could: not where the matrix is singular or not finite.
    """
    n = pivots.size
    fine = True
    for j in range(n):
        best = j
        for i in range(j + 1, n):
            if abs(a[i, j]) > abs(a[best, j]):
                best = i
        pivots[j] = best
        if not abs(a[best, j]) > 0.0:
            fine = False
        if best != j:
            for m in range(n):
                a[j, m], a[best, m] = a[best, m], a[j, m]
        for i in range(j + 1, n):
            if a[i, j] != 0.0:
                factor = a[i, j] / a[j, j]
                a[i, j] = factor
                for m in range(j + 1, n):
                    a[i, m] -= factor * a[j, m]
    return fine


@compiled
def solve(a, pivots, b):  # type: ignore[no-untyped-def]
    """Solve a system in place.

    Args:
        a: Factors, as `factorise` leaves them, shape (n, n).
        pivots: Their order, shape (n,).
        b: The right side, shape (n,); receives the solution.
    """
    n = pivots.size
    for j in range(n):
        best = pivots[j]
        if best != j:
            b[j], b[best] = b[best], b[j]
    for j in range(n):
        if b[j] != 0.0:
            for i in range(j + 1, n):
                b[i] -= a[i, j] * b[j]
    for j in range(n - 1, -1, -1):
        total = b[j]
        for i in range(j + 1, n):
            total -= a[j, i] * b[i]
        b[j] = total / a[j, j]
