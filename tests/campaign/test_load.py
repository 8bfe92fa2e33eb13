"""The shipped campaigns, files that are no campaign, the way back to text, and the schema."""

import json
import pickle
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from divideropt.campaign.dump import campaign_schema, dump_campaign
from divideropt.campaign.load import default_campaign, default_text, load_campaign, parse_campaign
from divideropt.campaign.reader import read_document, read_text
from divideropt.errors import FileMistakes, UsageError, printable
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.strategies import METHODS

CAMPAIGNS = Path(__file__).parents[2] / "campaigns"
FILES = [CAMPAIGNS / f"{name}.yaml" for name in ("quickstart", "thesis", "divider")]
QUICKSTART = FILES[0].read_text("utf-8")

each_campaign = pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)


@each_campaign
def test_a_shipped_campaign_loads_under_its_own_name(path):
    assert load_campaign(path).name == path.stem


@each_campaign
def test_a_shipped_campaign_says_what_it_is_for(path):
    assert path.read_text("utf-8").startswith("# ")


def test_the_packaged_campaign_is_the_one_in_the_folder():
    assert default_text() == CAMPAIGNS.joinpath("divider.yaml").read_text("utf-8")
    assert default_campaign() == load_campaign(CAMPAIGNS / "divider.yaml")


def test_quickstart_is_quick():
    campaign = load_campaign(FILES[0])
    assert sum(plan.options.budget(5) * len(plan.seeds) for plan in campaign.strategies) * 0.005 < 20


def test_the_campaign_of_the_thesis_is_the_authors():
    campaign = load_campaign(CAMPAIGNS / "thesis.yaml")
    scenario = campaign.model.scenario.to_scenario()
    assert (campaign.model.formulation, scenario.settled) == ("listing", False)
    assert (scenario.last_event_time, scenario.end_time) == (0.05, 1.0)
    assert campaign.variables["groove_width"] == (0.6e-3, 2e-3)
    assert {name: (o.goal, o.weight) for name, o in campaign.objectives.items()} == {
        "steady_state_error": (0.5, 3.0),
        "dynamic_error": (0.5e-6, 3.0),
        "source_pressure": (18e6, 1.0),
    }


@each_campaign
def test_a_dumped_campaign_loads_as_the_same(path):
    campaign = load_campaign(path)
    text = dump_campaign(campaign)
    again = parse_campaign(text)
    assert again == campaign
    assert list(again.variables) == list(campaign.variables)
    assert dump_campaign(again) == text


@each_campaign
def test_a_campaign_can_be_sent_to_a_worker(path):
    campaign = load_campaign(path)
    assert pickle.loads(pickle.dumps(campaign)) == campaign


@given(
    name=st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}", fullmatch=True),
    radius=st.lists(st.floats(1e-6, 1.0), min_size=2, max_size=2, unique=True),
    goal=st.floats(-1e50, 1e50).filter(lambda goal: abs(goal) >= 1e-50),
    weight=st.floats(1e-50, 1e50),
    density=st.floats(1e-3, 1e5),
    rtol=st.floats(1e-13, 0.1),
)
def test_any_campaign_survives_the_way_to_text_and_back(name, radius, goal, weight, density, rtol):
    lower, upper = sorted(radius)
    campaign = parse_campaign(
        f"""\
name: "{name}"
model: {{kind: divider, set: {{density: {density!r} kg/m^3}}, solver: {{rtol: {rtol!r}}}}}
variables: {{spool_radius: [{lower!r} m, {upper!r} m]}}
objectives: {{steady_state_error: {{goal: {goal!r} %, weight: {weight!r}}}}}
strategies: {{nsga2: {{}}}}
"""
    )
    assert campaign.name == name
    assert campaign.variables["spool_radius"] == (lower, upper)
    assert campaign.objectives["steady_state_error"].goal == goal
    assert campaign.model.set == {"density": density}
    assert parse_campaign(dump_campaign(campaign)) == campaign


