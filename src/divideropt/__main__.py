"""`python -m divideropt`."""

from divideropt.cli import main

main()
