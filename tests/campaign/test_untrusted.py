"""Campaign files that nobody would write, or somebody with a purpose: right, or refused in sentences, at once."""

import importlib.util
import os
import sys
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from divideropt.campaign.dump import dump_campaign
from divideropt.campaign.load import load_campaign, parse_campaign
from divideropt.campaign.reader import LARGEST_FILE, LONGEST_LINE, MOST_LINES, MOST_MISTAKES, MOST_VALUES
from divideropt.errors import FileMistakes, UsageError

ROOT = Path(__file__).parents[2]
QUICKSTART = (ROOT / "campaigns" / "quickstart.yaml").read_text("utf-8")
MOST_SECONDS = 2.0
"""Of the processor's time: what else the machine does shall not fail a test."""


def _fuzz():
    """`benchmarks/fuzz.py`, which judges thousands and is a command; here it judges some hundred."""
    spec = importlib.util.spec_from_file_location("divideropt_fuzz", ROOT / "benchmarks" / "fuzz.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["divideropt_fuzz"] = module
    spec.loader.exec_module(module)
    return module


FUZZ = _fuzz()


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    found = tmp_path_factory.mktemp("fuzz") / "campaign.yaml"
    assert FUZZ.judge(QUICKSTART.encode(), found).code == 0, "and what is imported late is there"
    return found


@pytest.mark.parametrize("kind", FUZZ.KINDS)
@settings(max_examples=100, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_mutated_campaign_file_is_right_or_refused_in_sentences_within_two_seconds(kind, path, data):
    content = FUZZ.KINDS[kind](data.draw(st.randoms(use_true_random=False)))
    found = FUZZ.judge(content, path)
    assert found.code in (0, 2)
    assert not found.bug
    assert found.seconds < MOST_SECONDS


@pytest.mark.parametrize("kind", FUZZ.KINDS)
def test_some_are_right_and_most_are_not(kind, path):
    codes = [FUZZ.judge(FUZZ.case(0, f"{kind}:{i}"), path).code for i in range(60)]
    assert 0 < codes.count(0) < codes.count(2)


def many(line, count=9_000):
    return "".join(line.format(i) for i in range(count))


HOSTILE = {
    "brackets": "a: " + "[" * 19_000,
    "maps": "".join(" " * i + "a:\n" for i in range(1400)),
    "a scalar": "name: " + "x" * 19_000,
    "a scalar of many lines": "name: |\n" + " x\n" * 19_000,
    "a plain scalar of many lines": "name: x\n" + " x\n" * 19_000,
    "escapes": many('k{}: "' + "\\x41" * 15 + '"\n', 4_900),
    "a tag": "a: !<" + "x" * 19_000 + "> 1",
    "tags": many("k{}: !<" + "x" * 190 + "> 1\n", 4_000),
    "an anchor": "a: &" + "x" * 19_000 + " 1",
    "aliases": many("k{}: *a\n"),
    "directives": "%a\n" * 19_000,
    "documents": "---\n" * 19_000,
    "a line": "#" * LARGEST_FILE,
    "lines": "\n" * LARGEST_FILE,
    "lines that a Mac ends": "\r" * LARGEST_FILE,
    "keys": many("k{}: 1\n", 4_900),
    "keys twice": "k: 1\n" * 9_000,
    "long keys twice": many("x" * 150 + ": 1\n", 4_900),
    "events": QUICKSTART.replace("scenario:", "scenario:\n      events: [" + "{},\n " * 4_000 + "{}]\n    extra:"),
    "scenarios": QUICKSTART.replace("model:", "model:\n  scenarios:\n" + many("    s{}: {{}}\n", 2_000)),
    "units": QUICKSTART.replace(
        "model:",
        "model:\n  scenarios:\n" + many("    s{0}: {{horizon: 1 mm*m*s{0}, source_flow: 1 zz{0}a, end: 1 m}}\n", 50),
    ),
    "seeds": QUICKSTART.replace("seeds: [1]", "seeds: [" + "1,\n  " * 4_900 + "1]", 1),
    "a whole number": QUICKSTART.replace("population: 40", "population: " + "9" * 19_000),
    "a hexadecimal number": QUICKSTART.replace("population: 40", "population: 0x" + "f" * 19_000),
    "an exponent": QUICKSTART.replace("population: 40", "population: 1e999999999"),
    "a measure": QUICKSTART.replace("[6 mm,", "[" + "9" * 19_000 + " mm,"),
    "a power": QUICKSTART.replace("[6 mm,", "[6^800000 m,"),
    "a power of a unit": QUICKSTART.replace("[6 mm,", "[1 m**9999999,"),
    "parentheses": QUICKSTART.replace("[6 mm,", "[1 " + "(" * 9_000 + "m" + ")" * 9_000 + ","),
    "a number": QUICKSTART.replace("[0.3,", "[" + "9" * 19_000 + ","),
    "a word for a scenario": QUICKSTART.replace(
        "{max: 30 MPa}", "{max: 30 MPa, worst_of: [" + "a,\n  " * 4_800 + "a]}"
    ),
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_a_hostile_file_is_refused_at_once_and_briefly(text):
    assert len(text) <= LARGEST_FILE
    begin = time.process_time()
    with pytest.raises(UsageError) as caught:
        parse_campaign(text)
    assert time.process_time() - begin < MOST_SECONDS
    said = str(caught.value)
    assert all(line.isprintable() and len(line) < 600 for line in said.split("\n"))
    assert said.count("\n") <= MOST_MISTAKES


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("a: 1\n" + "#" * LONGEST_LINE + "\n", None, ""),
        ("a: 1\n" + "#" * (LONGEST_LINE + 1) + "\n", (2, LONGEST_LINE + 1), "most permitted"),
        ("\n" * (MOST_LINES - 1) + "a: 1\n", None, ""),
        ("\n" * MOST_LINES + "a: 1\n", (MOST_LINES + 1, 1), f"more than {MOST_LINES} lines"),
        ("a: [" + "1,\n" * MOST_VALUES + "1]", (9996, 1), f"more than {MOST_VALUES} keys and values"),
    ],
)
def test_a_limit_is_where_it_is_said_to_be(text, place, words):
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(text)
    first = caught.value.mistakes[0]
    assert (place is None) == ("missing" in first.message or "not known" in first.message)
    if place:
        assert (first.line, first.column) == place
        assert words in first.message


@pytest.mark.parametrize("given", ["step", "horizon", "end"])
def test_an_explicit_null_is_as_good_as_nothing(given):
    """It once made a store that refused its own campaign; the fuzzer found it."""
    section = f"  scenario: {{{given}: null}}\nvariables:"
    campaign = parse_campaign(
        f"{QUICKSTART.partition('  scenario:')[0]}{section}{QUICKSTART.partition('variables:')[2]}"
    )
    assert campaign == parse_campaign(dump_campaign(campaign))


def test_more_mistakes_than_anybody_reads_are_counted():
    texts = ", ".join(f"a{i}" for i in range(150))
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(QUICKSTART.replace("{max: 30 MPa}", f"{{max: 30 MPa, worst_of: [{texts}]}}"))
    assert len(caught.value.mistakes) == MOST_MISTAKES + 1
    assert caught.value.mistakes[-1].message == "from here on are 50 mistakes more"


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "c.yaml")
    with pytest.raises(UsageError, match="a pipe or a device"):
        load_campaign(tmp_path / "c.yaml")


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null", "/dev/urandom"])
def test_a_device_is_not_read(path):
    with pytest.raises(UsageError, match="a pipe or a device"):
        load_campaign(path)