@pytest.mark.parametrize("content", [b"", b"# nothing\n", b"\xff\xfe", b"a: [", b"- 1\n", b"x" * 2**21])
def test_a_file_that_is_no_campaign_is_a_usage_error(tmp_path, content):
    path = tmp_path / "c.yaml"
    path.write_bytes(content)
    with pytest.raises(UsageError, match=r"c\.yaml:"):
        load_campaign(path)


def test_a_missing_file_and_a_folder(tmp_path):
    with pytest.raises(UsageError, match="no such file"):
        load_campaign(tmp_path / "c.yaml")
    with pytest.raises(UsageError, match="folder"):
        load_campaign(tmp_path)


def test_mistakes_are_worded_with_file_line_and_column(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_text(QUICKSTART.replace("[6 mm, 16 mm]", "[16 mm, 6 mm]"), "utf-8")
    line = next(i for i, text in enumerate(QUICKSTART.split("\n"), 1) if "[6 mm" in text)
    with pytest.raises(FileMistakes) as caught:
        load_campaign(path)
    assert str(caught.value).startswith(f"{path}:{line}:24: variables.spool_radius: the lower bound '16 mm'")
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    "section", ["variables", "objectives", "constraints", "reference_point", "strategies", "extra"]
)
def test_five_thousand_unknown_keys_are_refused_in_time(section):
    keys = "".join(f"  spool_radius_{i}: 1\n" for i in range(4900))
    lines = [line for line in QUICKSTART.split("\n") if not line.startswith(f"{section}:")]
    start = time.process_time()
    with pytest.raises(FileMistakes):
        parse_campaign("\n".join(lines) + f"\n{section}:\n{keys}")
    assert time.process_time() - start < 2


LINES = QUICKSTART.split("\n")
SNIPPETS = [
    "\t",
    "&a ",
    "*a",
    "!!int ",
    "<<: {}",
    "---",
    "{",
    "}",
    "[",
    ":",
    ": ",
    "- ",
    "'",
    '"',
    "|",
    "#",
    "%",
    "1e999",
    "nan",
]
SNIPPETS += [
    ".inf",
    "true",
    "null",
    "-1",
    "0",
    "6 mm",
    "1/s",
    "dB",
    "µm",
    "\x00",
    "é",
    "\\",
    "a.b:C",
    "complex",
    "999999999999",
]


@st.composite
def mutated(draw):
    lines = list(LINES)
    for _ in range(draw(st.integers(1, 4))):
        i = draw(st.integers(0, len(lines) - 1))
        edit = draw(st.sampled_from(["delete", "duplicate", "swap", "insert", "replace", "cut", "character"]))
        if edit == "delete" and len(lines) > 1:
            del lines[i]
        elif edit == "duplicate":
            lines.insert(draw(st.integers(0, len(lines))), lines[i])
        elif edit == "swap":
            j = draw(st.integers(0, len(lines) - 1))
            lines[i], lines[j] = lines[j], lines[i]
        else:
            at = draw(st.integers(0, len(lines[i])))
            to = {
                "insert": at,
                "replace": at + draw(st.integers(1, 8)),
                "cut": len(lines[i]),
                "character": at + 1,
            }[edit]
            new = draw(st.characters(codec="utf-8") if edit == "character" else st.sampled_from(SNIPPETS))
            lines[i] = lines[i][:at] + new + lines[i][to:]
    return "\n".join(lines)


@settings(max_examples=300, deadline=2000)
@given(mutated())
def test_a_mutated_campaign_loads_or_is_refused_in_sentences(text):
    try:
        campaign = parse_campaign(text)
    except FileMistakes as error:
        assert error.mistakes
        for mistake in error.mistakes:
            assert mistake.line >= 1
            assert mistake.column >= 1
            assert "Input should" not in mistake.message
    except UsageError:
        return
    else:
        assert parse_campaign(dump_campaign(campaign)) == campaign


