import numpy as np
import pytest
from scipy import stats

from divideropt.models import Domain
from divideropt.models.distributions import LogUniform, Normal, Triangular, Uniform
from divideropt.models.viscosity import THESIS_OIL

SHARES = np.linspace(0.001, 0.999, 199)

PEERS = {
    "uniform": (Uniform(2.5, 3.5), stats.uniform(2.5, 1.0)),
    "loguniform": (LogUniform(1e-3, 10.0), stats.loguniform(1e-3, 10.0)),
    "triangular": (Triangular(1.0, 1.5, 4.0), stats.triang(0.5 / 3.0, 1.0, 3.0)),
    "triangular, mode at an end": (Triangular(1.0, 4.0, 4.0), stats.triang(1.0, 1.0, 3.0)),
    "normal": (Normal(3.0, 0.1), stats.truncnorm(-3, 3, 3.0, 0.1)),
    "normal at its domain's end": (Normal(0.0, 2.0, Domain(0.0)), stats.truncnorm(0, 3, 0.0, 2.0)),
}


@pytest.mark.parametrize(("ours", "scipys"), PEERS.values(), ids=PEERS)
def test_quantiles_are_those_of_scipy_and_within_the_ends(ours, scipys):
    found = ours.quantiles(SHARES)
    np.testing.assert_allclose(found, scipys.ppf(SHARES), rtol=1e-9, atol=1e-12)
    assert (ours.lower, ours.upper) == pytest.approx(scipys.support(), rel=1e-12)
    ends = ours.quantiles(np.array([0.0, 1.0]))
    assert ends[0] >= ours.lower
    assert ends[1] <= ours.upper


def test_walthers_law_goes_through_its_points_and_is_a_line_between():
    oil = THESIS_OIL
    np.testing.assert_allclose(oil.viscosity(np.array([25.0, 60.0])), [66e-6, 15e-6], rtol=1e-12)
    temperatures = np.array([0.0, 30.0, 40.0, 100.0])
    lines = np.log10(np.log10(oil.viscosity(temperatures) * 1e6 + 0.7))
    slopes = np.diff(lines) / np.diff(np.log10(temperatures + 273.15))
    np.testing.assert_allclose(slopes, slopes[0], rtol=1e-9)
