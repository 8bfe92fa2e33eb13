"""Thousands of campaign files that nobody would write: each is right or refused in sentences, and at once.

    python benchmarks/fuzz.py [--count 3000] [--seed 0]      files of each kind; counts, and the slowest
    python benchmarks/fuzz.py --show bytes:17                 one of them, and what `divideropt check` says of it

Kinds: `schema`, generated from the JSON schema of campaigns; `values`, shipped campaigns with values, keys and lists
changed; `bytes`, their text with bytes flipped, deleted, doubled and put in.
"""

import argparse
import io
import json
import re
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from contextlib import redirect_stderr
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from divideropt.campaign.dump import campaign_schema, dump_campaign
from divideropt.campaign.load import load_campaign, parse_campaign
from divideropt.campaign.plan import build_problem, plan_runs
from divideropt.campaign.reader import read_text
from divideropt.cli import main as divideropt

LONGEST = 2.0
"""No file may take longer to judge [s], of the processor's time, which others on the machine do not stretch."""

CAMPAIGNS = [path.read_text("utf-8") for path in sorted((Path(__file__).parents[1] / "campaigns").glob("*.yaml"))]
SCHEMA = campaign_schema()

NUMBERS = (0, 1, -1, 2, 40, 1e-3, 0.5, -0.0, 1e308, 1e-320, 2**31, 2**63, 10**30, 10**4000)
# fmt: off
STRINGS = (
    "", " ", "6 mm", "1 MPa", "0.5 %", "1 1/s", "6", "1e999 m", "1e-999 m", "6^800000 m", "1 m**99", "((1)) m",
    "1 dB", "1 degC", "\u0661 m", "1_0 mm", "nan", "../x", "con", "a" * 300, "a:b", "os:system", "\0", "\x1b[31m",
    "\u2028", "\ud800", "\U0001f600", "e\u0301", "{{7*7}}", "</script>", "*a", "&a", "!!int", "<<", "0x1F", "~",
)
SNIPPETS = (
    b"\t", b"&a ", b"*a", b"!!int ", b"!!python/object/apply:os.system ", b"<<: {}\n", b"\n---\n", b"{", b"}", b"[",
    b"]", b": ", b"- ", b"'", b'"', b"|\n", b">\n", b"#", b"%", b"1e999", b".nan", b"-.inf", b"true", b"null", b"? ",
    b"dB", b"\0", b"\r", b"\r\n", b"\xef\xbb\xbf", b"\xff", b"\xc3\xa9", b"\xe2\x80\xa8", b"\xc2\x85", b'"\\ud800"',
    b"99999999999999999999", b"[" * 50, b"{a: " * 40, b"- " * 40, b"6^800000 m", b"!<" + b"x" * 300 + b">",
)
# fmt: on
_UNIT = re.compile(r'such as "1 (\S+)"')


@dataclass(frozen=True)
class Judgement:
    """What became of a file: exit code and words of `check`, the processor time it took [s], a bug's traceback."""

    code: int
    words: str
    seconds: float
    bug: str = ""


