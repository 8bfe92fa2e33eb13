"""Damages every file of a store, in many ways each, and asks every command what it makes of it.

    python benchmarks/damage.py [--times 100]
    python benchmarks/damage.py --page-checksums

Each file is cut off at so many random places, and has a random bit turned at so many. Each time `status`, `report`,
`verify` and `run` are called on a copy. Right is what says and leaves the same as on the whole store, or exit code 4
with the file's name; anything else is counted as wrong, and the command ends with 1.

The second form counts what parquet's own page checksums would have let through: it turns every fifth bit of a part.
"""

import argparse
import json
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from unittest import mock

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
from failpoints import CAMPAIGN, same, tables

from divideropt import cli
from divideropt.errors import DivideroptError
from divideropt.store import parts

REFUSED = 4

UNREAD = ("report.html", ".lock", ".owner")
"""What no command reads; and what is in .running, a display's."""


@dataclass(frozen=True)
class Answer:
    """What a command said.

    Attributes:
        code: Its exit code.
        data: On standard output.
        words: On standard error.
    """

    code: int
    data: str
    words: str


def main() -> None:
    """Print the counts, and end with 1 where a command was wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--times", type=int, default=100, help="How often each file is cut off, and a bit turned.")
    parser.add_argument("--page-checksums", action="store_true", help="What these alone would let through.")
    asked_for = parser.parse_args()
    if asked_for.page_checksums:
        page_checksums_alone()
        return
    times = asked_for.times
    parts.FLUSH_ROWS, parts.FLUSH_SECONDS = 40, 1e9  # two parts or three a run, none of them by the clock
    plotly = mock.patch("divideropt.report.document.plotly_for", lambda kinds: "")  # megabytes, the same in each
    with plotly, tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "toy.yaml").write_text(CAMPAIGN.replace("GENERATIONS", "6"), encoding="utf-8")
        asked("run", str(folder / "toy.yaml"), "--store", str(folder / "whole"))
        sys.exit(0 if damage_all(folder, times) else 1)


def damage_all(folder: Path, times: int) -> bool:
    """Damage each file of the store `whole`, and print what came of it."""
    whole, store = folder / "whole", folder / "damaged"
    commands = {
        "status": ("status", str(store), "--json"),
        "report": ("report", str(store)),
        "verify": ("verify", str(store)),
        "run": ("run", str(folder / "toy.yaml"), "--store", str(store)),
    }
    expected = {}
    for name, command in commands.items():
        fresh_copy(whole, store)
        expected[name] = (asked(*command), tables(store), page(store))
    random, wrong = np.random.default_rng(1), 0
    print(f"{'file':52} {'damage':9} {'same':>6} {'refused':>8} {'wrong':>6}")
    for path in sorted(p.relative_to(whole) for p in whole.rglob("*") if p.is_file()):
        if path.name in UNREAD or ".running" in path.parts:
            continue
        for kind, damaged in (("cut off", cut_off), ("bit", bit_turned)):
            counts: Counter[str] = Counter()
            for content in damaged((whole / path).read_bytes(), times, random):
                for name, command in commands.items():
                    fresh_copy(whole, store)
                    (store / path).write_bytes(content)
                    answer = asked(*command)
                    if answer.code == REFUSED and path.name in answer.words:
                        counts["refused"] += 1
                        continue
                    before, logged, drawn = expected[name]
                    right = answer.code == before.code and said(answer.data) == said(before.data)
                    right &= same_tables(tables(store), logged) if name in ("verify", "run") else True
                    right &= page(store) == drawn
                    counts["same" if right else "wrong"] += 1
                    if not right:
                        print(f"{path}, {name}: exit code {answer.code}: {answer.words[-300:]}")
            wrong += counts["wrong"]
            print(f"{path!s:52} {kind:9} {counts['same']:6} {counts['refused']:8} {counts['wrong']:6}", flush=True)
    print(f"{wrong} wrong")
    return wrong == 0


def page_checksums_alone() -> None:
    """Print how a part with every fifth bit turned, one at a time, is read where only the pages have checksums."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.parquet"
        random = np.random.default_rng(1)
        columns = {name: pa.array(random.random(24)) for name in ("x1", "x2", "x3", "f1", "f2", "spare")}
        texts = {"design_id": [f"nsga2-1/{i}" for i in range(24)], "outcome": ["ok"] * 20 + ["unsettled"] * 4}
        whole = pa.table({**texts, "batch": np.repeat([0, 1], 12), **columns})
        pq.write_table(whole, path, write_page_checksum=True)
        content, counts = path.read_bytes(), Counter[str]()
        for bit in range(0, 8 * len(content), 5):
            damaged = bytearray(content)
            damaged[bit // 8] ^= 1 << bit % 8
            try:
                table = pq.ParquetFile(pa.BufferReader(bytes(damaged)), page_checksum_verification=True).read()
            except (pa.ArrowException, OSError, ValueError):
                counts["refused"] += 1
                continue
            if not table.schema.equals(whole.schema):
                counts["refused, by its columns"] += 1
            else:
                counts["read right" if table.equals(whole) else "read wrong"] += 1
    print(f"{counts.total()} bits: " + ", ".join(f"{count} {name}" for name, count in sorted(counts.items())))


def cut_off(content: bytes, times: int, random: np.random.Generator) -> Iterator[bytes]:
    """The content up to random places."""
    for place in random.integers(0, len(content), times):
        yield content[:place]


def bit_turned(content: bytes, times: int, random: np.random.Generator) -> Iterator[bytes]:
    """The content with a random bit turned."""
    for place in random.integers(0, len(content), times):
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(random.integers(8))
        yield bytes(damaged)


def fresh_copy(whole: Path, store: Path) -> None:
    """Put the whole store in the place of the damaged one."""
    shutil.rmtree(store, ignore_errors=True)
    shutil.copytree(whole, store)


def asked(*command: str) -> Answer:
    """Call a command of divideropt's here; a mistake it names becomes its exit code, a bug is raised."""
    data, words = StringIO(), StringIO()
    with redirect_stdout(data), redirect_stderr(words):
        try:
            code = cli.commands.main(list(command), standalone_mode=False) or 0
        except DivideroptError as error:
            code = error.exit_code
            words.write(str(error))
    return Answer(code, data.getvalue(), words.getvalue())


def said(data: str) -> object:
    """What a status says, but for the damage it names."""
    return {k: v for k, v in json.loads(data).items() if k != "damage"} if data else None


def page(store: Path) -> str:
    """The tables of the report's page but that of its provenance, which names nobody where that file is damaged."""
    text = (store / "report.html").read_text(encoding="utf-8").partition('<section id="provenance"')[0]
    return text[text.index("<table") : text.rindex("</table>")]


def same_tables(found: dict[str, pd.DataFrame], expected: dict[str, pd.DataFrame]) -> bool:
    """Whether two stores' tables are the same, to the bit."""
    return list(found) == list(expected) and all(same(found[name], expected[name]) for name in expected)


if __name__ == "__main__":
    main()
