"""Uncertain parameters in a campaign: what may be said of them, and a campaign run with them."""

import io
import json
import re
import shutil
import textwrap
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from jsonschema import Draft202012Validator

from divideropt.campaign.dump import campaign_schema, dump_campaign
from divideropt.campaign.load import parse_campaign
from divideropt.campaign.plan import build_problem, dividers
from divideropt.campaign.reader import read_text
from divideropt.campaign.runner import Runner
from divideropt.errors import FileMistakes, StoreError
from divideropt.models.distributions import LogUniform, Normal, Triangular, Uniform
from divideropt.models.divider import Divider
from divideropt.models.divider.scenarios import Scenarios
from divideropt.models.statistic import Statistic
from divideropt.models.uncertain import Source, Uncertain
from divideropt.models.viscosity import THESIS_OIL, Walther
from divideropt.report.setting import setting_of
from stores import assert_same, logs

BASE = """\
name: sure
model:
  kind: divider
  scenarios:
    low: {load_pressures: [2 MPa, 2 MPa], step: {load: 2, to: 4 MPa}}
variables:
  spool_radius: [6 mm, 16 mm]
  groove_width: [0.6 mm, 2 mm]
objectives:
  steady_state_error: {goal: 0.5 %}
  dynamic_error: {worst_of: [scenario, low]}
constraints:
  stop_clearance: {min: 0 mm}
strategies:
  nsga2: {population: 8, generations: 2}
"""

SURE = parse_campaign(BASE)

UNSURE = (
    BASE.replace("{goal: 0.5 %}", "{goal: 0.5 %, statistic: p95}")
    .replace("low]}", "low], statistic: mean}")
    .replace(
        "{min: 0 mm}",
        "{min: 0 mm, statistic: p5}\n  source_pressure: {max: 30 MPa, worst_of: [low], statistic: p99.5}\n"
        "  failed_share: {max: 5 %}",
    )
    + """\
uncertainty:
  samples: 16
  parameters:
    kinematic_viscosity: {temperature: {uniform: [25 °C, 60 °C]}}
    coulomb_friction: {loguniform: [0.1 N, 10 N]}
    radial_clearance: {triangular: [2.5 um, 3 um, 3.5 um]}
    rim_thickness: {normal: {mean: 0.8 mm, sd: 0.1 mm}}
    spool_radius: {offset: {uniform: [-5 um, 5 um]}}
    density: {factor: {normal: {mean: 1, sd: 0.01}}}
"""
)

SCHEMA = Draft202012Validator(campaign_schema())


def mistakes(text):
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(text)
    for m in caught.value.mistakes:
        for jargon in ("Input", "valid", "Value error", "pydantic", "None", "<"):
            assert jargon not in m.message
    return [(m.line, m.column, m.message) for m in caught.value.mistakes]


def test_what_is_read():
    asked = parse_campaign(UNSURE).uncertainty
    assert (asked.samples, asked.seed) == (16, 1)
    found = asked.parameters
    assert found["kinematic_viscosity"] == Source("kinematic_viscosity", Uniform(25.0, 60.0), oil=THESIS_OIL)
    assert found["coulomb_friction"] == Source("coulomb_friction", LogUniform(0.1, 10.0))
    assert found["radial_clearance"] == Source("radial_clearance", Triangular(2.5e-6, 3e-6, 3.5e-6))
    rim = found["rim_thickness"].distribution
    assert isinstance(rim, Normal)
    assert (rim.mean, rim.sd, rim.lower, rim.upper) == pytest.approx((0.8e-3, 0.1e-3, 0.5e-3, 1.1e-3))
    assert found["spool_radius"] == Source("spool_radius", Uniform(-5e-6, 5e-6), "offset")
    assert found["density"].acting == "factor"


def test_what_is_made_of_it():
    problem = build_problem(parse_campaign(UNSURE))
    model = problem.model
    assert isinstance(model, Uncertain)
    assert isinstance(model.model, Scenarios)
    assert list(dividers(model)) == ["scenario", "low"]
    assert [s.parameter for s in model.sources] == [
        "spool_radius", "radial_clearance", "rim_thickness", "coulomb_friction", "density", "kinematic_viscosity",
    ]  # fmt: skip
    assert [(o.quantity.name, o.goal) for o in problem.objectives] == [
        ("p95.steady_state_error", 0.5),
        ("mean.worst.dynamic_error", None),
    ]
    assert [(c.quantity.name, c.minimum, c.maximum) for c in problem.constraints] == [
        ("p5.stop_clearance", 0.0, None),
        ("p99.5.worst.source_pressure", None, 30e6),
        ("failed_share", None, 5.0),
    ]
    assert Statistic("stop_clearance", "p5", least=True) in model.needed
    shown = [f"{kind}.{name}" for name in ("steady_state_error", "worst.dynamic_error")
             for kind in ("mean", "p5", "p50", "p95")]  # fmt: skip
    assert set(shown) <= set(model.quantities)