def test_a_sparse_file_of_two_gibibytes_is_not_read(tmp_path):
    path = tmp_path / "c.yaml"
    with path.open("wb") as file:
        file.truncate(2**31)
    with pytest.raises(UsageError, match="larger than 1 MiB"):
        load_campaign(path)


def test_a_link_to_itself_is_refused(tmp_path):
    (tmp_path / "c.yaml").symlink_to(tmp_path / "c.yaml")
    with pytest.raises(UsageError, match="cannot be read"):
        load_campaign(tmp_path / "c.yaml")


@pytest.mark.parametrize(
    "name",
    [
        *(
            "..",
            ".",
            ".a",
            "a/b",
            "a\\b",
            "/a",
            "~",
            "",
            " ",
            "a ",
            "-a",
            "a.b",
            "a\n",
            "a\0",
            "\x1b[31m",
            "é",
            "e\u0301",
        ),
        *("\uff41", "a" * 65, "a" * 300, "con", "CON", "Nul", "aux", "prn", "com1", "LPT9"),
    ],
)
def test_a_name_that_cannot_be_a_folders_is_refused(name):
    quoted = "".join(f"\\U{ord(c):08x}" for c in name)
    with pytest.raises(FileMistakes, match=r"^campaign:3:7: name: .* cannot name the folder of results"):
        parse_campaign(QUICKSTART.replace("name: quickstart", f'name: "{quoted}"'))


@pytest.mark.parametrize("name", ["a", "A-1_b", "console", "con1", "com", "com10", "1", "0x1F", "a" * 64])
def test_a_name_that_can_is_not(name):
    assert parse_campaign(QUICKSTART.replace("name: quickstart", f'name: "{name}"')).name == name


def test_a_files_words_do_not_steer_a_terminal():
    with pytest.raises(FileMistakes) as caught:
        parse_campaign(QUICKSTART + '"a\\e[31m\\nb\\u202e": 1\n')
    assert str(caught.value).isprintable()
    assert r"a\x1b[31m\nb\u202e" in str(caught.value)
