"""The model's own compiled loop with the coefficients of another Rosenbrock method.

numba compiles a module's constants in. So the sources of the loop are executed once more, as modules of their own in
which the tableau is another one. These are compiled anew each time: nothing on disk would say which tableau is meant.
"""

import inspect
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numba
import numpy as np

from divideropt.models.divider import run_kernels
from divideropt.models.divider.states import N_STATES
from divideropt.ode import rodas5p, rosenbrock


def loop_with(tableau: ModuleType) -> tuple[Callable[..., Any], Any]:
    """Return `loops.integrate_often` with another method, and a function from a budget of steps to its workspace.

    Args:
        tableau: A module with what `divideropt.ode.rodas5p` has.
    """
    here = f"{__name__}.{tableau.__name__.rpartition('.')[2]}"
    names = {rodas5p.__name__: tableau.__name__}
    pieces = _executed(rosenbrock, f"{here}_pieces", names | {_SUMS: f"STAGES - {_sums(tableau)}"})
    loop = _executed(run_kernels, f"{here}_loop", names | {rosenbrock.__name__: pieces.__name__})
    run = loop.run

    @numba.njit(nogil=True, error_model="numpy")
    def often(times, start, arguments):  # type: ignore[no-untyped-def]
        design, first, last, limit, s, k, y, u, increments, rtol, atol, bound, edges, values = arguments
        ending = 0
        for _ in range(times):
            for i in range(y.size):
                y[i] = start[i]
            ending = run(design, first, last, limit, s, k, y, u, increments, rtol, atol, bound, edges, values)
        return ending

    return often, lambda limit: pieces.Workspace(N_STATES, limit)


_SUMS = "STAGES - 2"
"""How the source says from which stage on a state is the one before plus its increment."""


def _sums(tableau: ModuleType) -> int:
    """Count the last stages whose state is the one before plus its increment."""
    count, a = 0, tableau.A
    while np.array_equal(a[-1 - count], a[-2 - count] + np.eye(len(a))[-2 - count]):
        count += 1
    return count


def _executed(original: ModuleType, name: str, changes: dict[str, str]) -> ModuleType:
    """Execute a module's source under another name, with words exchanged, compiled without a cache."""
    source = inspect.getsource(original)
    for word, other in {**changes, "from divideropt.ode.compiled import": f"from {__name__} import"}.items():
        if word not in source:
            raise SystemExit(f"{original.__name__} no longer says {word!r}: mend {__name__}.py")
        source = source.replace(word, other)
    module = ModuleType(name)
    sys.modules[name] = module
    exec(compile(source, name, "exec"), vars(module))
    return module


def compiled(function: Callable[..., Any]) -> Any:
    """Compile at the first call, as `divideropt.ode.compiled` does, without its cache."""
    return numba.njit(nogil=True, error_model="numpy")(function)
