"""A page of the documentation as something to do: its blocks executed in order, its outputs compared.

A fenced block after a sentence such as ``Save this as `valve.yaml`:`` is kept as that file. Of the others, `bash` and
`python` are run, and `text` is what the block before it prints.
In such an output `…` stands for anything within a line, and a line of it for any lines.
"""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]

_FENCE = re.compile(r"^```(?P<language>\w+)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
_SAVED = re.compile(r"Save this as `([\w.-]+)`[^`]*:\n\n\Z")


@dataclass
class Block:
    """What a page asks for: a file to keep, or a script to run and what it prints."""

    language: str
    text: str
    file: str | None
    expected: str | None = None


def blocks(page: Path) -> list[Block]:
    """Read a page's blocks in their order."""
    text = page.read_text(encoding="utf-8")
    found: list[Block] = []
    for fence in _FENCE.finditer(text):
        saved = _SAVED.search(text[: fence.start()])
        language = fence["language"]
        if language == "text" and saved is None:
            assert found[-1].file is None, f"{page}: an output after a file"
            assert found[-1].expected is None, f"{page}: two outputs of one block"
            found[-1].expected = fence["text"]
            continue
        assert saved or language in ("bash", "python"), f"{page}: a block of {language} that is no file"
        found.append(Block(language, fence["text"], saved[1] if saved else None))
    return found


def follow(
    page: Path, folder: Path, environment: Mapping[str, str], without: Collection[str] = ()
) -> Iterator[tuple[Block, str]]:
    """Do what a page says, in a folder.

    Args:
        page: Which.
        folder: Where.
        environment: Its variables; see `here`.
        without: Beginnings of scripts to leave out.

    Returns:
        Each script that was run, with what it printed, standard error included.
    """
    python = ""  # one session a page: a later block knows the names of an earlier
    for block in blocks(page):
        if block.file is not None:
            (folder / block.file).write_text(block.text, encoding="utf-8")
        elif not block.text.startswith(tuple(without)):
            if block.language == "python":
                printed = _run(
                    ["python", "-c", python + "\nprint('-- here', flush=True)\n" + block.text], folder, environment
                )
                printed = printed.rpartition("-- here\n")[2]
                python += "\n" + block.text
            else:
                printed = _run(["bash", "-eu", "-c", block.text], folder, environment)
            yield block, printed


def agrees(printed: str, expected: str) -> str | None:
    """Compare an output with what a page says of it: None, or the first line that is not as it says."""
    lines = iter(line.rstrip() for line in printed.rstrip().splitlines())
    anywhere = False
    for wanted in (line.rstrip() for line in expected.rstrip().splitlines()):
        if wanted == "…":
            anywhere = True
            continue
        pattern = re.compile(".*".join(map(re.escape, wanted.split("…"))))
        for line in lines:
            if pattern.fullmatch(line):
                break
            if not anywhere:
                return wanted
        else:
            return wanted
        anywhere = False
    return None if anywhere or next(lines, None) is None else "more lines than are shown"


def here(folder: Path) -> dict[str, str]:
    """Make the environment in which `divideropt` is this tree, also where a page sets PYTHONPATH for its own model.

    `dask` starts workers that have it too. With `-P` the working folder is not on Python's path, as it is not for the
    installed command.
    """
    folder.mkdir(exist_ok=True)
    python = shlex.quote(sys.executable)
    for name, call in (("divideropt", "-P -m divideropt "), ("dask", "-P -m dask "), ("python", "")):
        path = f'PYTHONPATH="${{PYTHONPATH:+$PYTHONPATH:}}"{shlex.quote(str(ROOT / "src"))}'
        (folder / name).write_text(f'#!/bin/sh\n{path} exec {python} {call}"$@"\n', encoding="utf-8")
        (folder / name).chmod(0o755)
    return os.environ | {"PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def _run(command: list[str], folder: Path, environment: Mapping[str, str]) -> str:
    done = subprocess.run(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, env=environment
    )
    assert done.returncode == 0, f"exit code {done.returncode}:\n{command[-1]}\n{done.stdout}"
    return done.stdout
