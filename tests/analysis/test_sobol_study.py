"""Studies as a user has them: every quantity, failures told, nothing undefined drawn as a number."""

import dataclasses

import numpy as np
import pytest
from SALib.analyze.morris import analyze
from SALib.sample import morris

from divideropt.analysis.elementary import effects_of, summary_of, ways_of
from divideropt.analysis.failures import PARTS, failures_of
from divideropt.analysis.morris import morris_study
from divideropt.analysis.sobol import sobol_study
from divideropt.analysis.treatments import Treated, Treatment
from divideropt.problem import Constraint, DesignSpace, Evaluations, Objective, Problem, Variable
from sensitivity_models import Failing, Ishigami, sample


def problem_of(model, objective, constraint=None):
    variables = [Variable(p, p.domain.lower, p.domain.upper) for p in model.parameters.values()]
    return Problem(
        model=model,
        fixed={n: p.default for n, p in model.parameters.items()},
        space=DesignSpace(tuple(variables)),
        objectives=(Objective(model.quantities[objective], weight=2.0),),
        constraints=() if constraint is None else (Constraint(model.quantities[constraint], minimum=1.0),),
    )


@pytest.fixture(scope="module")
def failing():
    model = Failing()
    problem = problem_of(model, "lost", "kept")
    evaluations = problem.simulate(sample(model, 1024))
    return problem, evaluations, sobol_study(evaluations, problem)


def test_the_failed_are_counted_where_they_are(failing):
    _, evaluations, study = failing
    failures = study.failures
    x1 = evaluations.designs[:, 0]
    assert failures.designs == 1024 * 8
    assert dict(failures.outcomes) == {"unsettled": int((x1 < 0.25).sum())}
    assert failures.share == (x1 < 0.25).mean() == 0.25
    third = x1[(x1 >= 0.2) & (x1 < 0.3)]
    expected = [1.0, 1.0, (third < 0.25).mean(), *[0.0] * 7]
    np.testing.assert_array_equal(failures.shares[0], expected)
    assert failures.counts.sum(axis=1).tolist() == [8192] * 3
    assert (np.abs(failures.shares[1:] - 0.25) < 0.03).all()
    assert study.failed_blocks == (x1 < 0.25).reshape(1024, -1).any(axis=1).sum()


def test_a_part_of_a_range_without_designs_has_no_share():
    problem = problem_of(Failing(), "kept")
    failures = failures_of(problem.simulate(np.full((3, 3), 0.05)), problem.space)
    assert failures.shares[:, 0].tolist() == [1.0] * 3
    assert np.isnan(failures.shares[:, 1:]).all()
    assert failures.shares.shape == (3, PARTS)


def totals(study, quantity, treatment):
    table = study.indices
    table = table[(table["samples"] == study.blocks) & (table["kind"] == "ST")]
    return table[(table["quantity"] == quantity) & (table["treatment"] == treatment)].set_index("variable")


def test_the_outcome_hangs_on_the_variable_that_makes_it(failing):
    _, _, study = failing
    found = totals(study, "outcome", "all")["value"]
    assert found["x1"] == pytest.approx(1.0, abs=0.01)
    assert found[["x2", "x3"]].tolist() == [0.0, 0.0]


def test_working_designs_have_the_indices_of_their_own_box(failing):
    """Among them x1 is uniform from 0.25 on: its variance is 9/16 of the others'."""
    _, _, study = failing
    variances = np.array([9 / 16, 1.0, 1.0])
    for quantity in ("lost", "kept"):
        found = totals(study, quantity, "working")
        exact = variances / variances.sum()
        assert ((found["low"] <= exact) & (exact <= found["high"])).all()
        assert found["used"].tolist() == pytest.approx([9 / 16, 3 / 4, 3 / 4], abs=0.02)


