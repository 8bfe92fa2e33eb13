"""Scenarios in a campaign: events in a row, several scenarios, the worst of them."""

import re
import textwrap
from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

from divideropt.campaign.dump import campaign_schema, dump_campaign
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.plan import build_problem
from divideropt.errors import FileMistakes
from divideropt.models.divider import Divider, Event, load_step
from divideropt.models.divider.scenarios import Scenarios, Worst

EVENTS = """\
name: events
model:
  kind: divider
  groove_loss: entrance
  scenario:
    events:
      - {load: 1, to: 15 MPa}
      - {load_pressures: [12 MPa, 5 MPa], at: 0.3 s, over: 50 ms}
      - {spool_position: 0.6, source_flow: 50 L/min, at: 600 ms}
    horizon: 0.5 s
variables:
  spool_radius: [6 mm, 16 mm]
objectives:
  steady_state_error:
  event_1.dynamic_error: {goal: 0.5 mL}
constraints:
  event_2.settling_time: {max: 0.2 s}
strategies:
  nsga2: {population: 8, generations: 2}
"""

WORST = """\
name: worst
model:
  kind: divider
  scenarios:
    low: {load_pressures: [2 MPa, 2 MPa], step: {load: 2, to: 4 MPa}}
    cold: {start: cold, step: {at: 50 ms}}
variables:
  spool_radius: [6 mm, 16 mm]
objectives:
  dynamic_error: {goal: 0.5 mL, worst_of: [scenario, low]}
  low.source_pressure: {goal: 18 MPa}
constraints:
  settling_time: {max: 0.2 s, worst_of: [low, cold]}
  stability_margin: {min: 0 1/s, max: 1000 1/s, worst_of: [scenario, low, cold]}
reference_point: {dynamic_error: 10 mL, low.source_pressure: 30 MPa}
strategies:
  nsga2: {population: 8, generations: 2}
"""

OILS = """\
name: oils
model:
  kind: divider
  set: {kinematic_viscosity: 30 mm^2/s}
  scenarios:
    hot: {set: {kinematic_viscosity: 15 mm^2/s, bulk_modulus: 1.2e9 Pa}}
    late: {events: [{load: 2, to: 12 MPa}, {load: 1, to: 12 MPa, at: 0.5 s}], set: {coulomb_friction: 2 N}}
variables:
  spool_radius: [6 mm, 16 mm]
objectives:
  load_regulation: {goal: 1 %, worst_of: all}
  hot.dynamic_error: {goal: 0.5 mL}
constraints:
  stability_margin: {min: 0 1/s, worst_of: all}
  late.event_1.settling_time: {max: 0.5 s}
strategies:
  nsga2: {population: 8, generations: 2}
"""


def mistakes(text):
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(text)
    return [(m.line, m.column, m.message) for m in caught.value.mistakes]


def test_events_are_read():
    campaign = parse_campaign(EVENTS)
    scenario = campaign.model.scenario.to_scenario()
    assert scenario.events == (
        load_step(1, 15e6),
        Event(0.3, 0.05, load_pressures=(12e6, 5e6)),
        Event(0.6, 0.0, pytest.approx(50e-3 / 60), 0.6),
    )
    assert scenario.end_time == pytest.approx(1.1)  # from the last event on
    problem = build_problem(campaign)
    assert isinstance(problem.model, Divider)
    assert problem.model.groove_loss
    assert [o.quantity.name for o in problem.objectives] == ["steady_state_error", "event_1.dynamic_error"]


@pytest.mark.parametrize("text", [EVENTS, WORST, OILS])
def test_resolved_campaigns_read_back_as_they_are(text):
    campaign = parse_campaign(text)
    written = dump_campaign(campaign)
    assert parse_campaign(written) == campaign
    jsonschema.validate(YAML(typ="safe").load(text), campaign_schema())
    jsonschema.validate(YAML(typ="safe").load(written), campaign_schema())


