"""The help teaches: examples first, which are calls that the program takes."""

import shlex

import click
import pytest
from click.testing import CliRunner

from divideropt.cli import commands

EXAMPLES = [(command, example) for command in commands.commands.values() for example in command.examples]


@pytest.mark.parametrize("name", [None, *commands.commands])
def test_help_begins_with_examples_and_names_every_option(name):
    command = commands if name is None else commands.commands[name]
    shown = CliRunner().invoke(commands, ["--help"] if name is None else [name, "--help"])
    assert shown.exit_code == 0
    first, second, *_ = shown.output.splitlines()
    assert first == "Examples:"
    assert second.strip() == command.examples[0]
    options = [option for parameter in command.params for option in parameter.opts if option.startswith("--")]
    assert all(option in shown.output for option in options)


def test_every_command_stands_under_one_heading_with_a_whole_sentence():
    shown = CliRunner().invoke(commands, ["--help"], terminal_width=110).output
    for name, command in commands.commands.items():
        assert shown.count(f"\n  {name} ") == 1
        assert command.get_short_help_str(120).endswith(".")
        assert not command.get_short_help_str(120).endswith("...")


@pytest.mark.parametrize(("command", "example"), EXAMPLES, ids=[example for _, example in EXAMPLES])
def test_examples_are_calls_that_the_program_takes(command, example):
    call = example.partition(" > ")[0].partition(" | ")[0]
    words = shlex.split(call, comments=True)
    if not words:
        return  # a comment, about what the others make
    assert words[:2] == ["divideropt", command.name]
    context = command.make_context(words[1], words[2:])
    assert not context.args


def test_the_programs_own_examples_are_calls_too():
    for example in commands.examples:
        program, name, *words = shlex.split(example)
        assert program == "divideropt"
        assert isinstance(commands.commands[name].make_context(name, words), click.Context)