def test_an_oil_of_ones_own():
    text = UNSURE.replace("60 °C]}}", "60 °C]}, points: [[100 °C, 6.8 mm^2/s], [40 °C, 46 mm^2/s]]}")
    oil = parse_campaign(text).uncertainty.parameters["kinematic_viscosity"].oil
    assert oil == Walther((40.0, 46e-6), (100.0, pytest.approx(6.8e-6)))


@pytest.mark.parametrize("text", [UNSURE, BASE])
def test_resolved_campaigns_read_back_as_they_are_and_fit_the_schema(text):
    campaign = parse_campaign(text)
    written = dump_campaign(campaign)
    assert parse_campaign(written) == campaign
    SCHEMA.validate(read_text(text).data)
    SCHEMA.validate(read_text(written).data)


def test_without_uncertainty_nothing_is_different():
    assert "uncertainty" not in dump_campaign(SURE)
    assert "statistic" not in dump_campaign(SURE)
    assert isinstance(build_problem(SURE).model, Scenarios)
    assert SURE.optimality.points == 200
    assert not any("Uncertainty" in words for words in setting_of(SURE))
    sure, unsure = build_problem(SURE), build_problem(parse_campaign(UNSURE))
    designs = sure.space.sample(3, np.random.default_rng(0))
    plain, other = sure.simulate(designs), unsure.simulate(designs)
    names = list(sure.model.quantities)
    places = [list(unsure.model.quantities).index(name) for name in names if not name.startswith("worst")]
    known = [names.index(name) for name in names if not name.startswith("worst")]
    np.testing.assert_array_equal(plain.quantities[:, known], other.quantities[:, places])


def test_the_report_says_it():
    words = dict(setting_of(parse_campaign(UNSURE)))["Uncertainty"]
    for part in (
        "16 samples (seed 1)", "66 mm²/s at 25 °C", "temperature uniform from 25 °C to 60 °C",
        "coulomb friction log-uniform from 0.1 N to 10 N", "radial clearance triangular from 2.5 µm to 3.5 µm",
        "rim thickness normal about 0.8 mm", "spool radius plus an offset uniform from −5 µm to 5 µm",
        "density times a factor normal about 1.000",
    ):  # fmt: skip
        assert part in words


