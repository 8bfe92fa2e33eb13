from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.models.divider import elimination_kernels, pattern
from divideropt.models.divider.elimination_kernels import factorise_shifted, solve_shifted
from divideropt.models.divider.kernels import jacobian
from divideropt.ode.elimination import elimination_source

PLACES = [(row, column) for row, columns in pattern.PATTERN.items() for column in columns]


def test_the_module_is_made_from_the_pattern() -> None:
    made = elimination_source(pattern.PATTERN, pattern.ORDER)
    assert Path(elimination_kernels.__file__).read_text(encoding="utf-8") == made


@given(st.integers(0, 10**6), st.floats(1.0, 1e6))
def test_against_a_dense_solver(seed, shift) -> None:
    random = np.random.default_rng(seed)
    jac, factors = np.full((9, 9), np.nan), np.zeros((9, 9))  # what is outside the pattern is not read
    jac[6, 6] = 0.0
    for row, column in PLACES:
        jac[row, column] = random.normal() - 10.0 * (row == column)
    right = random.normal(size=(3, 9))
    full = shift * np.eye(9) - np.nan_to_num(jac)
    expected = np.linalg.solve(full, right[1])
    others = right[[0, 2]].copy()
    factorise_shifted(jac, shift, factors)
    solve_shifted(factors, right, 1)
    np.testing.assert_allclose(right[1], expected, rtol=1e-9, atol=1e-13)
    np.testing.assert_array_equal(right[[0, 2]], others)


@pytest.mark.parametrize("formulation", ["conservative", "text", "listing"])
def test_no_jacobian_has_an_entry_outside_the_pattern(design, record, formulation) -> None:
    outside = np.ones((9, 9), dtype=bool)
    outside[tuple(np.transpose(PLACES))] = False
    random = np.random.default_rng(0)
    for _ in range(50):
        y = random.uniform(0.0, 2e7, 9)
        y[5:7] = random.normal(size=2) * [1e-2, 1e-4]
        full = jacobian(0.0, y, record(design(coulomb_friction=5.0), formulation, groove_loss=True))
        assert not full[outside].any()
