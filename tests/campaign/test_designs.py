"""The table of `divideropt evaluate`, as strangers may write it: read exactly, or refused with row and column."""

import os
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.campaign.designs import LARGEST_FILE, LONGEST_LINE, evaluate_designs, read_designs
from divideropt.campaign.reader import MOST_MISTAKES
from divideropt.errors import FileMistakes, UsageError
from toy_model import Toy

PARAMETERS = tuple(Toy().parameters.values())


def read(folder, content):
    path = folder / "d.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_designs(path, PARAMETERS)


def refused(folder, content):
    with pytest.raises(FileMistakes) as caught:
        read(folder, content)
    assert str(caught.value).isprintable() or "\n" in str(caught.value)
    assert str(caught.value).count("\n") == len(caught.value.mistakes) - 1
    return [(m.line, m.column) for m in caught.value.mistakes], str(caught.value)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("begin", [b"", b"\xef\xbb\xbf"])
def test_a_table_is_read_whatever_ends_its_lines(tmp_path, begin, end):
    found = read(tmp_path, begin + end.join(["x2,design_id,x1", "0.5,a,.25", " 1e-3 ,b,1.", "", ""]).encode())
    assert found.given == ("x2", "x1")
    assert found.values.tolist() == [[0.5, 0.25], [1e-3, 1.0]]
    assert found.identities == ("a", "b")


@pytest.mark.parametrize(
    ("text", "places", "words"),
    [
        ("\nx1\n0.5\n", [(1, 1)], "the first line is blank"),
        ("x1,x1\n1,1\n", [(1, 2)], "second time"),
        ("x1,design_id,design_id\n1,a,b\n", [(1, 3)], "second time"),
        ("x1;x2\n1;2\n", [(1, 1)], "'x1;x2' is no parameter"),
        ("\ufeff\ufeffx1\n1\n", [(1, 1)], "'\\ufeffx1' is no parameter"),
        ("x1,\n1,\n", [(1, 2)], "'' is no parameter"),
        ("x1,desing_id\n1,2\n", [(1, 2)], "'desing_id' is no parameter; did you mean design_id?"),
        ("x1,a,b\n1,2,3\n", [(1, 2), (1, 3)], "'b' is no parameter; rename or delete it"),
        ("x1\n1_0e-3\n", [(2, 1)], "x1 is '1_0e-3', not a number"),
        ("x1\n\u0661\n", [(2, 1)], "not a number"),
        ("x1\n\uff11\n", [(2, 1)], "not a number"),
        ("x1\nnan\n", [(2, 1)], "not a number"),
        ("x1\ninfinity\n", [(2, 1)], "not a number"),
        ("x1\n1e400\n", [(2, 1)], "not a number"),
        ("x1\n0x1p-1\n", [(2, 1)], "not a number"),
        ("x1\n'=1/2\n", [(2, 1)], "not a number"),
        ("x1\n0.5 mm\n", [(2, 1)], "not a number"),
        ("x1\n0\0\n", [(2, 1)], "'0\\x00', not a number"),
        ("x1\n2\n", [(2, 1)], "at most 1"),
        ("x1,x2\n1,0\n1\n1,0,0\n", [(3, 1), (4, 1)], "the row has 3 cells, the header 2"),
        ("x1\n1\n\n\n1\n", [(3, 1), (4, 1)], "empty, and not the last"),
        ('x1,design_id\n1,"a\nb"\n1,b\nx,c\n', [(5, 1)], "not a number"),
        ('x1,design_id\n1,a\n1,"b\n1,c\n', [(3, 1)], "not CSV (unexpected end of data)"),
        ('x1,design_id\n1,"a"b\n', [(2, 1)], "not CSV"),
        ("x1,design_id\n1,a\0b\n", [(2, 2)], "U+0000"),
        ("x1\n" + "1" * 81 + "\n", [(2, 1)], "not a number"),
        ("x1\n" + "1" * (LONGEST_LINE + 1), [(2, 1)], "break it"),
        ('x1,design_id\n1,"' + ("a" * 70_000 + "\n") * 2 + '"', [(2, 1)], "field larger than field limit"),
    ],
)
def test_a_mistake_has_its_row_and_column(tmp_path, text, places, words):
    found, said = refused(tmp_path, text)
    assert found == places
    assert words in said
    assert len(said) < 2000