def main() -> int:
    """Judge so many files of each kind, and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=3000, help="files of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--show", metavar="KIND:NUMBER", help="one file, and what is said of it")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "campaign.yaml"
        if asked.show:
            content = case(asked.seed, asked.show)
            sys.stdout.buffer.write(content + b"\n")
            print(judge(content, path))
            return 0
        judge(CAMPAIGNS[0].encode(), path)  # what the first call imports and compiles is no file's fault
        return sum([_judge_all(kind, asked.count, asked.seed, path) for kind in KINDS]) > 0


def judge(content: bytes, path: Path) -> Judgement:
    """Write a file and let `divideropt check` judge it; one that is right must make a problem and survive as text.

    Args:
        content: The file.
        path: Where to write it.
    """
    path.write_bytes(content)
    words = io.StringIO()
    arguments, sys.argv = sys.argv, ["divideropt", "check", str(path)]
    begin = time.process_time()
    try:
        with redirect_stderr(words):
            divideropt()
    except SystemExit as left:
        code = int(left.code or 0)
    finally:
        seconds = time.process_time() - begin
        sys.argv = arguments
    said = words.getvalue()
    bug = said if code not in (0, 2) or "Traceback" in said or not _in_sentences(said) else ""
    return Judgement(code, said, seconds, bug or (_unusable(path) if code == 0 else ""))


def from_schema(random: Random) -> bytes:
    """Generate a campaign from the schema."""
    return _written(_generated(SCHEMA, random, 0), random)


def from_values(random: Random) -> bytes:
    """Change a few values, keys and lists of a shipped campaign."""
    data: Any = read_text(random.choice(CAMPAIGNS)).data
    for _ in range(random.choice((1, 1, 2, 4))):
        _change(data, random)
    return _written(data, random)


def from_bytes(random: Random) -> bytes:
    """Change a few bytes of a shipped campaign."""
    content = bytearray(random.choice(CAMPAIGNS).encode())
    for _ in range(random.choice((1, 1, 1, 2, 6))):
        at = random.randrange(len(content) + 1)
        to = min(len(content), at + random.choice((1, 1, 2, 8, 60)))
        edit = random.choice(("flip", "delete", "double", "insert", "insert", "byte", "cut"))
        if edit == "flip" and at < len(content):
            content[at] ^= 1 << random.randrange(8)
        elif edit == "delete":
            del content[at:to]
        elif edit == "double":
            content[at:at] = content[at:to] * random.choice((1, 1, 2, 100))
        elif edit == "insert":
            content[at:at] = random.choice(SNIPPETS)
        elif edit == "byte":
            content[at:at] = bytes([random.randrange(256)])
        elif edit == "cut" and random.random() < 0.2:
            del content[at:]
    return bytes(content)


KINDS: dict[str, Callable[[Random], bytes]] = {"schema": from_schema, "values": from_values, "bytes": from_bytes}


def case(seed: int, name: str) -> bytes:
    """Make the file of a name, `KIND:NUMBER`, of a seed."""
    kind, _, number = name.partition(":")
    return KINDS[kind](Random(f"{seed}:{kind}:{number}"))


def _judge_all(kind: str, count: int, seed: int, path: Path) -> int:
    """Judge files of a kind, print a line, and the bugs; return how many there are, slow ones among them."""
    codes: Counter[int] = Counter()
    slowest, bugs, begin = (0.0, ""), 0, time.perf_counter()
    for number in range(count):
        name = f"{kind}:{number}"
        found = judge(case(seed, name), path)
        codes[found.code] += 1
        slowest = max(slowest, (found.seconds, name))
        if found.bug or found.seconds > LONGEST:
            bugs += 1
            print(f"{name} takes {found.seconds:.2f} s and exit code {found.code}\n{found.bug}")
    print(
        f"{kind}: {count} files in {time.perf_counter() - begin:.0f} s: {codes[0]} right, {codes[2]} refused, "
        f"{bugs} bugs; the slowest, {slowest[1]}, took {slowest[0]:.2f} s",
        flush=True,
    )
    return bugs


def _in_sentences(said: str) -> bool:
    """Whether nothing that was said could steer a terminal, or is endless."""
    return all(line.isprintable() for line in said.split("\n")) and len(said) < 100_000


def _unusable(path: Path) -> str:
    """Say why a campaign that is right cannot be run or stored, if so."""
    try:
        campaign = load_campaign(path)
        build_problem(campaign)
        plan_runs(campaign)
        same = parse_campaign(dump_campaign(campaign)) == campaign
    except Exception:
        return traceback.format_exc()
    return "" if same else "it is another after the way to text and back"


def _generated(schema: dict[str, Any], random: Random, depth: int) -> Any:
    """Draw a value that a schema permits, by and large; at times one that it does not."""
    if random.random() < 0.003:
        return random.choice((*NUMBERS, *STRINGS, None, True, [], {}))
    if "$ref" in schema:
        schema = SCHEMA["$defs"][schema["$ref"].rpartition("/")[2]]
    if "anyOf" in schema:
        return _generated(random.choice(schema["anyOf"]), random, depth)
    kinds = schema.get("type", "object")
    kind = kinds if isinstance(kinds, str) else random.choice([*kinds, *(k for k in kinds[:1] * 4)])
    if "enum" in schema:
        return random.choice(schema["enum"])
    if kind == "object":
        return _object(schema, random, depth)
    if kind == "array":
        least = schema.get("minItems", 0)
        count = random.randint(least, max(least, min(schema.get("maxItems", 3), 5)))
        items = [*schema.get("prefixItems", ()), *[schema.get("items", {"type": "string"})] * count][:count]
        told = {"description": schema.get("description", "")}  # of a range, which says its unit once
        made = [_generated(told | item, random, depth + 1) for item in items]
        if schema.get("uniqueItems"):
            made = [item for i, item in enumerate(made) if item not in made[:i]]
        return sorted(made, key=lambda item: (len(str(item)), str(item))) if random.random() < 0.5 else made
    return _scalar(kind, schema, random)


def _scalar(kind: str, schema: dict[str, Any], random: Random) -> object:
    if kind == "null":
        return None
    return _string(schema, random) if kind == "string" else _number(schema, random)


def _object(schema: dict[str, Any], random: Random, depth: int) -> dict[str, Any]:
    known = schema.get("properties", {})
    wanted = set(schema.get("required", ()))
    share = 1.5 / max(3, len(known))
    names = [name for name in known if name in wanted or random.random() < share]
    if len(names) < schema.get("minProperties", 0):
        names = [random.choice(list(known))]
    made = {name: _generated(known[name], random, depth + 1) for name in names}
    more = schema.get("additionalProperties")
    if isinstance(more, dict) and random.random() < 0.2:
        made |= {f"name_{i}": _generated(more, random, depth + 1) for i in range(random.randint(1, 3))}
    return made


def _string(schema: dict[str, Any], random: Random) -> str:
    unit = _UNIT.search(schema.get("description", ""))
    if unit:
        return f"{random.choice((1, 2, 5)) * 10.0 ** random.randint(-6, 6)!r} {unit[1]}"
    if "Scenarios" in schema.get("description", ""):
        return "scenario"
    return "fuzzed" if "pattern" in schema else f"{_number(schema, random)!r}"


def _number(schema: dict[str, Any], random: Random) -> float:
    lower: float = schema.get("minimum", schema.get("exclusiveMinimum", 0))
    upper: float = schema.get("maximum", schema.get("exclusiveMaximum", lower + 10))
    if "integer" in schema.get("type", ()):
        return random.choice((lower, random.randint(int(lower), int(min(upper, lower + 20))), upper))
    drawn = [random.uniform(lower, upper)] * 5
    return random.choice([*drawn, float(10.0 ** random.uniform(-9, 9)), lower])


def _change(data: Any, random: Random) -> None:
    """Change one place in nested mappings and lists."""
    places = _places(data)
    if not places:
        return
    inside, key = random.choice(places)
    edit = random.choice(
        ("nudge", "nudge", "replace", "replace", "delete", "rename", "deepen", "lengthen", "exchange")
    )
    if edit == "nudge":
        inside[key] = _nudged(inside[key], random)
    elif edit == "replace":
        inside[key] = random.choice((*NUMBERS, *STRINGS, None, True, False, [], {}, float("inf"), float("nan")))
    elif edit == "delete":
        del inside[key]
    elif edit == "rename" and isinstance(inside, dict):
        inside[random.choice((*STRINGS, str(key)[:-1], f"{key}s", f"{key}.{key}"))] = inside.pop(key)
    elif edit == "deepen":
        for _ in range(random.choice((1, 2, 40))):
            inside[key] = random.choice(([inside[key]], {"a": inside[key]}))
    elif edit == "lengthen":
        inside[key] = [inside[key]] * random.choice((0, 2, 200, 3000))
    else:
        other, name = random.choice(places)
        if key in _keys(inside) and name in _keys(other):
            inside[key] = json.loads(json.dumps(other[name]))


def _nudged(value: Any, random: Random) -> Any:
    """Change the first number in a value a little."""
    if isinstance(value, str):
        return re.sub(r"[0-9]+", lambda m: str(max(0, int(m[0]) + random.randint(-1, 2))), value, count=1)
    return value if isinstance(value, bool | dict | list | None) else value + random.choice((-1, 1, 0.5 * value))


def _places(data: Any) -> list[tuple[Any, Any]]:
    found: list[tuple[Any, Any]] = []
    for key in _keys(data):
        found += [(data, key), *_places(data[key])]
    return found


def _keys(data: Any) -> list[Any]:
    return list(data) if isinstance(data, dict) else list(range(len(data))) if isinstance(data, list) else []


def _written(data: Any, random: Random) -> bytes:
    """Write data as JSON, which is YAML, on lines of their own or in one."""
    text = json.dumps(data, ensure_ascii=random.random() < 0.3, indent=random.choice((None, 1)))
    words = {"Infinity": ".inf", "-Infinity": "-.inf", "NaN": ".nan"}
    return re.sub(r"(?<=[\[ ])(-?Infinity|NaN)\b", lambda m: words[m[1]], text).encode("utf-8", "surrogatepass")


if __name__ == "__main__":
    sys.exit(main())
