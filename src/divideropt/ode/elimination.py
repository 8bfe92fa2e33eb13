"""Makes the compiled elimination for one sparse pattern, as straight-line code without a loop or a zero.

Solvers of chemical kinetics do the same: Sandu and Sander, "Simulating chemical systems in Fortran90 and Matlab with
the Kinetic PreProcessor KPP-2.1", Atmospheric Chemistry and Physics 6 (2006), section 3.4.
"""

from collections.abc import Iterator, Mapping, Sequence

_HEAD = '''"""The elimination of W = I/(γh) - J for one sparse pattern, as straight-line code.

`poe elimination` has made this file from `PATTERN` and `ORDER` in `pattern.py`; a test holds it to them.
"""

from divideropt.ode.compiled import compiled


@compiled
def factorise_shifted(jac, shift, a):  # type: ignore[no-untyped-def]
    """Fill the factors of shift·I - J without pivoting, the inverses of the pivots on the diagonal.

    Args:
        jac: J, shape (n, n); entries outside the pattern are not read.
        shift: 1/(γh).
        a: Receives the factors, shape (n, n); entries outside the pattern and its fill-in stay as they are.
    """
'''

_BETWEEN = '''

@compiled
def solve_shifted(a, b, row):  # type: ignore[no-untyped-def]
    """Solve with those factors in place.

    Args:
        a: Factors, as `factorise_shifted` leaves them.
        b: Right sides, shape (m, n); the row receives the solution.
        row: Which of them.
    """
'''


def elimination_source(pattern: Mapping[int, Sequence[int]], order: Sequence[int]) -> str:
    """Return a module with `factorise_shifted` and `solve_shifted`.

    Args:
        pattern: The columns of each row of J that can hold something else than zero.
        order: The order of elimination: a permutation of the rows.

    Returns:
        Python source, as ruff formats it.
    """
    filled, steps = _eliminate(pattern, order)
    factorise = "\n".join(f"    {line}" for line in _factorising(pattern, filled, steps))
    solve = "\n".join(f"    {line}" for line in _solving(filled, steps))
    return f"{_HEAD}{factorise}\n{_BETWEEN}{solve}\n"


_Step = tuple[int, list[int], list[int]]
"""A pivot, and the rows and columns it still meets."""


def _eliminate(pattern: Mapping[int, Sequence[int]], order: Sequence[int]) -> tuple[dict[int, set[int]], list[_Step]]:
    """Eliminate symbolically: the pattern with its fill-in, and what each pivot does."""
    filled = {row: {*columns, row} for row, columns in pattern.items()}
    steps: list[_Step] = []
    for place, pivot in enumerate(order):
        later = order[place + 1 :]
        rows = [row for row in later if pivot in filled[row]]
        columns = [column for column in later if column in filled[pivot]]
        for row in rows:
            filled[row].update(columns)
        steps.append((pivot, rows, columns))
    return filled, steps


def _factorising(
    pattern: Mapping[int, Sequence[int]], filled: Mapping[int, set[int]], steps: Sequence[_Step]
) -> Iterator[str]:
    for row, column in _places(filled):
        given = f"-jac[{row}, {column}]" if column in pattern[row] else "0.0"
        yield f"a{row}{column} = {f'shift - jac[{row}, {column}]' if row == column else given}"
    for pivot, rows, columns in steps:
        yield f"a{pivot}{pivot} = 1.0 / a{pivot}{pivot}"
        for row in rows:
            yield f"a{row}{pivot} *= a{pivot}{pivot}"
            yield from (f"a{row}{column} -= a{row}{pivot} * a{pivot}{column}" for column in columns)
    for row, column in _places(filled):
        yield f"a[{row}, {column}] = a{row}{column}"


def _solving(filled: Mapping[int, set[int]], steps: Sequence[_Step]) -> Iterator[str]:
    for row in filled:
        yield f"b{row} = b[row, {row}]"
    for pivot, rows, _ in steps:
        yield from (f"b{row} -= a[{row}, {pivot}] * b{pivot}" for row in rows)
    for pivot, _, columns in reversed(steps):
        taken = "".join(f" - a[{pivot}, {column}] * b{column}" for column in columns)
        yield f"b{pivot} = (b{pivot}{taken}) * a[{pivot}, {pivot}]" if taken else f"b{pivot} *= a[{pivot}, {pivot}]"
    for row in filled:
        yield f"b[row, {row}] = b{row}"


def _places(filled: Mapping[int, set[int]]) -> Iterator[tuple[int, int]]:
    return ((row, column) for row in filled for column in sorted(filled[row]))
