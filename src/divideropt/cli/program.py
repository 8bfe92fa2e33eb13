"""The program: its commands under headings, and its exit code."""

import codecs
import io
import os
import sys
import traceback

import click

from divideropt.cli.choosing import compare, sensitivity
from divideropt.cli.files import check, init, schema
from divideropt.cli.output import say
from divideropt.cli.running import export, report, run, status, verify
from divideropt.cli.simulating import error_budget, evaluate, sheet, simulate
from divideropt.cli.teaching import Headed
from divideropt.errors import DivideroptError, FileMistakes


def main() -> None:
    """Run the command and leave with its exit code."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # what an ASCII terminal lacks, a Greek letter say, as an escape
        codecs.register_error("escaped", _escaped)
        sys.stdout.reconfigure(errors="escaped")
    try:
        code = commands.main(prog_name="divideropt", standalone_mode=False) or 0
    except click.ClickException as error:
        error.show()
        code = 2
    except (click.Abort, KeyboardInterrupt):
        say("divideropt: stopped by SIGINT; nothing that was logged is lost")
        code = 130
    except FileMistakes as error:
        say(str(error))  # file:line:column, which editors know
        code = error.exit_code
    except DivideroptError as error:
        say(f"divideropt: {error}")
        code = error.exit_code
    except Exception:
        traceback.print_exc()
        say("divideropt: this is a bug in divideropt; the lines above say where. Nothing that was logged is lost.")
        code = 1
    try:
        sys.stderr.flush()
    except OSError:  # nobody to hear it, and what is in the buffer would be flushed again when Python ends
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    sys.exit(code)


def _escaped(error: UnicodeError) -> tuple[str, int]:
    """Write what an encoding lacks as JSON does, so that JSON remains what it was."""
    import json  # noqa: PLC0415 (late: hardly anybody needs it)

    if not isinstance(error, UnicodeEncodeError):
        raise error
    return json.dumps(error.object[error.start : error.end])[1:-1], error.end


@click.group(
    cls=Headed,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
    examples=(
        "divideropt init my.yaml",
        "divideropt check my.yaml",
        "divideropt run my.yaml",
        "divideropt status results/my",
        "divideropt simulate my.yaml --set 'spool_radius=9 mm' --out response.html",
    ),
    headings={
        "From a campaign to a front": (init, check, run, status, verify, report, export),
        "From a front to a decision": (compare, sensitivity),
        "One design, or a table of them": (simulate, evaluate, sheet, error_budget),
        "For editors": (schema,),
    },
)
@click.version_option(package_name="divideropt")
def commands() -> None:
    """Multiobjective optimisation of simulated hydraulic components.

    A campaign is a YAML file that says what is optimised; `init` writes one to start from. Its results are a folder,
    the store, which `run` goes on with where it stopped. Data goes to standard output, words to standard error.
    A command is explained by `divideropt COMMAND --help`.
    """
