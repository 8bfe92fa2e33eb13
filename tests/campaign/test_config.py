"""What a campaign may say: each mistake is found at its place, in a sentence."""

import pytest

from divideropt.campaign.load import parse_campaign
from divideropt.errors import FileMistakes
from divideropt.models.divider.parameters import PARAMETERS, parameter_set
from divideropt.models.divider.scenario import load_step
from divideropt.models.divider.tolerances import DEFAULT_MAX_STEPS, default_atol
from divideropt.ode import SolverSettings
from divideropt.strategies import NSGA2, ComplexMethod

BASE = """\
name: small
model:
  kind: divider
  scenario: {start: settled}
variables:
  spool_radius: [6 mm, 16 mm]
  fixed_drop_ratio: [0.3, 0.99]
objectives:
  steady_state_error: {goal: 0.5 %, weight: 3}
  source_pressure: {goal: 18 MPa}
constraints:
  stop_clearance: {min: 0 mm}
reference_point: {steady_state_error: 10 %, source_pressure: 30 MPa}
strategies:
  nsga2: {population: 40, generations: 12}
  complex: {points: 10, seeds: [1, 2]}
"""


def edited(*edits):
    text = BASE
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    return text


def found(text):
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(text)
    for mistake in caught.value.mistakes:
        for jargon in ("Input", "valid", "Value error", "pydantic", "None", "<"):
            assert jargon not in mistake.message
    return [(m.line, m.column, m.message) for m in caught.value.mistakes]


def test_defaults_are_those_of_the_design():
    campaign = parse_campaign(BASE)
    assert campaign.name == "small"
    assert campaign.variables == {"spool_radius": (6e-3, 16e-3), "fixed_drop_ratio": (0.3, 0.99)}
    assert campaign.objectives["source_pressure"].goal == 18e6
    assert campaign.objectives["source_pressure"].weight == 1.0
    assert (campaign.constraints["stop_clearance"].min, campaign.constraints["stop_clearance"].max) == (
        0.0,
        None,
    )
    assert campaign.reference_point == {"steady_state_error": 10.0, "source_pressure": 30e6}
    assert (campaign.parallel.workers, campaign.parallel.backend) == (2, "loky")
    assert (campaign.verification.sample, campaign.verification.share) == (50, 0.01)
    nsga2, complex_method = campaign.strategies
    assert (nsga2.name, nsga2.options, nsga2.seeds) == ("nsga2", NSGA2(population=40, generations=12), (1,))
    assert (complex_method.options, complex_method.seeds) == (ComplexMethod(points=10), (1, 2))


def test_the_default_model_is_the_standard_test():
    model = parse_campaign(BASE).model
    scenario = model.scenario.to_scenario()
    assert (scenario.source_flow, scenario.spool_position, scenario.load_pressures) == (
        1e-3,
        0.5,
        (10e6, 10e6),
    )
    assert scenario.events == (load_step(1, 15e6),)
    assert (scenario.settled, scenario.end_time, scenario.accumulation_time) == (True, 1.0, 0.2)
    assert model.solver.to_settings() == SolverSettings("rosenbrock", 1e-4, default_atol(1e-4), DEFAULT_MAX_STEPS)
    assert model.formulation == "conservative"
    assert model.base_parameters() == parameter_set("thesis_base")


def test_a_cold_start():
    text = edited(("{start: settled}", "{start: cold, step: {load: 2, to: 12 MPa, at: 50 ms}, end: 0.6 s}"))
    scenario = parse_campaign(text).model.scenario.to_scenario()
    assert (scenario.settled, scenario.end_time) == (False, 0.6)
    assert scenario.events == (load_step(2, 12e6, at=0.05),)
    assert parse_campaign(text.replace(", end: 0.6 s", "")).model.scenario.end == 1.0


def test_set_values_go_over_the_parameter_set():
    text = edited(("kind: divider", "kind: divider\n  parameters: thesis_prototype\n  set: {density: 870 kg/m^3}"))
    base = parse_campaign(text).model.base_parameters()
    assert list(base) == list(PARAMETERS)
    assert base == parameter_set("thesis_prototype") | {"density": 870.0}


@pytest.mark.parametrize(
    ("atol", "changed"),
    [
        ("{x: 1 um, PL1: 1 bar}", {6: 1e-6, 7: 1e5}),
        (
            "[1 Pa, 1 Pa, 1 Pa, 1 Pa, 1 Pa, 1 mm/s, 1 nm, 1 Pa, 1 Pa]",
            dict(enumerate([1.0] * 5 + [1e-3, 1e-9, 1.0, 1.0])),
        ),
    ],
)
def test_absolute_tolerances_by_state_or_as_a_list(atol, changed):
    text = edited(("kind: divider", f"kind: divider\n  solver: {{method: Radau, rtol: 1e-6, atol: {atol}}}"))
    expected = list(default_atol(1e-6))
    for i, value in changed.items():
        expected[i] = value
    assert parse_campaign(text).model.solver.atol == pytest.approx(expected, rel=1e-15)