U = "uncertainty:"
VISCOSITY = "{temperature: {uniform: [25 °C, 60 °C]}}"
CLEARANCE = "{triangular: [2.5 um, 3 um, 3.5 um]}"
MISTAKES = {
    "no samples": ("samples: 16", "samples: 0", ("0", "the least permitted is 2")),
    "too many": ("samples: 16", "samples: 1000000000", ("1000000000", "the most permitted is 10000")),
    "too many with an exponent": ("samples: 16", "samples: 1e9", ("1e9", "not a whole number")),
    "not a number": ("samples: 16", "samples: .nan", (".nan", "not a whole number")),
    "no seed": ("samples: 16", "seed: -1", ("-1", "the least permitted is 0")),
    "unknown key": ("samples: 16", "sample: 16", ("sample: 16", "did you mean samples?")),
    "unknown parameter": (
        "radial_clearance",
        "radial_clearence",
        ("radial_clearence: {", "did you mean radial_clearance?"),
    ),
    "reversed": ("[25 °C, 60 °C]", "[60 °C, 25 °C]", ("[60", "'60 °C' is not below '25 °C'")),
    "reversed, of three": (CLEARANCE, "{triangular: [3.5 um, 3 um, 2.5 um]}", ("[3.5 um", "is not below")),
    "mode outside": (CLEARANCE, "{triangular: [2.5 um, 4 um, 3.5 um]}", ("[2.5 um", "not between the ends")),
    "two of three": (CLEARANCE, "{triangular: [2.5 um, 3 um]}", ("[2.5 um", "write [low, mode, high]")),
    "a number": (CLEARANCE, "3 um", ("3 um", "is not a mapping")),
    "nothing": (CLEARANCE, "{}", ("{", "there is no distribution here")),
    "unknown distribution": (CLEARANCE, "{unifrom: [1 um, 2 um]}", ("unifrom: [1 um", "did you mean uniform?")),
    "two distributions": (
        CLEARANCE,
        "{uniform: [1 um, 2 um], normal: {mean: 3 um, sd: 1 um}}",
        ("normal: {", "there is uniform already"),
    ),
    "two inside": (
        "{offset: {uniform: [-5 um, 5 um]}}",
        "{offset: {uniform: [-5 um, 5 um], loguniform: [1 um, 2 um]}}",
        ("loguniform: [1 um", "there is uniform already"),
    ),
    "no unit": (CLEARANCE, "{uniform: [2.5, 3.5 um]}", ("2.5", "has no unit")),
    "another unit": (CLEARANCE, "{uniform: [2.5 N, 3.5 um]}", ("2.5 N", "of another kind")),
    "out of the domain": (CLEARANCE, "{uniform: [-1 um, 3.5 um]}", ("-1 um", "above 0")),
    "nan": (CLEARANCE, "{uniform: [.nan, 3.5 um]}", (".nan", "not a number with a unit")),
    "no logarithm": ("{loguniform: [0.1 N, 10 N]}", "{loguniform: [0 N, 10 N]}", ("[0 N", "no logarithm")),
    "no sd": ("{mean: 0.8 mm, sd: 0.1 mm}", "{mean: 0.8 mm}", ("normal: {", "'sd' is missing")),
    "sd of zero": ("sd: 0.1 mm", "sd: 0 mm", ("0 mm}", "above 0")),
    "a temperature of anything": (
        CLEARANCE,
        VISCOSITY,
        ("temperature: {", "use one of uniform, loguniform, triangular"),
    ),
    "a temperature in kelvin": ("[25 °C, 60 °C]", "[298 K, 60 °C]", ("298 K", "is not a number of °C")),
    "a temperature without unit": ("[25 °C, 60 °C]", "[25, 60 °C]", ("25", "is not a number of °C")),
    "too hot": ("60 °C]}}", "600 °C]}}", ("600", "at most 200 °C")),
    "one point": ("60 °C]}}", "60 °C]}, points: [[25 °C, 66 mm^2/s]]}", ("[[25", "write [point, point]")),
    "an oil that thickens": (
        "60 °C]}}",
        "60 °C]}, points: [[25 °C, 15 mm^2/s], [60 °C, 66 mm^2/s]]}",
        ("[[25", "does not fall"),
    ),
    "points of nothing": (
        CLEARANCE,
        CLEARANCE + "\n    bulk_modulus: {points: [[25 °C, 66 mm^2/s], [60 °C, 15 mm^2/s]]}",
        ("points: [[25", "use one of"),
    ),
    "a variable by its value": (
        "{offset: {uniform: [-5 um, 5 um]}}",
        "{uniform: [6 mm, 7 mm]}",
        ("spool_radius: {", "is a variable, whose value a strategy gives; write an offset"),
    ),
    "an offset beyond the domain": (
        "[-5 um, 5 um]",
        "[-6 mm, 5 um]",
        (
            "spool_radius: {",
            "would be as far as 0 m, but must be above 0; narrow the offset, or the variable's range",
        ),
    ),
    "a factor below zero": ("{mean: 1, sd: 0.01}", "{mean: -1, sd: 0.01}", ("-1", "at least 0")),
    "a factor beyond the domain": (
        "density: {factor: {normal: {mean: 1, sd: 0.01}}}",
        "fixed_drop_ratio: {factor: {uniform: [1, 2]}}",
        ("fixed_drop_ratio: {", "would be as far as 1, but must be above 0 and below 1; narrow the factor"),
    ),
    "a statistic that is none": ("statistic: p95", "statistic: p101", ("p101}", "'p101' is no statistic")),
    "a number as statistic": ("statistic: p95", "statistic: 95", ("95}", "95 is no statistic")),
    "a percentile on the wrong side": ("statistic: p5}", "statistic: p95}", ("p95}", "write p5")),
    "a percentile with two bounds": (
        "{min: 0 mm, statistic: p5}",
        "{min: 0 mm, max: 9 mm, statistic: p50}",
        ("p50}", "p50 has a min and a max, and a failed sample"),
    ),
    "a percentile to be small and large": (
        "{min: 0 mm, statistic: p5}",
        "{min: 0 mm, statistic: p5}\n  steady_state_error: {min: 0 %, statistic: p95}",
        ("p95}", "p95 has a min and is an objective, and a failed sample"),
    ),
    "a statistic of the share": ("{max: 5 %}", "{max: 5 %, statistic: p95}", ("statistic: p95}", "delete it")),
    "no uncertainty": (U + UNSURE.split(U)[1], "", ("statistic: p95}", "there is no `uncertainty`")),
    "no share without it": (U + UNSURE.split(U)[1], "", ("failed_share: {", "failed_share")),
    "no parameters": ("parameters:" + UNSURE.split("parameters:")[1], "parameters: {}\n", ("{", "name at least 1")),
    "a scenario called as a statistic": ("    low:", "    p95:", ("uncertainty:", "would be a statistic's name")),
}


