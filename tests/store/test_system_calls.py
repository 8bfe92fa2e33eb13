"""The order of system calls of a write, as the kernel sees it: written, forced, named, and the folder forced."""

import os
import re
import shutil
import subprocess
import sys

import pytest

if shutil.which("strace") is None:
    if os.environ.get("DIVIDEROPT_NEED_STRACE"):
        pytest.fail("strace is not installed, and this run may not do without it", pytrace=False)
    pytest.skip("needs strace", allow_module_level=True)

SCRIPT = """
import sys; from pathlib import Path
import numpy as np
from divideropt.store import Store, TableSchema
from toy_model import toy_problem
problem = toy_problem()
schema = TableSchema.of(problem)
store = Store(Path(sys.argv[1]))
evaluations = problem.simulate(problem.space.sample(7, np.random.default_rng(1)))
with store.writing():
    log = store.log("nsga2-1", schema)
    for step in ("first part", "second part", "first front", "second front"):
        print(step, flush=True)
        if step.endswith("part"):
            log.append(evaluations); log.flush()
        else:
            store.write_front("nsga2-1", schema.front.empty_table())
"""

CALLS = "write,fsync,fdatasync,mkdir,link,linkat,rename,renameat,renameat2,unlink,unlinkat"


@pytest.fixture(scope="module", name="calls")
def _calls(tmp_path_factory):
    """What the kernel was asked after each step was announced: pairs of a call and a path in the store."""
    folder = tmp_path_factory.mktemp("traced")
    trace, store = folder / "trace", folder / "store"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    command = [
        "strace",
        "-f",
        "-y",
        "-s",
        "4096",
        "-e",
        f"trace={CALLS}",
        "-o",
        trace,
        sys.executable,
        "-c",
        SCRIPT,
        store,
    ]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if "Operation not permitted" in done.stderr and not os.environ.get("DIVIDEROPT_NEED_STRACE"):
        pytest.skip("nothing may be traced here")
    assert done.returncode == 0, done.stderr
    found: dict[str, list[tuple[str, ...]]] = {}
    asked: list[tuple[str, ...]] = []
    for line in trace.read_text(errors="replace").splitlines():
        announced = re.search(r'write\(1<[^>]*>, "((?:first|second) \w+)', line)
        if announced:
            asked = found.setdefault(announced[1], [])
        elif str(store) in line:
            name = re.search(r"(\w+)\(", line)[1].removesuffix("at").removesuffix("at2")
            paths = [re.sub(r"\.new-\d+-\w+-", "NEW-", p) for p in re.findall(rf'[<"]{store}/?([^>"]*)[>"]', line)]
            asked.append((name, *paths))
    return found


def test_a_part_is_written_forced_linked_and_its_folder_forced(calls):
    folder = "evaluations/nsga2-1"
    new, part = f"{folder}/NEW-part-000000007.parquet", f"{folder}/part-000000007.parquet"
    assert calls["second part"] == [
        ("write", new), ("fsync", new), ("link", new, part), ("unlink", new), ("fsync", folder),
    ]  # fmt: skip


def test_a_front_is_written_forced_renamed_and_its_folder_forced(calls):
    new, front = "fronts/NEW-nsga2-1.parquet", "fronts/nsga2-1.parquet"
    assert calls["second front"][:4] == [("write", new), ("fsync", new), ("rename", new, front), ("fsync", "fronts")]


@pytest.mark.parametrize(
    ("step", "folder", "file"),
    [
        ("first part", "evaluations/nsga2-1", "part-000000000.parquet"),
        ("first front", "fronts", "nsga2-1.parquet"),
    ],
)
def test_a_folder_is_forced_with_its_first_file_before_it_gets_its_name(calls, step, folder, file):
    above, _, name = folder.rpartition("/")
    new = f"{above}/NEW-{name}".lstrip("/")
    made = [("mkdir", above), ("fsync", "")] if above else []
    assert calls[step] == [
        *made,
        ("mkdir", new),
        ("write", f"{new}/{file}"),
        ("fsync", f"{new}/{file}"),
        ("fsync", new),
        ("rename", new, folder),
        ("fsync", above),
    ]