def test_an_objective_may_do_without_a_goal_where_nothing_weighs_it():
    text = edited(
        ("source_pressure: {goal: 18 MPa}", "source_pressure:"),
        ("  complex: {points: 10, seeds: [1, 2]}\n", ""),
    )
    assert parse_campaign(text).objectives["source_pressure"].goal is None


def test_sections_are_frozen():
    campaign = parse_campaign(BASE)
    with pytest.raises(ValueError, match="frozen"):
        campaign.name = "other"


MISTAKES = {
    # name
    "a path as name": (("name: small", "name: ../x"), [(1, 7, "folder of results")]),
    "a number as name": (("name: small", "name: 12"), [(1, 7, "quotes")]),
    "no name": (("name: small\n", ""), [(1, 1, "'name' is missing; add it")]),
    "a long name": (("name: small", "name: " + "a" * 65), [(1, 7, "1 to 64")]),
    "unknown key": (("name: small", "name: small\nobjectivs: 1"), [(2, 1, "did you mean objectives?")]),
    # model
    "unknown model": (("kind: divider", "kind: dividr"), [(3, 9, "did you mean divider?")]),
    "no kind": (("  kind: divider\n", ""), [(2, 1, "'kind' is missing")]),
    "model is no mapping": (
        ("  kind: divider\n  scenario: {start: settled}\n", "  divider\n"),
        [(3, 3, "mapping")],
    ),
    "unknown formulation": (
        ("kind: divider", "kind: divider\n  formulation: listin"),
        [(4, 16, "did you mean listing")],
    ),
    "unknown parameter set": (
        ("kind: divider", "kind: divider\n  parameters: x"),
        [(4, 15, "thesis_base, ")],
    ),
    "unknown parameter": (
        ("kind: divider", "kind: divider\n  set: {qqq: 1 mm}"),
        [(4, 9, "divideropt schema")],
    ),
    "parameter out of domain": (
        ("kind: divider", "kind: divider\n  set: {density: 0 kg/m^3}"),
        [(4, 18, "above 0 kg/m^3")],
    ),
    "set and variable": (
        ("kind: divider", "kind: divider\n  set: {spool_radius: 8 mm}"),
        [(7, 3, "cannot both vary and be fixed")],
    ),
    "unknown start": (("start: settled", "start: warm"), [(4, 21, "use one of settled, cold")]),
    "cold without time": (("start: settled", "start: cold"), [(4, 3, "add `at: 50 ms`")]),
    "settled with time": (("start: settled", "step: {at: 1 s}"), [(4, 21, "delete `at`")]),
    "settled with end": (("start: settled", "end: 1 s"), [(4, 14, "`horizon`")]),
    "cold with horizon": (
        ("start: settled", "start: cold, step: {at: 1 ms}, horizon: 1 s"),
        [(4, 45, "`end`")],
    ),
    "end before step": (
        ("start: settled", "start: cold, step: {at: 50 ms}, end: 50 ms"),
        [(4, 51, "not after the step")],
    ),
    "step after the default end": (
        ("start: settled", "start: cold, step: {at: 2 s}"),
        [(4, 38, "ends at 1 s")],
    ),
    "spool at its end": (("start: settled", "spool_position: 1"), [(4, 30, "below 1")]),
    "one load pressure": (("start: settled", "load_pressures: [1 MPa]"), [(4, 14, "value 2 is missing")]),
    "three load pressures": (
        ("start: settled", "load_pressures: [1 MPa, 1 MPa, 1 MPa]"),
        [(4, 30, "at most 2")],
    ),
    "load pressure as a word": (("start: settled", "load_pressures: 1 MPa"), [(4, 30, "not a list")]),
    "third load": (("start: settled", "step: {load: 3}"), [(4, 27, "the most permitted is 2")]),
    "true load": (("start: settled", "step: {load: true}"), [(4, 27, "true is not a whole number")]),
    "unknown solver": (
        ("kind: divider", "kind: divider\n  solver: {method: euler}"),
        [(4, 20, "use one of rosenbrock, LSODA, BDF, Radau")],
    ),
    "loose tolerance": (("kind: divider", "kind: divider\n  solver: {rtol: 1}"), [(4, 18, "at most 0.1")]),
    "tolerance false": (
        ("kind: divider", "kind: divider\n  solver: {rtol: false}"),
        [(4, 18, "false is not")],
    ),
    "no steps": (
        ("kind: divider", "kind: divider\n  solver: {max_steps: 0}"),
        [(4, 23, "least permitted is 1")],
    ),
    "two tolerances": (
        ("kind: divider", "kind: divider\n  solver: {atol: [1 Pa, 1 Pa]}"),
        [(4, 18, "write 9")],
    ),
    "tolerance of a wrong unit": (
        ("kind: divider", f"kind: divider\n  solver: {{atol: [{', '.join(['1 Pa'] * 9)}]}}"),
        [(4, 49, "1 m/s"), (4, 55, "1 m")],
    ),
    "tolerance as a number": (
        ("kind: divider", "kind: divider\n  solver: {atol: 1}"),
        [(4, 18, "neither a list")],
    ),
    "unknown state": (("kind: divider", "kind: divider\n  solver: {atol: {y: 1 m}}"), [(4, 19, "xdot")]),
    # variables
    "bare number": (("[6 mm, 16 mm]", "[6, 16 mm]"), [(6, 18, "6 has no unit; write 6 m")]),
    "wrong unit": (("[6 mm, 16 mm]", "[6 mm, 16 kg]"), [(6, 24, "'kg'")]),
    "unknown unit": (("[6 mm, 16 mm]", "[6 mm, 16 furlnog]"), [(6, 24, "'furlnog' is not known")]),
    "hostile unit": (("[6 mm, 16 mm]", "[6^800000 m, 16 mm]"), [(6, 18, "6^800000")]),
    "hostile power": (("[6 mm, 16 mm]", "[6 m^800000, 16 mm]"), [(6, 18, "m^800000")]),
    "decibels": (("[6 mm, 16 mm]", "[6 dB, 1 Np]"), [(6, 18, "'dB'"), (6, 24, "Np")]),
    "reversed bounds": (
        ("[6 mm, 16 mm]", "[16 mm, 6 mm]"),
        [(6, 17, "'16 mm' is not below the upper, '6 mm'")],
    ),
    "equal bounds": (("[6 mm, 16 mm]", "[6 mm, 0.6 cm]"), [(6, 17, "not below")]),
    "bound outside the domain": (
        ("[0.3, 0.99]", "[0, 1]"),
        [(7, 22, "above 0 and below 1"), (7, 25, "below 1")],
    ),
    "not finite": (
        ("[0.3, 0.99]", "[.nan, .inf]"),
        [(7, 22, ".nan is not a finite"), (7, 28, ".inf is not")],
    ),
    "not finite with a unit due": (
        ("[6 mm, 16 mm]", "[.nan, 1e999 m]"),
        [(6, 18, ".nan"), (6, 24, "finite")],
    ),
    "booleans": (("[0.3, 0.99]", "[false, true]"), [(7, 22, "false is not"), (7, 29, "true is not")]),
    "one bound": (("[6 mm, 16 mm]", "[6 mm]"), [(6, 17, "[lower, upper]")]),
    "no bounds": (("[6 mm, 16 mm]", ""), [(6, 3, "[lower, upper]")]),
    "choices": (("[6 mm, 16 mm]", "{choices: [6 mm, 8 mm]}"), [(6, 17, "reserved")]),
    "unknown variable": (("spool_radius:", "spool_raduis:"), [(6, 3, "did you mean spool_radius?")]),
    "no variables": (
        ("variables:\n  spool_radius: [6 mm, 16 mm]\n  fixed_drop_ratio: [0.3, 0.99]", "variables: {}"),
        [(5, 12, "at least 1")],
    ),
    # objectives and constraints
    "unknown objective": (
        ("  source_pressure: {goal", "  sorce_pressure: {goal"),
        [(10, 3, "did you mean source_pressure?")],
    ),
    "percent without its sign": (("goal: 0.5 %", "goal: 0.5"), [(9, 30, "0.5 has no unit; write 0.5 %")]),
    "zero goal": (("goal: 0.5 %", "goal: 0 %"), [(9, 30, "(3.24) divides by it")]),
    "zero weight": (("weight: 3", "weight: 0"), [(9, 45, "above 0")]),
    "word for a weight": (("weight: 3", "weight: heavy"), [(9, 45, "'heavy' is not a number")]),
    "missing goal": (("{goal: 18 MPa}", "{weight: 2}"), [(10, 3, "by which complex weighs")]),
    "no bound": (("{min: 0 mm}", "{}"), [(12, 19, "give `min`, `max` or both")]),
    "bounds exchanged": (("{min: 0 mm}", "{min: 2 mm, max: 1 mm}"), [(12, 19, "min is above max")]),
    "bound of a wrong unit": (("{min: 0 mm}", "{min: 0 MPa}"), [(12, 25, "'MPa'")]),
    "reference of another quantity": (
        ("point: {steady_state_error: 10 %, ", "point: {settling_time: 1 s, "),
        [(13, 1, "steady_state_error is lacking"), (13, 19, "not an objective")],
    ),
    # strategies
    "unknown strategy": (("complex:", "complx:"), [(16, 3, "did you mean complex?")]),
    "unknown option": (("points: 10", "point: 10"), [(16, 13, "did you mean points?")]),
    "fraction of points": (("points: 10", "points: 10.5"), [(16, 21, "10.5 is not a whole number")]),
    "quoted count": (("points: 10", "points: '10'"), [(16, 21, "'10' is not a whole number")]),
    "too few points": (("points: 10", "points: 1"), [(16, 21, "the least permitted is 3")]),
    "unknown aggregate": (("points: 10", "aggregate: sum"), [(16, 24, "'goal_attainment' or 'power_sum'")]),
    "seed twice": (("[1, 2]", "[1, 2, 1]"), [(16, 39, "a second time")]),
    "seeds of all sorts": (
        ("[1, 2]", "[-1, 1.5, true]"),
        [(16, 33, "least"), (16, 37, "1.5"), (16, 42, "true")],
    ),
    "no seeds": (("[1, 2]", "[]"), [(16, 32, "would not run")]),
    "seed without brackets": (("[1, 2]", "1"), [(16, 32, "in brackets")]),
    "strategy is no mapping": (("{points: 10, seeds: [1, 2]}", "10"), [(16, 12, "in braces")]),
    "no strategies": (
        (
            "strategies:\n  nsga2: {population: 40, generations: 12}\n  complex: {points: 10, seeds: [1, 2]}",
            "strategies: {}",
        ),
        [(14, 13, "at least one of nsga2")],
    ),
    # verification
    "a sample below nothing": (
        ("strategies:", "verification: {sample: -1}\nstrategies:"),
        [(14, 24, "-1 is too small; the least permitted is 0")],
    ),
    "a tolerance without its unit": (
        ("strategies:", "verification: {tolerance: 1}\nstrategies:"),
        [(14, 27, "1 has no unit; write 1 %")],
    ),
    "a tolerance of nothing": (
        ("strategies:", "verification: {tolerance: 0 %}\nstrategies:"),
        [(14, 27, "out of range; what is permitted is above 0 %")],
    ),
    # parallel
    "too many workers": (
        ("strategies:", "parallel: {workers: 257}\nstrategies:"),
        [(14, 21, "most permitted is 256")],
    ),
    "unknown backend": (
        ("strategies:", "parallel: {backend: threads}\nstrategies:"),
        [(14, 21, "loky, sequential")],
    ),
    "dask without its scheduler": (
        ("strategies:", "parallel: {backend: dask}\nstrategies:"),
        [(14, 11, "add scheduler: tcp://host:port")],
    ),
    "scheduler without dask": (
        ("strategies:", "parallel: {scheduler: 'tcp://a:1'}\nstrategies:"),
        [(14, 11, "a scheduler is for backend dask, not loky")],
    ),
    "scheduler that is no address": (
        ("strategies:", "parallel: {backend: dask, scheduler: node1}\nstrategies:"),
        [(14, 38, "'node1' is not the address of a scheduler; write tcp://host:port")],
    ),
    "parallel is no mapping": (("strategies:", "parallel: 2\nstrategies:"), [(14, 11, "2 is not a mapping")]),
}


