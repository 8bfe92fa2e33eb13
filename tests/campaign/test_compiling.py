"""The word when compilation begins."""

import io

import numba

from divideropt.campaign.compiling import WORDS, say_when_compiling


def test_a_compilation_is_announced_once_and_what_is_compiled_never():
    words = io.StringIO()

    def double(x):
        return 2 * x

    compiled = numba.njit(double)
    compiled(1)
    say_when_compiling(words)
    compiled(2)
    assert words.getvalue() == ""
    compiled(1.5)
    compiled("x")
    assert words.getvalue().splitlines() == [WORDS]


def test_what_comes_from_the_cache_is_not_announced(tmp_path, monkeypatch):
    source = tmp_path / "kernel.py"
    source.write_text("def triple(x):\n    return 3 * x\n")
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    said = []
    for _ in range(2):
        space = {"__name__": "kernel", "__file__": str(source)}
        exec(compile(source.read_text(), str(source), "exec"), space)
        words = io.StringIO()
        say_when_compiling(words)
        assert numba.njit(cache=True)(space["triple"])(2) == 6
        said.append(words.getvalue().splitlines())
    assert said == [[WORDS], []]