@pytest.mark.parametrize(("old", "new", "expected"), MISTAKES.values(), ids=MISTAKES)
def test_each_mistake_is_found_at_its_place(old, new, expected):
    assert old in UNSURE
    text = UNSURE.replace(old, new, 1)
    at, part = expected
    lines = text.splitlines()
    places = [lines[line - 1][column - 1 :] for line, column, message in mistakes(text) if part in message]
    assert places
    assert places[0].startswith(at)


INFECTED = [
    ("samples: 16", "samples: 0"),
    ("samples: 16", "samples: 16.5"),
    ("[25 °C, 60 °C]", "[25, 60 °C]"),
    (CLEARANCE, "{triangular: [2.5 um, 3 um]}"),
    (CLEARANCE, "{}"),
    (CLEARANCE, "{uniform: [1 um, 2 um], loguniform: [1 um, 2 um]}"),
    (CLEARANCE, VISCOSITY),
    ("{mean: 0.8 mm, sd: 0.1 mm}", "{mean: 0.8 mm}"),
    ("{offset: {uniform: [-5 um, 5 um]}}", "{offset: {}}"),
    ("statistic: p95", "statistic: p101"),
    ("{max: 5 %}", "{max: 5 %, statistic: p95}"),
    (U + UNSURE.split(U)[1], ""),
]


@pytest.mark.parametrize(("old", "new"), INFECTED)
def test_what_the_loader_refuses_the_schema_refuses(old, new):
    assert old in UNSURE
    text = UNSURE.replace(old, new, 1)
    mistakes(text)
    assert not SCHEMA.is_valid(read_text(text).data)


def test_a_share_without_uncertainty_fits_no_schema():
    data = read_text(BASE.replace("stop_clearance: {min: 0 mm}", "failed_share: {max: 5 %}")).data
    assert not SCHEMA.is_valid(data)
    data = read_text(BASE).data
    assert SCHEMA.is_valid({**data, "uncertainty": None})
    assert parse_campaign(json.dumps({**data, "uncertainty": None})) == SURE