@pytest.mark.parametrize(("edit", "expected"), MISTAKES.values(), ids=MISTAKES)
def test_each_mistake_is_found_at_its_place(edit, expected):
    reported = found(edited(edit))
    assert [(line, column) for line, column, _ in reported] == [(line, column) for line, column, _ in expected]
    for (_, _, message), (_, _, part) in zip(reported, expected, strict=True):
        assert part in message


def test_a_message_names_its_key():
    assert found(edited(("[6 mm, 16 mm]", "[6, 16 mm]")))[0][2].startswith("variables.spool_radius[0]: 6 has no unit")


def test_all_mistakes_are_reported_at_once_in_the_order_of_lines():
    reported = found(
        edited(
            ("name: small", "name: a/b\nname: c"),
            ("kind: divider", "kind: divider\n  set: {density: 870, spool_radius: 8 mm}"),
            ("start: settled", "start: cold, horizon: 1"),
            ("[0.3, 0.99]", "[0.9, 0.3]"),
            ("{goal: 18 MPa}", ""),
            ("stop_clearance", "stop_clearence"),
            ("population: 40", "population: *p"),
            ("points: 10", "points: 2, speed: 1"),
        )
    )
    assert [(line, column) for line, column, _ in reported] == [
        (1, 7),  # the name
        (2, 1),  # again
        (5, 18),  # no unit
        (6, 3),  # a cold start without a time
        (6, 27),  # and with a horizon, which
        (6, 36),  # has no unit
        (8, 3),  # set already
        (9, 21),  # reversed
        (12, 3),  # no goal
        (14, 3),  # unknown
        (17, 23),  # an alias
        (18, 21),  # too few
        (18, 24),  # unknown
    ]
