import numpy as np
import pytest

from divideropt.models.base import Outcome, Verdict
from divideropt.models.divider import QUANTITIES, Divider, Scenario, load_step, solver_settings
from divideropt.models.divider.quantities import GEOMETRIC
from divideropt.models.divider.scenarios import BASE, Scenarios, Worst, failed_scenario, outcomes_by_scenario

OTHER = Scenario(load_pressures=(5e6, 5e6), events=(load_step(2, 9e6),))
MODELS = {BASE: Divider(), "low": Divider(scenario=OTHER)}


def evaluated(model, *parameters):
    rows, verdicts = model.evaluate(np.array([list(p.values()) for p in parameters]))
    return [dict(zip(model.quantities, row.tolist(), strict=True)) for row in rows], verdicts


def test_every_scenario_has_its_columns(design) -> None:
    model = Scenarios(MODELS)
    assert list(model.quantities) == [*QUANTITIES, *(f"low.{q}" for q in QUANTITIES if q not in GEOMETRIC)]
    (found,), (verdict,) = evaluated(model, design())
    (base,), _ = evaluated(MODELS[BASE], design())
    (low,), _ = evaluated(MODELS["low"], design())
    assert verdict.ok
    for name in QUANTITIES:
        assert found[name] == base[name]
        if name not in GEOMETRIC:
            assert found[f"low.{name}"] == low[name]


def test_the_worst_is_the_largest_and_a_signed_one_keeps_its_sign(design) -> None:
    wanted = (
        Worst("steady_state_error", (BASE, "low")),
        Worst("dynamic_error", ("low", BASE)),
        Worst("stability_margin", (BASE, "low"), least=True),
        Worst("settling_time", ("low",)),
    )
    model = Scenarios(MODELS, wanted)
    rows, _ = evaluated(model, design(), design("thesis_prototype"))
    for q in rows:
        assert q["worst.steady_state_error"] == max(q["steady_state_error"], q["low.steady_state_error"])
        both = [q["dynamic_error"], q["low.dynamic_error"]]
        assert q["worst.dynamic_error"] == max(both, key=abs)
        assert q["least.stability_margin"] == min(q["stability_margin"], q["low.stability_margin"])
        assert q["worst.settling_time"] == q["low.settling_time"]
    assert model.quantities["worst.dynamic_error"].signed


def test_mirrored_scenarios_do_not_dice_for_the_sign(box_designs) -> None:
    mirrored = {BASE: Divider(), "other_load": Divider(scenario=Scenario(events=(load_step(2, 15e6),)))}
    over = (BASE, "other_load")
    model = Scenarios(mirrored, (Worst("load_regulation", over), Worst("dynamic_error", over)))
    rows, verdicts = evaluated(model, *box_designs(40))
    sound = [q for q, verdict in zip(rows, verdicts, strict=True) if verdict.ok]
    assert len(sound) > 20
    larger = 0
    for q in sound:
        both = [q["load_regulation"], q["other_load.load_regulation"]]
        assert both[0] == pytest.approx(-both[1], rel=1e-6)
        larger += abs(both[1]) > abs(both[0])
        assert q["worst.load_regulation"] * both[0] > 0  # the first one's sign
        assert abs(q["worst.load_regulation"]) == max(map(abs, both))
        assert abs(q["worst.dynamic_error"]) == max(abs(q["dynamic_error"]), abs(q["other_load.dynamic_error"]))
    assert larger > 0  # by a rounding


def test_a_scenario_that_fails_is_named_and_its_worst_is_not_known(design) -> None:
    short = Divider(scenario=Scenario(events=(load_step(1, 15e6),), end_time=0.01))
    model = Scenarios({**MODELS, "short": short}, (Worst("settling_time", (BASE, "short")),))
    (q,), (verdict,) = evaluated(model, design())
    assert verdict.outcome is Outcome.UNSETTLED
    assert verdict.text.startswith("in scenario short: at the end a load flow")
    assert np.isnan(q["worst.settling_time"])
    assert np.isfinite(q["settling_time"])
    assert outcomes_by_scenario(verdict, list(model.models)) == (Outcome.OK, Outcome.OK, Outcome.UNSETTLED)