PLUGIN = """
import dataclasses

from divideropt.models import Domain, Parameter, Quantity


class Spring:
    def __init__(self, stiffness=1.0, label=""):
        if stiffness < 0:
            raise ValueError("stiffness below 0")
        self.parameters = {"way": Parameter("way", "m", "x", "way", 1e-3, Domain(0.0, 1.0)),
                           "mass": Parameter("mass", "kg", "m", "mass", 2.0, Domain(0.0))}
        self.quantities = {"force": Quantity("force", "N", "F", "force", 1.0)}

    def evaluate(self, designs):
        raise NotImplementedError


class Other:
    pass


class Unnamed(Spring):
    def __init__(self):
        super().__init__()
        self.quantities = {}


class Misnamed(Spring):
    def __init__(self, name="a\\nb", key=None):
        super().__init__()
        self.quantities = {name if key is None else key: Quantity(name, "N", "F", "force", 1.0)}


class Talkative(Spring):
    def __init__(self):
        raise ValueError("first line\\n\\x1b[31msecond line " + "and so on " * 1000)


class Mute(Spring):
    def __init__(self):
        class Wordless(Exception):
            def __str__(self):
                raise RuntimeError("no words")

        raise Wordless


class Sized(Spring):
    def __init__(self, scale=1.0, default=1.0):
        super().__init__()
        self.parameters["way"] = dataclasses.replace(self.parameters["way"], default=float(default))
        self.quantities["force"] = dataclasses.replace(self.quantities["force"], scale=float(scale))
"""


@pytest.fixture
def spring(tmp_path, monkeypatch):
    tmp_path.joinpath("springs.py").write_text(PLUGIN)
    tmp_path.joinpath("broken_springs.py").write_text("1 / 0\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield plugin_campaign
    sys.modules.pop("springs", None)


def plugin_campaign(kind="springs:Spring", options="{stiffness: 2.5}", more=""):
    return f"""\
name: spring
model:
  kind: {kind}
  options: {options}
  set: {{mass: 500 g}}
variables: {{way: [1 mm, 10 mm]}}
objectives: {{force: {{goal: 1 kN}}}}
strategies: {{nsga2: {{population: 10}}}}
{more}"""


def test_a_model_of_the_users_own(spring):
    campaign = parse_campaign(spring())
    assert campaign.variables == {"way": (1e-3, 10e-3)}
    assert campaign.objectives["force"].goal == 1000.0
    assert campaign.model.base_parameters() == {"way": 1e-3, "mass": 0.5}
    assert campaign.model.make().quantities.keys() == {"force"}
    assert parse_campaign(dump_campaign(campaign)) == campaign


def test_its_names_and_units_are_checked(spring):
    text = spring().replace("mass: 500 g", "mass: 5 mm, spool_radius: 1 mm").replace("force:", "farce:")
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(text)
    assert [(m.line, m.column) for m in caught.value.mistakes] == [(5, 15), (5, 21), (7, 14)]


@pytest.mark.parametrize(
    ("kind", "options", "reason"),
    [
        ("no_such_springs:Spring", "{}", "cannot be imported"),
        ("springs:Sprung", "{}", "has no 'Sprung'"),
        ("springs:Spring", "{colour: red}", "makes no model"),
        ("springs:Spring", "{stiffness: -1}", "stiffness below 0"),
        ("springs:Other", "{}", "is no model: it is not a class that has `evaluate`"),
        ("springs:Parameter", "{}", "is no model"),
        ("springs:Talkative", "{}", "(ValueError: first line \\x1b[31msecond line and so on"),
        ("springs:Mute", "{}", "(Wordless)"),
        ("springs:Unnamed", "{}", "has no quantity"),
        ("springs:Misnamed", "{}", "not one line of at most 1000 printable characters"),
        ("springs:Misnamed", "{name: ' a'}", "no space around it"),
        ("springs:Misnamed", "{name: ''}", "no space around it"),
        ("springs:Misnamed", "{name: 5}", "not a Quantity of that name"),
        ("springs:Misnamed", "{name: a, key: b}", "not a Quantity of that name"),
        ("springs:Sized", "{scale: 0}", "'force': its scale: 0.0 is out of range; what is permitted is above 0"),
        ("springs:Sized", "{scale: 1e300}", "its scale: 1e+300 is too large to be computed with"),
        ("springs:Sized", "{scale: '1e-310'}", "its scale: 1e-310 is too small"),
        ("springs:Sized", "{default: .nan}", "parameter 'way': its default: .nan is not a finite number"),
        (f"springs:{'a' * 200}", "{}", "the most permitted are 200"),
        ("broken_springs:Spring", "{}", "ZeroDivisionError"),
        ("':Spring'", "{}", "names no class"),
        ("'springs:'", "{}", "names no class"),
        ("..springs:Spring", "{}", "names no class"),
    ],
)
def test_a_class_that_is_no_model_is_a_mistake_at_kind(spring, kind, options, reason):
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(spring(kind, options, "parallel: {workers: 0}"))
    at_kind, at_workers = caught.value.mistakes
    assert (at_kind.line, at_kind.column) == (3, 9)
    assert reason in printable(at_kind.message)
    assert str(caught.value).count("\n") == 1, "a line a mistake"
    assert str(caught.value).replace("\n", "").isprintable()
    assert len(at_kind.message) < 400
    assert (at_workers.line, at_workers.column) == (9, 21)


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("subprocess:Popen", "{{args: touch {}, shell: true}}"),
        ("os:system", "{{command: touch {}}}"),
        ("pathlib:Path", "{{}}"),
        ("builtins:open", "{{file: {}, mode: w}}"),
        ("builtins:exec", '{{source: \'open("{}", "w")\'}}'),
    ],
)
def test_a_campaign_calls_nothing_but_models(tmp_path, kind, options):
    trace = tmp_path / "trace"
    with pytest.raises(FileMistakes, match=r"is no model|cannot be imported"):
        parse_campaign(plugin_campaign(kind, options.format(trace)))
    assert not trace.exists()


