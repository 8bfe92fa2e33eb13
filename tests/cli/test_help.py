"""The help teaches: examples first, which are calls that the program takes."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

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


@pytest.mark.slow
def test_examples_run_one_after_the_other_in_an_empty_folder(tmp_path):
    """From `init` on; only the campaign is made smaller, and a table of designs is there."""
    (tmp_path / "designs.csv").write_text("spool_radius,groove_width\n8e-3,1e-3\n9e-3,1.1e-3\n", encoding="utf-8")
    (tmp_path / "divideropt").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m divideropt "$@"\n')
    (tmp_path / "divideropt").chmod(0o755)
    environment = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}", "PYTHONPATH": os.pathsep.join(sys.path)}
    order = ["init", "check", "run", *(name for name in commands.commands if name not in ("init", "check", "run"))]
    order.remove("evaluate")  # after `export`, whose tables it takes
    for name in [*order, "evaluate"]:
        for example in commands.commands[name].examples:
            call = example.partition(" | ")[0]
            done = subprocess.run(
                call, shell=True, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, (example, done.stderr)
            _make_smaller(tmp_path / "my.yaml")


def _make_smaller(campaign: Path) -> None:
    if campaign.exists():
        text = campaign.read_text(encoding="utf-8")
        text = re.sub(r"generations: \d+", "generations: 8", re.sub(r"evaluations: \d+", "evaluations: 210", text))
        campaign.write_text(text, encoding="utf-8")