GUIDE = (Path(__file__).parents[2] / "docs" / "how-to" / "robust.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"((?:^    .*\n)+)", GUIDE, re.MULTILINE)
EXAMPLES = [textwrap.dedent(block) for block in BLOCKS if "uncertainty:" in block]
REST = """\
name: guide
model: {kind: divider}
variables: {spool_radius: [6 mm, 16 mm]}
strategies: {nsga2: {population: 8, generations: 2}}
"""


@pytest.mark.parametrize("example", EXAMPLES)
def test_the_guide_is_right(example):
    problem = build_problem(parse_campaign(REST + example))
    assert isinstance(problem.model, Uncertain)
    SCHEMA.validate(read_text(REST + example).data)


def test_the_guides_table_of_distributions_is_right():
    written = re.findall(r"^\| `(\{.*?\})` \|", GUIDE, re.MULTILINE)
    assert len(written) == 7
    numbers = {"low": "2 um", "mode": "3 um", "high": "4 um"}
    for text in written:
        known = re.sub("|".join(numbers), lambda m: numbers[m[0]], text)
        name = "kinematic_viscosity" if "temperature" in text else "rim_thickness"
        asked = f"uncertainty: {{parameters: {{{name}: {known}}}}}\n"
        assert set(parse_campaign(BASE + asked).uncertainty.parameters) == {name}


TOY = """
name: toy
model: {kind: "toy_model:Toy"}
variables: {x1: [0, 1], x2: [0.1, 1]}
objectives:
  f1: {goal: 0.2}
  f2: {goal: 2, weight: 2, statistic: p95}
constraints: {spare: {min: 0 m}, failed_share: {max: 20 %}}
reference_point: {f1: 1, f2: 20}
uncertainty:
  samples: 8
  parameters:
    x2: {offset: {uniform: [-0.1, 0]}}
    x3: {uniform: [0, 1]}
strategies:
  nsga2: {population: 12, generations: 4, seeds: [1]}
  complex: {points: 6, evaluations: 40, seeds: [3]}
parallel: {workers: 2, backend: BACKEND}
"""


def run(folder, workers=1, backend="sequential", text=TOY):
    Runner(parse_campaign(text.replace("BACKEND", backend)), folder, workers, io.StringIO()).run()
    return folder


@pytest.fixture(scope="module", name="whole")
def _whole(tmp_path_factory):
    return run(tmp_path_factory.mktemp("whole") / "store")


def test_a_store_has_the_columns_and_a_front_is_of_the_statistic(whole):
    front = pd.read_parquet(whole / "fronts" / "combined.parquet")
    assert {"f2", "mean.f2", "p5.f2", "p50.f2", "p95.f2", "mean.f1", "failed_share"} <= set(front.columns)
    assert (front["p95.f2"] >= front["p50.f2"]).all()
    assert (front.failed_share <= 20).all()
    log = logs(whole)["nsga2-1"]
    assert log.outcome_text.str.match(r"in [1-8] of 8 samples: x2 is too small").any()
    points = list(zip(front.f1, front["p95.f2"], strict=True))
    assert not any(q[0] <= p[0] and q[1] <= p[1] and q != p for p in points for q in points)


@pytest.mark.parametrize(("workers", "backend"), [(2, "loky"), (3, "loky")])
def test_workers_give_the_same_bits(whole, tmp_path, workers, backend):
    assert_same(whole, run(tmp_path / "store", workers, backend))


def test_a_store_that_lost_its_tail_is_completed_to_the_same_bits(whole, tmp_path):
    folder = tmp_path / "store"
    shutil.copytree(whole, folder)
    for part in (folder / "evaluations" / "nsga2-1").glob("*.parquet"):
        part.unlink()
    shutil.rmtree(folder / "fronts")
    assert_same(whole, run(folder))


@pytest.mark.parametrize(
    ("old", "new"), [("samples: 8", "samples: 16"), ("x3: {uniform: [0, 1]}", "x3: {uniform: [0, 0.9]}")]
)
def test_another_uncertainty_is_another_campaign(whole, tmp_path, old, new):
    shutil.copytree(whole, tmp_path / "store")
    with pytest.raises(StoreError, match=r"uncertainty\.") as caught:
        run(tmp_path / "store", text=TOY.replace(old, new))
    assert "belongs to another campaign" in str(caught.value)


def test_a_plain_campaign_has_no_column_more(tmp_path):
    before, after = TOY.split("uncertainty:")
    plain = before + "strategies:" + after.split("strategies:")[1]
    plain = plain.replace(", statistic: p95", "").replace(", failed_share: {max: 20 %}", "")
    columns = logs(run(tmp_path / "store", text=plain))["nsga2-1"].columns
    assert list(columns) == ["design_id", "run", "batch", "x1", "x2", "f1", "f2", "spare", "outcome", "outcome_text"]
    with pytest.raises(StoreError, match=r"uncertainty: None in the store") as caught:
        run(tmp_path / "store")
    assert "objectives.f2.statistic: None in the store, p95 in the campaign" in str(caught.value)


def test_a_plugin_may_not_have_the_names_of_statistics():
    text = TOY.replace("toy_model:Toy", "uncertain_toys:Named")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).parent)
        found = mistakes(text)
    assert [m for m in found if "the model has a quantity failed_share" in m[2]]


def test_a_divider_without_scenarios_is_found_beneath():
    text = BASE.replace("  scenarios:\n    low: {load_pressures: [2 MPa, 2 MPa], step: {load: 2, to: 4 MPa}}\n", "")
    text = text.replace("{worst_of: [scenario, low]}", "{statistic: p95}")
    model = build_problem(
        parse_campaign(text + "uncertainty: {parameters: {coulomb_friction: {uniform: [0 N, 1 N]}}}\n")
    ).model
    assert isinstance(model.model, Divider)
    assert dividers(model) == {"scenario": model.model}
    assert isinstance(model.reference(), Uncertain)