def test_what_is_known_of_each_scenario_follows_from_the_verdict() -> None:
    scenarios = [BASE, "low", "short"]
    assert outcomes_by_scenario(Verdict(Outcome.OK), scenarios) == (Outcome.OK,) * 3
    own = Verdict(Outcome.AT_STOP, "the spool rests on its stop")
    assert outcomes_by_scenario(own, scenarios) == (Outcome.AT_STOP, None, None)
    low = Verdict(Outcome.UNSTABLE, "in scenario low: an equilibrium is unstable")
    assert outcomes_by_scenario(low, scenarios) == (Outcome.OK, Outcome.UNSTABLE, None)
    sampled = Verdict(Outcome.UNSTABLE, "in 3 of 64 samples: in scenario low: an equilibrium is unstable")
    assert outcomes_by_scenario(sampled, scenarios) == (Outcome.OK,) * 3
    assert [failed_scenario(verdict) for verdict in (own, low, sampled)] == [None, "low", "low"]
    broken = Verdict(Outcome.CRASHED, "in 1 of 64 samples: the model broke down")
    assert outcomes_by_scenario(broken, scenarios) == (Outcome.OK,) * 3
    assert outcomes_by_scenario(Verdict(Outcome.CRASHED, "the model broke down"), scenarios) == (Outcome.CRASHED,) * 3


def test_the_reference_has_the_same_columns(design) -> None:
    model = Scenarios(MODELS, (Worst("dynamic_error", (BASE, "low")),))
    reference = model.reference()
    assert list(reference.quantities) == list(model.quantities)
    (fast,), _ = evaluated(model, design())
    (exact,), _ = evaluated(reference, design())
    for name in ("worst.dynamic_error", "low.settling_time", "source_pressure"):
        assert fast[name] == pytest.approx(exact[name], rel=2e-3), name
        assert fast["settling_time"] != exact["settling_time"]


def test_a_scenario_sets_parameters_whatever_the_design_says(design) -> None:
    changes = {"low": {"kinematic_viscosity": 15e-6, "coulomb_friction": 2.0}}
    model = Scenarios(MODELS, (Worst("dynamic_error", (BASE, "low")),), changes)
    parameters = [design(), design("thesis_prototype")]
    given = np.array([list(p.values()) for p in parameters])
    asked = given.copy()
    rows, _ = evaluated(model, *parameters)
    expected, _ = evaluated(MODELS["low"], *({**p, **changes["low"]} for p in parameters))
    others, _ = evaluated(MODELS["low"], *parameters)
    base, _ = evaluated(MODELS[BASE], *parameters)
    for q, low, other, plain in zip(rows, expected, others, base, strict=True):
        assert q["low.dynamic_error"] == low["dynamic_error"] != other["dynamic_error"]
        assert q["dynamic_error"] == plain["dynamic_error"]
        assert q["worst.dynamic_error"] == max(low["dynamic_error"], plain["dynamic_error"], key=abs)
    model.evaluate(asked)
    np.testing.assert_array_equal(asked, given)  # the caller's designs are as they were
    shared = model.on_threads(2)
    assert shared is not None
    assert shared.changes == changes
    reference, _ = evaluated(model.reference(), parameters[0])
    assert reference[0]["low.dynamic_error"] == pytest.approx(expected[0]["dynamic_error"], rel=2e-3)


def test_threads_share_the_batches_of_every_scenario(box_designs) -> None:
    designs = np.array([list(p.values()) for p in box_designs(12)])
    models = {
        BASE: Divider(),
        "cold": Divider(scenario=Scenario(settled=False, events=(load_step(1, 15e6, at=0.05),))),
    }
    alone = Scenarios(models)
    shared = alone.on_threads(2)
    assert shared is not None
    assert all(model.threads == 2 for model in shared.models.values())
    np.testing.assert_array_equal(alone.evaluate(designs)[0], shared.evaluate(designs)[0])


def test_a_solver_that_holds_the_interpreter_is_not_threaded() -> None:
    assert Divider(settings=solver_settings("LSODA")).on_threads(2) is None
    assert Scenarios({BASE: Divider(), "other": Divider(settings=solver_settings("BDF"))}).on_threads(2) is None