def test_the_worst_of_scenarios_is_what_counts():
    problem = build_problem(parse_campaign(WORST))
    assert isinstance(problem.model, Scenarios)
    assert list(problem.model.models) == ["scenario", "low", "cold"]
    assert problem.model.worst == (
        Worst("dynamic_error", ("scenario", "low")),
        Worst("settling_time", ("low", "cold")),
        Worst("stability_margin", ("scenario", "low", "cold")),
        Worst("stability_margin", ("scenario", "low", "cold"), least=True),
    )
    assert [(o.quantity.name, o.goal) for o in problem.objectives] == [
        ("worst.dynamic_error", 0.5e-6),
        ("low.source_pressure", 18e6),
    ]
    assert [(c.quantity.name, c.minimum, c.maximum) for c in problem.constraints] == [
        ("worst.settling_time", None, 0.2),
        ("least.stability_margin", 0.0, None),
        ("worst.stability_margin", None, 1000.0),
    ]


def test_a_scenario_may_set_parameters():
    campaign = parse_campaign(OILS)
    problem = build_problem(campaign)
    hot = {"kinematic_viscosity": pytest.approx(15e-6), "bulk_modulus": 1.2e9}
    assert problem.model.changes == {"hot": hot, "late": {"coulomb_friction": 2.0}}
    assert problem.fixed["kinematic_viscosity"] == pytest.approx(30e-6)
    scenarios = YAML(typ="safe").load(dump_campaign(campaign))["model"]["scenarios"]
    assert scenarios["late"]["set"] == {"coulomb_friction": "2.0 N"}
    assert list(scenarios["hot"]["set"]) == ["kinematic_viscosity", "bulk_modulus"]


def test_all_names_every_scenario():
    campaign = parse_campaign(OILS)
    every = ("scenario", "hot", "late")
    assert campaign.objectives["load_regulation"].worst_of == every
    assert campaign.constraints["stability_margin"].worst_of == every
    assert build_problem(campaign).model.worst == (
        Worst("load_regulation", every),
        Worst("stability_margin", every, least=True),
    )
    written = YAML(typ="safe").load(dump_campaign(campaign))
    assert written["objectives"]["load_regulation"]["worst_of"] == list(every)
    alone = parse_campaign(OILS.replace("worst_of: all", "worst_of: [late, scenario, hot]"))
    assert build_problem(alone).model.worst == build_problem(campaign).model.worst


def test_the_order_of_scenarios_does_not_matter():
    constraint = "settling_time: {max: 0.2 s, worst_of: [low, cold]}"
    assert constraint in WORST
    other = WORST.replace(constraint, "dynamic_error: {max: 1 mL, worst_of: [low, scenario]}")
    problem = build_problem(parse_campaign(other))
    assert problem.model.worst[0] == Worst("dynamic_error", ("scenario", "low"))
    assert problem.constraints[0].quantity.name == "worst.dynamic_error"


def test_a_plug_in_has_no_scenarios():
    text = (
        "name: toy\nmodel: {kind: 'toy_model:Toy'}\nvariables: {x1: [0, 1]}\n"
        "objectives: {f1: {worst_of: [scenario]}}\nstrategies: {nsga2: {population: 8, generations: 2}}\n"
    )
    assert [message for _, _, message in mistakes(text) if "no scenarios to take the worst of" in message]


