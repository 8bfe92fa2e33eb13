import subprocess
import sys

import numba
import pytest

from divideropt.ode import compiled as module
from divideropt.ode.compiled import compiled

EVALUATE = """
import sys
import numpy as np
from divideropt.models.divider import Divider, parameter_set
from divideropt.models.divider.metrics import measure

design = parameter_set("thesis_base")
for model in (Divider(), Divider("listing")):
    model.evaluate(np.array([list(design.values())]))
    measure(model.respond(design))
dispatchers = {
    id(f): f
    for name, module in sys.modules.items()
    if name.startswith("divideropt")
    for f in vars(module).values()
    if hasattr(f, "stats")
}
print(sum(sum(f.stats.cache_misses.values()) for f in dispatchers.values()))
print(sum(sum(f.stats.cache_hits.values()) for f in dispatchers.values()))
"""


def test_a_second_process_compiles_nothing() -> None:
    for _ in range(2):  # the first may find an empty cache
        run = subprocess.run([sys.executable, "-c", EVALUATE], capture_output=True, text=True, check=True)
    misses, hits = map(int, run.stdout.split())
    assert misses == 0
    assert hits > 5


def test_the_cache_is_in_a_folder_of_the_sources_content(monkeypatch, tmp_path) -> None:
    before = module._folder()
    assert before == module._folder()
    package = tmp_path / "package"
    package.mkdir()
    source = package / "kernel.py"
    source.write_text("from divideropt.ode.compiled import compiled\n")
    monkeypatch.setattr(module, "_PACKAGE", package)
    first = module._folder()
    source.write_text("from divideropt.ode.compiled import compiled  # another\n")
    assert module._folder() != first
    second = module._folder()
    (package / "other.py").write_text("nothing compiled\n")
    assert module._folder() == second


def test_the_constants_that_a_compiled_source_imports_are_part_of_it(monkeypatch, tmp_path) -> None:
    # numba compiles a global in as a constant.
    monkeypatch.setattr(module, "_PACKAGE", tmp_path)
    (tmp_path / "ode").mkdir()
    constants = tmp_path / "ode" / "constants.py"
    constants.write_text("GAMMA = 1\n")
    source = "from divideropt.ode.compiled import compiled\nfrom divideropt.ode.constants import GAMMA\n"
    (tmp_path / "kernel.py").write_text(source)
    before = module._folder()
    constants.write_text("GAMMA = 2\n")
    assert module._folder() != before


def test_a_users_own_cache_folder_is_respected_and_nothing_else_is_touched() -> None:
    given = numba.config.CACHE_DIR
    compiled(lambda x: x + 1)
    assert given == numba.config.CACHE_DIR


@pytest.mark.parametrize("x", [0.0, 1.5])
def test_what_is_compiled_computes_the_same(x) -> None:
    assert compiled(_square)(x) == _square(x)


def _square(x):
    return x * x