def test_nothing_is_imported_for_a_file_that_is_refused(spring):
    with pytest.raises(FileMistakes, match="tag"):
        parse_campaign(spring(more="parallel: !!map {}"))
    assert "springs" not in sys.modules


@given(
    options=st.dictionaries(st.just("label"), st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"])))
)
def test_any_option_survives_the_way_to_text_and_back(options, tmp_path_factory):
    folder = tmp_path_factory.getbasetemp() / "options"
    folder.mkdir(exist_ok=True)
    folder.joinpath("springs.py").write_text(PLUGIN)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        campaign = parse_campaign(plugin_campaign())
        changed = campaign.model_copy(update={"model": campaign.model.model_copy(update={"options": options})})
        assert parse_campaign(dump_campaign(changed)) == changed
    sys.modules.pop("springs", None)


SCHEMA = Draft202012Validator(campaign_schema())


def test_the_schema_is_one():
    Draft202012Validator.check_schema(campaign_schema())
    assert campaign_schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"


@each_campaign
def test_the_shipped_campaigns_fit_the_schema(path):
    SCHEMA.validate(read_document(path).data)
    SCHEMA.validate(read_text(dump_campaign(load_campaign(path))).data)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("name: quickstart", "nom: quickstart"),
        ("name: quickstart", "name: ../x"),
        ("conservative ", "conservatism "),
        ("[6 mm, 16 mm]", "[6, 16 mm]"),
        ("[6 mm, 16 mm]", "['6', 16 mm]"),
        ("[6 mm, 16 mm]", "['15', 16 mm]"),
        ("[6 mm, 16 mm]", "[6 mm]"),
        ("[0.3, 0.99]", "[0.3, true]"),
        ("[0.3, 0.99]", "[0.3, 1]"),
        ("goal: 0.5 %", "goal: 0.5"),
        ("goal: 0.5 %", "gaol: 0.5 %"),
        ("groove_width:", "groove_with:"),
        ("{max: 30 MPa}", "{}"),
        ("population: 40", "population: 1"),
        ("points: 10", "point: 10"),
        ("nsga2:", "nsga4:"),
        ("seeds: [1]", "seeds: [1, 1]"),
        ("workers: 2", "workers: 0"),
    ],
)
def test_a_mutated_campaign_does_not(old, new):
    assert old in QUICKSTART
    assert not SCHEMA.is_valid(read_text(QUICKSTART.replace(old, new)).data)


