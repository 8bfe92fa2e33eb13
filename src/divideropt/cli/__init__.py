"""The command line: parse, call, exit code. Data goes to standard output, words to standard error."""

from divideropt.cli.program import commands, main

__all__ = ["commands", "main"]
