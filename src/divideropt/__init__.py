"""Multiobjective optimisation of simulated hydraulic components.

The commands are functions here, for notebooks and scripts: `divideropt.run("campaign.yaml").front()`; see
`divideropt.api`. They are imported when they are first used, so that `import divideropt` is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from divideropt.api import (
        check,
        compare,
        error_budget,
        evaluate,
        export,
        open,
        run,
        sensitivity,
        sheet,
        simulate,
        status,
        verify,
    )

__all__ = [
    "check",
    "compare",
    "error_budget",
    "evaluate",
    "export",
    "open",
    "run",
    "sensitivity",
    "sheet",
    "simulate",
    "status",
    "verify",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for (PEP 562)."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = globals()[name] = getattr(import_module("divideropt.api"), name)
    return found


def __dir__() -> list[str]:
    """List the public names, imported or not."""
    return sorted({*globals(), *__all__})
