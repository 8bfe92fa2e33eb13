"""The elimination of W = I/(γh) - J for one sparse pattern, as straight-line code.

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
    a00 = shift - jac[0, 0]
    a01 = -jac[0, 1]
    a02 = -jac[0, 2]
    a03 = -jac[0, 3]
    a04 = -jac[0, 4]
    a05 = 0.0
    a10 = -jac[1, 0]
    a11 = shift - jac[1, 1]
    a13 = -jac[1, 3]
    a15 = 0.0
    a16 = -jac[1, 6]
    a17 = -jac[1, 7]
    a20 = -jac[2, 0]
    a22 = shift - jac[2, 2]
    a24 = -jac[2, 4]
    a25 = 0.0
    a26 = -jac[2, 6]
    a28 = -jac[2, 8]
    a30 = -jac[3, 0]
    a31 = -jac[3, 1]
    a33 = shift - jac[3, 3]
    a35 = -jac[3, 5]
    a36 = -jac[3, 6]
    a40 = -jac[4, 0]
    a42 = -jac[4, 2]
    a44 = shift - jac[4, 4]
    a45 = -jac[4, 5]
    a46 = -jac[4, 6]
    a50 = 0.0
    a51 = -jac[5, 1]
    a52 = -jac[5, 2]
    a53 = -jac[5, 3]
    a54 = -jac[5, 4]
    a55 = shift - jac[5, 5]
    a56 = -jac[5, 6]
    a57 = -jac[5, 7]
    a58 = -jac[5, 8]
    a65 = -jac[6, 5]
    a66 = shift - jac[6, 6]
    a71 = -jac[7, 1]
    a75 = 0.0
    a76 = -jac[7, 6]
    a77 = shift - jac[7, 7]
    a82 = -jac[8, 2]
    a85 = 0.0
    a86 = -jac[8, 6]
    a88 = shift - jac[8, 8]
    a66 = 1.0 / a66
    a76 *= a66
    a75 -= a76 * a65
    a86 *= a66
    a85 -= a86 * a65
    a36 *= a66
    a35 -= a36 * a65
    a46 *= a66
    a45 -= a46 * a65
    a16 *= a66
    a15 -= a16 * a65
    a26 *= a66
    a25 -= a26 * a65
    a56 *= a66
    a55 -= a56 * a65
    a77 = 1.0 / a77
    a17 *= a77
    a11 -= a17 * a71
    a15 -= a17 * a75
    a57 *= a77
    a51 -= a57 * a71
    a55 -= a57 * a75
    a88 = 1.0 / a88
    a28 *= a88
    a22 -= a28 * a82
    a25 -= a28 * a85
    a58 *= a88
    a52 -= a58 * a82
    a55 -= a58 * a85
    a33 = 1.0 / a33
    a13 *= a33
    a11 -= a13 * a31
    a10 -= a13 * a30
    a15 -= a13 * a35
    a03 *= a33
    a01 -= a03 * a31
    a00 -= a03 * a30
    a05 -= a03 * a35
    a53 *= a33
    a51 -= a53 * a31
    a50 -= a53 * a30
    a55 -= a53 * a35
    a44 = 1.0 / a44
    a24 *= a44
    a22 -= a24 * a42
    a20 -= a24 * a40
    a25 -= a24 * a45
    a04 *= a44
    a02 -= a04 * a42
    a00 -= a04 * a40
    a05 -= a04 * a45
    a54 *= a44
    a52 -= a54 * a42
    a50 -= a54 * a40
    a55 -= a54 * a45
    a11 = 1.0 / a11
    a01 *= a11
    a00 -= a01 * a10
    a05 -= a01 * a15
    a51 *= a11
    a50 -= a51 * a10
    a55 -= a51 * a15
    a22 = 1.0 / a22
    a02 *= a22
    a00 -= a02 * a20
    a05 -= a02 * a25
    a52 *= a22
    a50 -= a52 * a20
    a55 -= a52 * a25
    a00 = 1.0 / a00
    a50 *= a00
    a55 -= a50 * a05
    a55 = 1.0 / a55
    a[0, 0] = a00
    a[0, 1] = a01
    a[0, 2] = a02
    a[0, 3] = a03
    a[0, 4] = a04
    a[0, 5] = a05
    a[1, 0] = a10
    a[1, 1] = a11
    a[1, 3] = a13
    a[1, 5] = a15
    a[1, 6] = a16
    a[1, 7] = a17
    a[2, 0] = a20
    a[2, 2] = a22
    a[2, 4] = a24
    a[2, 5] = a25
    a[2, 6] = a26
    a[2, 8] = a28
    a[3, 0] = a30
    a[3, 1] = a31
    a[3, 3] = a33
    a[3, 5] = a35
    a[3, 6] = a36
    a[4, 0] = a40
    a[4, 2] = a42
    a[4, 4] = a44
    a[4, 5] = a45
    a[4, 6] = a46
    a[5, 0] = a50
    a[5, 1] = a51
    a[5, 2] = a52
    a[5, 3] = a53
    a[5, 4] = a54
    a[5, 5] = a55
    a[5, 6] = a56
    a[5, 7] = a57
    a[5, 8] = a58
    a[6, 5] = a65
    a[6, 6] = a66
    a[7, 1] = a71
    a[7, 5] = a75
    a[7, 6] = a76
    a[7, 7] = a77
    a[8, 2] = a82
    a[8, 5] = a85
    a[8, 6] = a86
    a[8, 8] = a88


@compiled
def solve_shifted(a, b, row):  # type: ignore[no-untyped-def]
    """Solve with those factors in place.

    Args:
        a: Factors, as `factorise_shifted` leaves them.
        b: Right sides, shape (m, n); the row receives the solution.
        row: Which of them.
    """
    b0 = b[row, 0]
    b1 = b[row, 1]
    b2 = b[row, 2]
    b3 = b[row, 3]
    b4 = b[row, 4]
    b5 = b[row, 5]
    b6 = b[row, 6]
    b7 = b[row, 7]
    b8 = b[row, 8]
    b7 -= a[7, 6] * b6
    b8 -= a[8, 6] * b6
    b3 -= a[3, 6] * b6
    b4 -= a[4, 6] * b6
    b1 -= a[1, 6] * b6
    b2 -= a[2, 6] * b6
    b5 -= a[5, 6] * b6
    b1 -= a[1, 7] * b7
    b5 -= a[5, 7] * b7
    b2 -= a[2, 8] * b8
    b5 -= a[5, 8] * b8
    b1 -= a[1, 3] * b3
    b0 -= a[0, 3] * b3
    b5 -= a[5, 3] * b3
    b2 -= a[2, 4] * b4
    b0 -= a[0, 4] * b4
    b5 -= a[5, 4] * b4
    b0 -= a[0, 1] * b1
    b5 -= a[5, 1] * b1
    b0 -= a[0, 2] * b2
    b5 -= a[5, 2] * b2
    b5 -= a[5, 0] * b0
    b5 *= a[5, 5]
    b0 = (b0 - a[0, 5] * b5) * a[0, 0]
    b2 = (b2 - a[2, 0] * b0 - a[2, 5] * b5) * a[2, 2]
    b1 = (b1 - a[1, 0] * b0 - a[1, 5] * b5) * a[1, 1]
    b4 = (b4 - a[4, 2] * b2 - a[4, 0] * b0 - a[4, 5] * b5) * a[4, 4]
    b3 = (b3 - a[3, 1] * b1 - a[3, 0] * b0 - a[3, 5] * b5) * a[3, 3]
    b8 = (b8 - a[8, 2] * b2 - a[8, 5] * b5) * a[8, 8]
    b7 = (b7 - a[7, 1] * b1 - a[7, 5] * b5) * a[7, 7]
    b6 = (b6 - a[6, 5] * b5) * a[6, 6]
    b[row, 0] = b0
    b[row, 1] = b1
    b[row, 2] = b2
    b[row, 3] = b3
    b[row, 4] = b4
    b[row, 5] = b5
    b[row, 6] = b6
    b[row, 7] = b7
    b[row, 8] = b8
