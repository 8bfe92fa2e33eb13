"""A model that breaks down on one design costs that design only."""

import numpy as np

from divideropt.models import Outcome
from divideropt.models.divider import PARAMETERS, Divider, parameter_set
from divideropt.problem import simulate
from toy_model import Toy


class Fragile(Toy):
    def evaluate(self, designs):
        if (designs[:, 0] > 0.9).any():
            raise RuntimeError("x1 is too much for me")
        return super().evaluate(designs)


def test_only_the_guilty_design_is_blamed():
    model = Fragile()
    fixed = {name: p.default for name, p in model.parameters.items()}
    designs = np.array([[0.2, 0.5], [0.95, 0.5], [0.4, 0.01]])
    quantities, verdicts = simulate(model, fixed, ["x1", "x2"], designs)
    assert [v.outcome for v in verdicts] == [Outcome.OK, Outcome.CRASHED, Outcome.UNSETTLED]
    assert "RuntimeError: x1 is too much for me" in verdicts[1].text
    assert np.isnan(quantities[1]).all()
    honest, _ = Toy().evaluate(np.array([[0.2, 0.5, 0.5]]))
    assert np.array_equal(quantities[0], honest[0])


def test_absurd_dimensions_are_a_row_like_any_other():
    assert "radial_clearance" in PARAMETERS
    designs = np.array([[1e200], [2.9e-6], [1e-120]])
    quantities, verdicts = simulate(Divider(), parameter_set("thesis_base"), ["radial_clearance"], designs)
    assert verdicts[1].ok
    assert not verdicts[0].ok
    assert not verdicts[2].ok
    assert np.isfinite(quantities[1]).all()
