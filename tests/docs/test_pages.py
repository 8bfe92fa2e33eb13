"""What the pages of the documentation tell one to do gives what they say; their links and formulas are right."""

import json
import os
import re
import shutil
import subprocess
import sys
import textwrap

import pytest
from ruamel.yaml import YAML

from divideropt.campaign.load import parse_campaign
from following import ROOT, agrees, blocks, follow, here

DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
FOLLOWED = (
    "tutorial.md",
    "how-to/own-model.md",
    "how-to/resume.md",
    "how-to/read-the-store.md",
    "how-to/dimensions.md",
    "how-to/robust.md",
    "how-to/compare.md",
    "how-to/sensitivity.md",
)
NOT_RUN = {
    "python -m pip install '.[dask]'": "installs; the test extra has dask",
    "dask scheduler --host node1 --port 8786": "on a cluster's machine; test_cluster_page.py follows it on this one",
    "dask worker tcp://node1:8786 --nworkers 16 --nthreads 1": "the same",
    "divideropt run campaign.yaml --store /shared/results/divider": "the same",
    "divideropt run spring.yaml --branch": "on another processor; tests/campaign/test_branches.py makes such a store",
    "python docs/make_claims.py": "a page says how it was written, in three minutes; test_claims.py holds it",
    "python docs/make_thesis_figures.py": "the same; test_thesis_figures.py holds it",
    "python -m pip install . && divideropt run campaigns/quickstart.yaml": "the tutorial begins so",
    "python -m pip install -e '.[test]' && pytest": "this is pytest",
    "python3 -m venv .venv && . .venv/bin/activate": "installs",
    "python -m pip install -e '.[dev]'": "installs",
    "poe lint": "lints",
    "poe test tests/models/divider/test_metrics.py": "is a part of the tests",
    "poe check": "runs this",
}
"""Commands that pages show in indented blocks, which nobody follows, each with the reason."""


def yaml(source):
    return YAML(typ="safe").load(source)


def names(pages):
    return [str(page.relative_to(DOCS)) for page in pages]


def do(page, folder, environment, without=()):
    """Follow a page, and hold each output to what it says."""
    shown = [
        (block, printed, agrees(printed, block.expected))
        for block, printed in follow(DOCS / page, folder, environment, without)
        if block.expected is not None
    ]
    assert shown
    for block, printed, wrong in shown:
        assert wrong is None, f"{page}, after\n{block.text}\nno line {wrong!r} where it should be, but\n{printed}"


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    return here(tmp_path_factory.mktemp("commands"))


@pytest.fixture(scope="module")
def followed(tmp_path_factory, environment):
    """A folder in which somebody has followed the tutorial, but for what takes minutes."""
    folder = tmp_path_factory.mktemp("tutorial")
    shutil.copytree(ROOT / "campaigns", folder / "campaigns")
    do("tutorial.md", folder, environment, without=("python -m pip", "divideropt verify"))
    return folder


def test_the_tutorial_leads_where_it_says(followed):
    reports = {str(path.parent.relative_to(followed)) for path in followed.rglob("report.html")}
    assert reports == {"results/quickstart", "results/valve/sensitivity/morris"}
    assert (followed / "light.html").is_file()


def test_the_store_reads_as_its_page_says(followed, environment):
    do("how-to/read-the-store.md", followed, environment)


def test_uncertain_designs_come_out_as_their_page_says(followed, environment):
    do("how-to/robust.md", followed, environment)