def test_simulated_values_of_failed_designs_count_in_their_own_treatment(failing):
    _, _, study = failing
    found = totals(study, "kept", "simulated")
    assert ((found["low"] <= 1 / 3) & (found["high"] >= 1 / 3)).all()
    assert (found["used"] == 1.0).all()


def test_what_is_not_defined_in_failed_designs_says_so(failing):
    _, _, study = failing
    reasons = {(u.quantity, str(u.treatment)): u.reason for u in study.undefined}
    assert "blocks, less than 95 %" in reasons["lost", "simulated"]
    assert totals(study, "lost", "simulated").empty


def test_the_worst_value_is_filled_in_on_the_bad_side(failing):
    """The objective's is its largest, the constrained magnitude's, bounded from below, its smallest."""
    _, evaluations, study = failing
    x1, total = evaluations.designs[:, 0], evaluations.designs.sum(axis=1)
    for quantity, worst in (("lost", total[x1 >= 0.25].max()), ("kept", total[x1 >= 0.25].min())):
        filled = np.where(x1 < 0.25, worst, total).reshape(1024, 8)
        a, b, changed = filled[:, 0], filled[:, -1], filled[:, 2]  # x2 from B
        expected = ((a - changed) ** 2).mean() / 2 / np.concatenate([a, b]).var()
        assert totals(study, quantity, "worst")["value"]["x2"] == pytest.approx(expected, rel=1e-12)


def test_no_number_of_the_table_is_undefined(failing):
    table = failing[2].indices
    assert np.isfinite(table[["value", "low", "high", "used"]].to_numpy()).all()
    assert (table["low"] <= table["value"]).all()


def test_indices_of_the_samples_beginnings_are_there(failing):
    table = failing[2].indices
    assert sorted(set(table["samples"])) == [32, 64, 128, 256, 512, 1024]
    assert set(table.loc[table["samples"] < 1024, "kind"]) == {"S1", "ST"}


def test_a_beginning_is_analysed_as_a_sample_of_its_own():
    problem = problem_of(Ishigami(), "f")
    designs = sample(Ishigami(), 256)
    study = sobol_study(problem.simulate(designs), problem)
    alone = sobol_study(problem.simulate(sample(Ishigami(), 128, second_order=False)), problem)
    table = study.indices[study.indices["samples"] == 128].reset_index(drop=True)
    np.testing.assert_array_equal(table["value"], alone.indices[alone.indices["samples"] == 128]["value"])


def test_a_constant_has_no_indices():
    problem = problem_of(Ishigami(), "f")
    study = sobol_study(problem.simulate(sample(Ishigami(), 64)), problem)
    assert {u.quantity: u.reason for u in study.undefined} == {
        "constant": "it is constant",
        "outcome": "it is constant",
    }
    assert set(study.indices["quantity"]) == {"f"}
    assert set(study.indices["treatment"]) == {"all"}


def test_an_unfinished_block_is_left_out():
    problem = problem_of(Ishigami(), "f")
    evaluations = problem.simulate(sample(Ishigami(), 64))
    study = sobol_study(evaluations.part(0, 40 * 8 + 3), problem)
    assert (study.blocks, study.left_over) == (40, 3)


def test_a_sample_where_all_fail_has_no_indices():
    model = Failing(below=2.0)
    problem = problem_of(model, "lost")
    study = sobol_study(problem.simulate(sample(model, 64)), problem)
    assert study.failures.share == 1.0
    assert {u.quantity for u in study.undefined} >= {"lost", "outcome"}
    assert set(study.indices["treatment"]) <= {"simulated"}


def trajectories(model, count, levels=8):
    d = len(model.parameters)
    unit = morris.sample(
        {"num_vars": d, "names": list(model.parameters), "bounds": [[0.0, 1.0]] * d}, count, levels, seed=1
    )
    lower, upper = np.array([(p.domain.lower, p.domain.upper) for p in model.parameters.values()]).T
    return lower + (upper - lower) * unit


