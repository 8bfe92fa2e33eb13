import numpy as np
import pytest

from divideropt.models.base import Outcome
from divideropt.models.divider import FORMULATIONS, Divider, solver_settings
from divideropt.models.divider.error_budget import CAUSES, error_budget

TIGHT = solver_settings("LSODA", 1e-8, max_steps=100_000)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("friction", [0.0, 10.0])
def test_the_budget_adds_up(measured, design, formulation, friction) -> None:
    model, p = Divider(formulation, settings=TIGHT), design(coulomb_friction=friction)
    budget = error_budget(model, p)
    assert budget.total == measured(model, p)["cumulative_steady_error_percent"]
    assert set(budget.shares) == set(CAUSES)
    assert sum(budget.shares.values()) + budget.rest + budget.interaction == pytest.approx(budget.total, abs=1e-12)
    assert budget.verdict.outcome is Outcome.OK


def test_without_any_cause_a_tight_valve_divides_ideally(design) -> None:
    # Section 2.2: no leakage, no flow force, no friction, no pilot flow: (2.6) whatever the loads are.
    assert abs(error_budget(Divider(settings=TIGHT), design(radial_clearance=1e-7)).rest) < 1e-9


def test_switching_off_is_setting_to_zero(measured, design) -> None:
    model = Divider(settings=TIGHT)
    budget = error_budget(model, design(coulomb_friction=10.0))
    thin = measured(model, design(coulomb_friction=10.0, rim_thickness=0.0))
    assert budget.without["flow_force"] == thin["cumulative_steady_error_percent"]
    free = measured(model, design())
    assert budget.without["friction"] == free["cumulative_steady_error_percent"]
    sealed = measured(model, design(coulomb_friction=10.0, seal_length=1e9))
    assert budget.without["end_seal_leakage"] == pytest.approx(sealed["cumulative_steady_error_percent"], rel=1e-6)


def test_the_text_has_no_end_seals(design) -> None:
    assert error_budget(Divider("text", settings=TIGHT), design()).shares["end_seal_leakage"] == 0.0


def test_kwans_estimate(design) -> None:
    # sserr_th of C.2, written out; C.2 forgets that there are two holes.
    model = Divider(settings=TIGHT)
    response = model.respond(design())
    ps, pa1, pa2, _, _, _, x, pl1, pl2 = response.phases[-1].rest.state
    g = response.geometry
    rv, d0 = g.port_radius, g.port_offset
    arim1 = 2 * 0.8e-3 * 2 * np.sqrt(rv * rv - (d0 - x) ** 2)
    arim2 = 2 * 0.8e-3 * 2 * np.sqrt(rv * rv - (d0 + x) ** 2)
    force = arim1 / 2 * (pl1 - pa1) - arim2 / 2 * (pl2 - pa2)
    estimate = 100 * force / (2 * (ps - (pa1 + pa2) / 2) * g.end_area)
    budget = error_budget(model, design())
    assert budget.kwan == pytest.approx(estimate, rel=1e-12)


def test_kwans_estimate_holds_without_pilot_flow(design) -> None:
    # A groove of 0.3 mm passes a hundredth of what one of 1 mm does, and the flow force is all there is.
    for rim in (0.8e-3, 0.08e-3):
        budget = error_budget(Divider(settings=TIGHT), design(groove_width=0.3e-3, rim_thickness=rim))
        assert budget.kwan == pytest.approx(budget.total, rel=0.01)


def test_a_design_that_fails_says_so(design) -> None:
    jammed = design(
        spool_radius=11.71e-3,
        groove_width=1.62e-3,
        total_pressure_drop=7.789e6,
        fixed_drop_ratio=0.83,
        centred_opening=0.854,
    )
    assert error_budget(Divider(settings=TIGHT), jammed).verdict.outcome is Outcome.AT_STOP
