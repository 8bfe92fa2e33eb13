import subprocess
import sys

import numba
import pytest

from divideropt.ode import compiled as module
from divideropt.ode.compiled import compiled

EVALUATE = """
import numpy as np
from divideropt.models.divider import Divider, parameter_set
from divideropt.models.divider import groove_kernels, kernels, solver_kernels, transient
from divideropt.ode import interpolate, linear, rosenbrock

model = Divider()
model.evaluate(np.array([list(parameter_set("thesis_base").values())]))
dispatchers = {
    id(f): f
    for module in (kernels, groove_kernels, solver_kernels, transient, rosenbrock, linear, interpolate)
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
    (package / "other.py").write_text("nothing compiled\n")
    assert module._folder() != first


def test_a_users_own_cache_folder_is_respected_and_nothing_else_is_touched() -> None:
    given = numba.config.CACHE_DIR
    compiled(lambda x: x + 1)
    assert given == numba.config.CACHE_DIR


@pytest.mark.parametrize("x", [0.0, 1.5])
def test_what_is_compiled_computes_the_same(x) -> None:
    assert compiled(_square)(x) == _square(x)


def _square(x):
    return x * x