def of(study, quantity, kind, treatment="all"):
    table = study.effects
    chosen = (table["quantity"] == quantity) & (table["kind"] == kind) & (table["treatment"] == treatment)
    return table[chosen].set_index("variable")


def test_elementary_effects_are_those_of_salib():
    problem = problem_of(Ishigami(), "f")
    evaluations = problem.simulate(trajectories(Ishigami(), 50))
    study = morris_study(evaluations, problem)
    description = {"num_vars": 3, "names": ["x1", "x2", "x3"], "bounds": [[-np.pi, np.pi]] * 3}
    theirs = analyze(
        description, evaluations.designs, evaluations.quantities[:, 0], num_levels=8, num_resamples=1000, seed=1
    )
    for kind in ("mu", "mu_star", "sigma"):
        np.testing.assert_allclose(of(study, "f", kind)["value"], theirs[kind], rtol=1e-12)
    widths = of(study, "f", "mu_star")
    np.testing.assert_allclose((widths["high"] - widths["low"]) / 2, theirs["mu_star_conf"], rtol=1e-12)
    item = Treated(Treatment.ALL, evaluations.quantities[:, 0], np.full(len(evaluations), True))
    effects = effects_of(item, ways_of(evaluations.designs, problem.space))
    ours = np.array([summary_of(column) for column in effects.T])
    np.testing.assert_allclose(ours[:, 0], theirs["mu"], rtol=1e-9)
    np.testing.assert_allclose(ours[:, 1], theirs["mu_star"], rtol=1e-9)
    np.testing.assert_allclose(ours[:, 2], theirs["sigma"], rtol=1e-9)


@pytest.mark.parametrize("exponent", [900, -900])
def test_effects_of_numbers_without_squares_are_no_zeros(exponent):
    problem = problem_of(Ishigami(), "f")
    evaluations = problem.simulate(trajectories(Ishigami(), 20))
    plain = of(morris_study(evaluations, problem), "f", "mu_star")
    scaled = dataclasses.replace(evaluations, quantities=evaluations.quantities * 2.0**exponent)
    found = of(morris_study(scaled, problem), "f", "mu_star")
    np.testing.assert_array_equal(found["value"], plain["value"] * 2.0**exponent)
    np.testing.assert_array_equal(found["high"], plain["high"] * 2.0**exponent)


def test_a_step_from_or_to_a_failed_design_gives_no_effect():
    """x1 has eight levels, of which two fail, and steps of 4/7 that join failed ones to working ones only."""
    model = Failing()
    problem = problem_of(model, "lost")
    evaluations = problem.simulate(trajectories(model, 200))
    study = morris_study(evaluations, problem)
    found = of(study, "lost", "mu_star", "working")
    np.testing.assert_allclose(found["value"], 1.0, rtol=1e-9)
    x1 = evaluations.designs[:, 0].reshape(200, 4)
    at_rest = np.isclose(np.diff(x1, axis=1), 0.0)
    works = (x1[:, :-1] >= 0.25) & (x1[:, 1:] >= 0.25)
    assert found["used"]["x1"] == works[~at_rest].mean()
    assert found["used"][["x2", "x3"]].mean() == pytest.approx(works[at_rest].mean(), rel=1e-12)
    np.testing.assert_allclose(of(study, "kept", "mu", "simulated")["value"], 1.0, rtol=1e-9)


def test_what_is_no_trajectory_is_refused():
    problem = problem_of(Ishigami(), "f")
    with pytest.raises(ValueError, match="no Morris sample"):
        morris_study(problem.simulate(np.random.default_rng(1).random((8, 3))), problem)
    evaluations = problem.simulate(trajectories(Ishigami(), 4))
    assert morris_study(evaluations.part(0, 9), problem).left_over == 1
    with pytest.raises(ValueError, match="no trajectory"):
        morris_study(Evaluations(np.empty((0, 3)), np.empty((0, 2)), []), problem)
