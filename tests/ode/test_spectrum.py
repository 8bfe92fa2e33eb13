import numpy as np
import pytest

from divideropt.ode.spectrum import largest_real_part


@pytest.mark.parametrize("n", [1, 2, 3, 4, 9, 20])
def test_against_lapack(n) -> None:
    random = np.random.default_rng(n)
    for _ in range(200):
        matrix = random.normal(size=(n, n))
        expected = np.linalg.eigvals(matrix).real.max()
        assert largest_real_part(matrix.copy()) == pytest.approx(expected, rel=1e-10, abs=1e-12)


def test_known_spectra() -> None:
    turn = np.array([[0.0, -2.0], [2.0, 0.0]])
    assert largest_real_part(turn) == 0.0  # ±2i
    permutation = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # the shifts alone would stand still
    assert largest_real_part(permutation) == pytest.approx(1.0, rel=1e-12)
    assert largest_real_part(np.diag([-3.0, -1e-9, -7.0])) == -1e-9
    assert largest_real_part(np.zeros((9, 9))) == 0.0


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_what_is_no_number_has_no_spectrum(wrong) -> None:
    matrix = np.eye(4)
    matrix[2, 1] = wrong
    assert np.isnan(largest_real_part(matrix))
