"""A commented campaign to start from, written to a file: the work of `divideropt init`."""

import json
import re
from importlib.resources import files
from pathlib import Path

from divideropt.campaign.config import names_folder
from divideropt.campaign.dump import campaign_schema
from divideropt.errors import UsageError
from divideropt.store.files import disk_errors

ENDINGS = (".yaml", ".yml")
"""How a campaign's file ends, by which editors know it."""


def begin_campaign(file: Path, template: str, *, with_schema: bool = False) -> tuple[Path, ...]:
    """Write a campaign to start from, called as its file.

    Args:
        file: Where to.
        template: Name of a campaign that ships with the package: divider or quickstart.
        with_schema: Whether to write the JSON schema beside it, to which its first line then refers.

    Returns:
        What was written.

    Raises:
        UsageError: The file is there already, its folder is not, or its name is no campaign's.
        DiskError: The disk refused.
    """
    schema = file.with_suffix(".schema.json")
    wanted = [file, schema] if with_schema else [file]
    if file.suffix not in ENDINGS:
        raise UsageError(f"{file}: the name of a campaign's file must end in {' or '.join(ENDINGS)}")
    if not file.parent.is_dir():
        raise UsageError(f"{file}: there is no folder {file.parent}; make it first")
    there = [path for path in wanted if path.exists() or path.is_symlink()]
    if there:
        raise UsageError(f"{there[0]}: is there already, and is not replaced; name another file, or delete it first")
    hint = f"# yaml-language-server: $schema={schema.name}\n" if with_schema else ""
    described = json.dumps(campaign_schema(), indent=2, ensure_ascii=False) + "\n"
    for path, text in zip(wanted, (hint + _campaign_text(file, template), described), strict=False):
        with disk_errors(path), path.open("x", encoding="utf-8") as opened:
            opened.write(text)
    return tuple(wanted)


def _campaign_text(file: Path, template: str) -> str:
    """The template, with a head of its own and the file's name as far as a folder can have it."""
    text = files("divideropt.campaign").joinpath(f"{template}.yaml").read_text("utf-8")
    body = re.sub(r"\A(#.*\n)+", "", text)
    if names_folder(file.stem):
        body = re.sub(r"\Aname: .*", f'name: "{file.stem}"    # results go to results/{file.stem}', body)
    return (
        f"# Begun from divideropt's {template}.yaml: the adjustable-ratio flow divider, optimised.\n"
        f"# `divideropt check {file.name}` says every mistake at once, `divideropt run {file.name}` runs it, and\n"
        "# `divideropt schema` has every name that may stand here. Every quantity has its unit, any of its kind.\n"
    ) + body