STEP = "    events:\n      - {load: 1, to: 15 MPa}\n"
MISTAKES = {
    "two ways to say it": (EVENTS, (STEP, "    step: {load: 1}\n" + STEP), [(6, 5, "delete one of the two")]),
    "nothing changes": (EVENTS, ("{load: 1, to: 15 MPa}", "{at: 0 s}"), [(7, 9, "changes nothing")]),
    "half a load step": (EVENTS, ("{load: 1, to: 15 MPa}", "{load: 1}"), [(7, 9, "give both")]),
    "two loads twice": (
        EVENTS,
        ("{load: 1, to: 15 MPa}", "{load: 1, to: 15 MPa, load_pressures: [1 MPa, 2 MPa]}"),
        [(7, 31, "delete one of the two")],
    ),
    "no time": (EVENTS, (", at: 600 ms", ""), [(9, 9, "add `at`")]),
    "no time in a cold start": (EVENTS, ("horizon: 0.5 s", "start: cold\n    end: 2 s"), [(7, 9, "add `at`")]),
    "wrong order": (EVENTS, ("at: 600 ms", "at: 0.2 s"), [(9, 58, "does not come after the one at 0.3 s")]),
    "overlap": (EVENTS, ("at: 600 ms", "at: 0.34 s"), [(9, 58, "is over, at 0.35 s")]),
    "a ramp beyond the end": (
        EVENTS,
        ("at: 600 ms", "at: 600 ms, over: 0.6 s"),
        [(10, 14, "which takes 0.6 s; end it later")],
    ),
    "no second event": (EVENTS, ("event_2.settling_time", "event_3.settling_time"), [(17, 3, "event_")]),
    "negative time": (EVENTS, ("over: 50 ms", "over: -50 ms"), [(8, 60, "at least 0")]),
    "unknown loss": (EVENTS, ("groove_loss: entrance", "groove_loss: some"), [(4, 16, "none, entrance")]),
    "unknown scenario": (WORST, ("[scenario, low]}", "[scenario, lov]}"), [(10, 54, "did you mean low?")]),
    "own name twice": (WORST, ("    low:", "    scenario:"), [(5, 5, "give this one another")]),
    "reserved name": (WORST, ("    low:", "    worst:"), [(5, 5, "already means something")]),
    "a scenario called all": (WORST, ("    low:", "    all:"), [(5, 5, "already means something")]),
    "another word than all": (OILS, ("1 %, worst_of: all", "1 %, worst_of: every"), [(11, 42, "nor all; write one")]),
    "all and others": (OILS, ("1 %, worst_of: all", "1 %, worst_of: [all, hot]"), [(11, 43, "'all' is not known")]),
    "a scenario sets a variable": (
        OILS,
        ("  spool_radius: [6", "  bulk_modulus: [1e9 Pa, 2e9 Pa]\n  spool_radius: [6"),
        [(6, 49, "bulk_modulus is a variable, which no scenario can set")],
    ),
    "a scenario sets no parameter": (OILS, ("bulk_modulus: 1", "bulk_moduls: 1"), [(6, 49, "did you mean bulk_m")]),
    "a scenario's parameter out of range": (OILS, ("15 mm^2/s", "-15 mm^2/s"), [(6, 38, "out of range")]),
    "the standard test sets": (
        OILS,
        ("  scenarios:", "  scenario: {set: {coulomb_friction: 2 N}}\n  scenarios:"),
        [(5, 14, "write these in `model.set`")],
    ),
    "no name": (WORST, ("    low:", "    Low Load:"), [(5, 5, "cannot name a scenario")]),
    "not one quantity": (
        WORST,
        ("  low.source_pressure: {goal: 18 MPa}", "  low.source_pressure: {goal: 18 MPa, worst_of: [low]}"),
        [(11, 39, "take a quantity with a plain name")],
    ),
    "a scenario twice": (WORST, ("[scenario, low]}", "[low, low]}"), [(10, 49, "a second time")]),
    "an event without rest": (EVENTS, ("over: 50 ms", "over: 0.3 s"), [(17, 3, "event_2.settling_time")]),
    "over others": (
        WORST,
        ("  settling_time: {max: 0.2 s, worst_of: [low, cold]}", "  dynamic_error: {max: 1 mL, worst_of: [low]}"),
        [(13, 40, "name the same in both")],
    ),
}


@pytest.mark.parametrize(("text", "edit", "expected"), MISTAKES.values(), ids=MISTAKES)
def test_each_mistake_is_found_at_its_place(text, edit, expected):
    old, new = edit
    assert old in text
    reported = mistakes(text.replace(old, new))
    assert [(line, column) for line, column, _ in reported[: len(expected)]] == [e[:2] for e in expected]
    for (_, _, message), (_, _, part) in zip(reported, expected, strict=False):
        assert part in message


GUIDE = (Path(__file__).parents[2] / "docs" / "scenarios.md").read_text(encoding="utf-8")
EXAMPLES = [textwrap.dedent(block) for block in re.findall(r"((?:^    .*\n)+)", GUIDE, re.MULTILINE)]
REST = "name: guide\nvariables: {spool_radius: [6 mm, 16 mm]}\nstrategies: {nsga2: {population: 8, generations: 2}}\n"


@pytest.mark.parametrize("example", EXAMPLES)
def test_the_guide_is_right(example):
    if example.startswith("scenario:"):
        example = "model:\n  kind: divider\n" + textwrap.indent(example, "  ") + "objectives: {source_pressure: }\n"
    problem = build_problem(parse_campaign(REST + example))
    assert len(problem.objectives) >= 1


def test_the_guide_has_its_examples():
    assert len(EXAMPLES) == 5
