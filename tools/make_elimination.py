"""Make the straight-line elimination of the valve's linear systems: `poe elimination`."""

from pathlib import Path

from divideropt.models.divider import pattern
from divideropt.ode.elimination import elimination_source

TARGET = Path(pattern.__file__).with_name("elimination_kernels.py")


def main() -> None:
    """Write the module."""
    TARGET.write_text(elimination_source(pattern.PATTERN, pattern.ORDER), encoding="utf-8")


if __name__ == "__main__":
    main()