def test_the_schema_names_and_describes_everything():
    properties = campaign_schema()["properties"]
    assert properties["variables"]["properties"].keys() == PARAMETERS.keys()
    assert properties["objectives"]["properties"].keys() == {*QUANTITIES, "failed_share"}
    assert properties["strategies"]["properties"].keys() == METHODS.keys()
    for section in ("variables", "objectives", "constraints", "reference_point", "strategies"):
        assert all(entry["description"] for entry in properties[section]["properties"].values())
    assert "in m " in properties["variables"]["properties"]["spool_radius"]["description"]


EVENT = {"at": "10 ms", "load": 1, "to": "12 MPa", "load_pressures": ["1 MPa", "2 MPa"], "source_flow": "1 L/min"}
SCENARIO = {"start": "cold", "horizon": "2 s", "end": "2 s", "step": {"load": 1}, "accumulation_time": "0.1 s"}


def some_of(fields):
    """Each field as it is, null, or left out; the null that no field permits is that of `start`."""
    chosen = {name: st.sampled_from([value, None, ...]) for name, value in fields.items()}
    kept = st.fixed_dictionaries(chosen).map(lambda made: {k: v for k, v in made.items() if v is not ...})
    return kept.filter(
        lambda made: made.get("start", "") is not None and made.get("accumulation_time", "") is not None
    )


@settings(max_examples=300)
@given(scenario=some_of(SCENARIO), at=st.sampled_from([None, "10 ms"]), events=st.lists(some_of(EVENT), max_size=1))
def test_the_schema_takes_a_scenario_that_the_loader_takes_and_no_other(scenario, at, events):
    if scenario.get("step") and at:
        scenario = {**scenario, "step": {"load": 1, "at": at}}
    if events:
        scenario = {**scenario, "events": events}
    data = {**read_text(QUICKSTART).data, "model": {"kind": "divider", "scenario": scenario}}
    try:
        parse_campaign(json.dumps(data))
    except FileMistakes as error:
        untimed = scenario.get("start") == "cold" and events and events[0].get("at") is None
        assert untimed or not SCHEMA.is_valid(data), str(error)  # of the events' times a schema knows nothing
    else:
        SCHEMA.validate(data)


MEASURES = [
    "6 mm",
    "6",
    " 6.mm ",
    "+.5e-3 m^3/s",
    "1 1/s",
    "6 m m",
    "6^800000 m",
    "1 m**9",
    "1 (m)",
    "1_0 mm",
    "nan",
    "",
]
MEASURES += [
    "\u0661 m",
    "6 m^10",
    "1 m^-9",
    "6 m*m*m*m*m*m",
    "6 m*m*m*m*m*m*m",
    "6 " + "m" * 24,
    "6 " + "m" * 25,
    "0.5 %",
]
MEASURES += [
    "1" * 77 + " m",
    "1" * 79 + " m",
    "1e999 m",
    "1e9999 m",
    "6 mm\n",
    "6 \u00b5m",
    "6 m;m",
    "0x6 m",
    "'6 mm'",
]


@pytest.mark.parametrize("text", MEASURES)
def test_the_schema_knows_the_grammar_of_measures(text):
    """What it takes for a length fails by its unit or its size, if at all; what it refuses does not reach pint."""
    data = read_text(QUICKSTART).data
    data["variables"]["spool_radius"][0] = text
    try:
        parse_campaign(json.dumps(data))
    except FileMistakes as error:
        ungrammatical = "is not a number with a unit" in str(error) or "has no unit" in str(error)
        assert SCHEMA.is_valid(data) != ungrammatical, str(error)
    else:
        SCHEMA.validate(data)