def test_the_readmes_lines_of_python_run(followed, environment):
    block = re.search(r"^## From Python\n[^#]*?\n\n((?: {4}.*\n)+)", (ROOT / "README.md").read_text("utf-8"), re.M)
    script = "\n".join(line[4:] for line in block[1].splitlines()) + "\nprint(len(front))"
    done = subprocess.run(
        ["python", "-c", script], cwd=followed, env=environment, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (0, "195\n"), done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("page", ["how-to/compare.md", "how-to/sensitivity.md"])
def test_large_campaigns_come_out_as_their_page_says(tmp_path, environment, page):
    shutil.copytree(ROOT / "campaigns", tmp_path / "campaigns")
    do(page, tmp_path, environment)


def test_dimensions_are_listed_as_their_page_says(followed, environment):
    do("how-to/dimensions.md", followed, environment)


@pytest.mark.slow
def test_a_model_of_ones_own_runs_as_its_page_says(tmp_path, environment):
    do("how-to/own-model.md", tmp_path, environment)
    spring = next(block for block in blocks(DOCS / "how-to/own-model.md") if block.file == "spring.py")
    assert len([line for line in spring.text.splitlines() if line.strip()]) <= 33


@pytest.mark.slow
def test_stopping_and_extending_go_as_their_page_says(tmp_path, environment):
    for block in blocks(DOCS / "how-to/own-model.md"):
        if block.file is not None:
            (tmp_path / block.file).write_text(block.text, encoding="utf-8")
    do("how-to/resume.md", tmp_path, environment)


@pytest.mark.slow
def test_the_tutorial_is_followed_to_the_letter_in_a_fresh_clone(tmp_path):
    clone, venv = tmp_path / "clone", tmp_path / "venv"
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", ROOT, clone], check=True)
    subprocess.run([sys.executable, "-m", "venv", venv], check=True)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    do("tutorial.md", clone, environment | {"PATH": f"{venv / 'bin'}{os.pathsep}{os.environ['PATH']}"})


OUTPUT = "one\ntwo: 2 s\nthree\n"


@pytest.mark.parametrize(
    "expected", ["one\ntwo: 2 s\nthree", "one\ntwo: … s\nthree", "one\n…\nthree", "…\nthree", "one\n…"]
)
def test_an_output_agrees_with_what_a_page_says_of_it(expected):
    assert agrees(OUTPUT, expected) is None


@pytest.mark.parametrize(
    ("expected", "wrong"),
    [
        ("one\nthree", "three"),
        ("one\ntwo: 3 s\n…", "two: 3 s"),
        ("…\nthree\none", "one"),
        ("one\ntwo: … m\nthree", "two: … m"),
        ("one\ntwo: 2 s", "more lines than are shown"),
        ("one\n…\nfour", "four"),
    ],
)
def test_an_output_that_differs_does_not(expected, wrong):
    assert agrees(OUTPUT, expected) == wrong


def test_a_formula_that_is_not_understood_is_a_warning_with_its_place(tmp_path, sphinx):
    settings = {
        "extensions": ["myst_parser", "mathml"],
        "html_math_renderer": "mathml",
        "myst_enable_extensions": ["dollarmath"],
    }
    (tmp_path / "conf.py").write_text("".join(f"{name} = {value!r}\n" for name, value in settings.items()))
    (tmp_path / "index.md").write_text("# Title\n\n$$\n\\nonsense{x}\n$$\n")
    done = sphinx(tmp_path, tmp_path / "built")
    assert done.returncode == 1
    assert re.search(r"index\.md:\d+: WARNING: formula not understood: .*nonsense", done.stderr)


def test_no_page_that_is_followed_is_forgotten():
    fenced = {
        name
        for name, page in zip(names(PAGES), PAGES, strict=True)
        if re.search("^```(bash|python)", page.read_text("utf-8"), re.M)
    }
    assert fenced == {*FOLLOWED, "how-to/notebook.md"}  # which test_notebook.py executes


def test_every_command_that_is_not_run_has_a_reason():
    shown = set()
    for page in (*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md"):
        text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        found = re.findall(r"^    ((?:\w+=\S+ )*(?:divideropt|python3?|poe|dask|pip|sphinx-build) .*)", text, re.M)
        shown |= {re.sub(r"\s+#.*", "", command) for command in found}
    assert shown == set(NOT_RUN)


@pytest.mark.parametrize("page", ["cluster", "sensitivity", "termination"])
def test_what_a_page_adds_to_a_campaign_is_right(page):
    campaign = yaml(ROOT / "campaigns" / "quickstart.yaml")
    blocks = re.findall(r"(?:^    .*\n)+", (DOCS / f"how-to/{page}.md").read_text(encoding="utf-8"), re.MULTILINE)
    added = [textwrap.dedent(block) for block in blocks if re.match(r"    \w+:", block)]
    assert added
    for text in added:
        parse_campaign(json.dumps(campaign | yaml(text)), page)


@pytest.mark.parametrize("page", PAGES, ids=names(PAGES))
def test_its_links_lead_to_files(page):
    targets = re.findall(r"\]\((?!https?:|#)([^)#\s]+)", page.read_text(encoding="utf-8"))
    assert [target for target in targets if not (page.parent / target).exists()] == []


def test_every_page_is_in_the_tree():
    found = set()
    for page in PAGES:
        for tree in re.findall(r"^```\{toctree\}\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.M):
            for entry in (line for line in tree.splitlines() if line and not line.startswith(":")):
                hits = set(page.parent.glob(f"{entry}.md"))
                assert hits, f"{page}: {entry}"
                found |= hits
    assert set(PAGES) - found == {DOCS / "index.md"}