@pytest.mark.parametrize(
    ("content", "place"),
    [("x1\n0.5".encode("utf-16"), (1, 1)), (b"x1,design_id\n0.5,\xe4\n", (2, 5)), (b"x1\r0.5\r\xff", (3, 1))],
)
def test_another_encoding_is_refused_at_its_first_byte(tmp_path, content, place):
    found, said = refused(tmp_path, content)
    assert found == [place]
    assert "UTF-8" in said


@pytest.mark.parametrize("content", ["", "\n", " \r\n\r\n", "\ufeff"])
def test_an_empty_file_is_said_to_be_empty(tmp_path, content):
    with pytest.raises(UsageError, match="the file is empty"):
        read(tmp_path, content)


@pytest.mark.parametrize(
    "text",
    [
        "a," * 49_000 + "b\n",
        ",".join(f"a{i}" for i in range(10_000)) + "\n",
        ("x1\n" + "x\n" * 500_000),
        ("x1,x2\n" + "1\n" * 500_000),
        ("x1\n1\n" + "\n" * 500_000 + "1\n"),
        "x1\n" + '"' * 99_999,
    ],
    ids=["repeated", "columns", "cells", "rows", "blank", "quotes"],
)
def test_a_hostile_table_is_refused_at_once(tmp_path, text):
    begin = time.process_time()
    places, said = refused(tmp_path, text)
    assert time.process_time() - begin < 2
    assert len(places) <= MOST_MISTAKES + 1
    assert len(said) < 100_000


def test_a_table_too_large_is_not_read(tmp_path):
    path = tmp_path / "d.csv"
    with path.open("wb") as file:
        file.truncate(2**31)
    begin = time.process_time()
    with pytest.raises(UsageError, match=f"larger than {LARGEST_FILE >> 20} MiB, the most a table of designs"):
        read_designs(path, PARAMETERS)
    assert time.process_time() - begin < 2


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "d.csv")
    with pytest.raises(UsageError, match="a pipe or a device"):
        read_designs(tmp_path / "d.csv", PARAMETERS)
    with pytest.raises(UsageError, match="a pipe or a device"):
        read_designs(Path("/dev/zero"), PARAMETERS)


def test_a_formula_is_data(tmp_path):
    formulas = ["=1+1", "@SUM(A1)", "+cmd|' /C calc'!A0", '"quoted"', "a\nb", "</script>"]
    rows = "".join('0.5,"{}"\n'.format(f.replace('"', '""')) for f in formulas)
    designs = read(tmp_path, "x1,design_id\n" + rows)
    table = evaluate_designs(designs, Toy(), {p.name: p.default for p in PARAMETERS})
    assert table["design_id"].tolist() == formulas
    path = tmp_path / "again.csv"
    path.write_text(table[["design_id", "x1"]].to_csv(index=False), encoding="utf-8", newline="")
    assert list(read_designs(path, PARAMETERS).identities) == formulas


@given(st.lists(st.lists(st.floats(0, 1), min_size=3, max_size=3), max_size=5))
def test_numbers_are_read_to_the_bit(tmp_path_factory, rows):
    folder = tmp_path_factory.mktemp("designs")
    lines = [",".join(map(repr, row)) + "\n" for row in rows]
    found = read(folder, "x1,x2,x3\n" + "".join(lines))
    assert found.values.tolist() == rows


@given(st.binary(max_size=60))
def test_any_bytes_are_a_table_or_refused(tmp_path_factory, content):
    folder = tmp_path_factory.getbasetemp() / "tables"
    folder.mkdir(exist_ok=True)
    try:
        read(folder, b"x1,design_id\n0.5," + content)
    except UsageError as error:
        assert str(error)
