"""Help that teaches: of each command examples first, of the program its commands in the order of their use."""

from collections.abc import Mapping, Sequence
from typing import Any

import click


class Taught(click.Command):
    """A command whose help begins with examples."""

    def __init__(self, *args: Any, examples: Sequence[str], **kwargs: Any) -> None:
        """Take lines that a user may type as they are; the rest as click."""
        super().__init__(*args, **kwargs)
        self.examples = tuple(examples)

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples, then what click writes."""
        write_examples(self.examples, formatter)
        super().format_help(ctx, formatter)


class Headed(click.Group):
    """A group of commands under headings, whose help begins with examples."""

    def __init__(
        self,
        *args: Any,
        examples: Sequence[str],
        headings: Mapping[str, Sequence[click.Command]],
        **kwargs: Any,
    ) -> None:
        """Take examples, and the commands by heading; the rest as click."""
        super().__init__(*args, **kwargs)
        self.examples = tuple(examples)
        self._headings = headings
        for command in (command for members in headings.values() for command in members):
            self.add_command(command)

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples, then what click writes."""
        write_examples(self.examples, formatter)
        super().format_help(ctx, formatter)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands with a line each, under their headings."""
        for heading, members in self._headings.items():
            with formatter.section(heading):
                formatter.write_dl([(str(command.name), command.get_short_help_str(120)) for command in members])


def write_examples(examples: Sequence[str], formatter: click.HelpFormatter) -> None:
    """Write lines that may be typed as they are."""
    with formatter.section("Examples"):
        for example in examples:
            formatter.write(f"{'':{formatter.current_indent}}{example}\n")
    formatter.write("\n")
