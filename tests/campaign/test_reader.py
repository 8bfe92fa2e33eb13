import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.campaign.reader import (
    DEEPEST,
    LARGEST_FILE,
    MOST_MISTAKES,
    Broken,
    Place,
    read_document,
    read_text,
)
from divideropt.errors import FileMistakes, Mistake, UsageError


def places(text):
    try:
        mistakes = read_text(text).mistakes
    except FileMistakes as error:
        mistakes = error.mistakes
    return sorted((m.line, m.column) for m in mistakes)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 1e-3),
        ("10e6", 1e7),
        (".5", 0.5),
        ("5.", 5.0),
        ("+12", 12),
        ("014", 14),
        ("0o14", 12),
        ("0x1F", 31),
        ("-.inf", -math.inf),
        ("true", True),
        ("False", False),
        ("~", None),
        ("null", None),
        ("yes", "yes"),
        ("on", "on"),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2001-01-01", "2001-01-01"),
        ("'1'", "1"),
        ('"true"', "true"),
        ("6 mm", "6 mm"),
        ("9" * 400, math.inf),
    ],
)
def test_scalars_resolve_by_the_core_schema(text, value):
    read = read_text(f"a: {text}").data["a"]
    assert (read, type(read)) == (value, type(value))


def test_nan_is_a_number():
    assert math.isnan(read_text("a: .NaN").data["a"])


def test_every_key_and_value_has_its_place():
    document = read_text("a: 1\nb:\n  c: [x, {d: 2}]\n")
    assert document.data == {"a": 1, "b": {"c": ["x", {"d": 2}]}}
    assert document.place(("b", "c", 1, "d")) == Place(3, 14)
    assert document.place(("b", "c", 1, "d"), at_key=True) == Place(3, 11)
    assert document.place(("b", "c", 0)) == Place(3, 7)


def test_something_missing_is_placed_at_the_key_that_should_hold_it():
    document = read_text("a: 1\nb:\n  c: 2\n")
    assert document.place(("b", "d", 3)) == Place(2, 1)
    assert document.place(("z",)) == Place(1, 1)


@pytest.mark.parametrize(
    ("text", "at", "word"),
    [
        ("a: 1\nb: 2\na: 3\n", (3, 1), "second time, after line 1"),
        ("a: &x 1\n", (1, 4), "anchor &x"),
        ("a: 1\nb: *x\n", (2, 4), "alias *x"),
        ("a: !!python/object:os.system 1\n", (1, 4), "tag"),
        ("a: ! 1\n", (1, 4), "tag"),
        ("a: !!map {b: 1}\n", (1, 4), "tag"),
        ("<<: {b: 1}\n", (1, 1), "merge key"),
        ("5: 1\n", (1, 1), "not a name"),
        ("true: 1\n", (1, 1), "not a name"),
        ("[a, b]: 1\n", (1, 1), "not a name"),
        ("? {a: b}\n: 1\n", (1, 3), "not a name"),
        ("a: 1\n---\nb: 2\n", (2, 1), "second document"),
        ("a: " + "[" * 40 + "]" * 40, (1, 36), "nested"),
        ("a:\n\tb: 1\n", (2, 1), "tab"),
        ("a: 'x\n", (2, 1), "not YAML"),
        ("a: [1, 2\nb: 3\n", (2, 2), "not YAML"),
        ("a: \x07\n", (1, 4), "U+0007"),
        ("a: 1\nb: x: y\n", (2, 5), "not YAML"),
        ('a: "\\UFFFFFFFF"', (1, 1), "cannot be read"),
        ("%YAML 1.99\n--- a", (1, 1), "cannot be read"),
    ],
)
def test_a_mistake_has_its_place_and_reason(text, at, word):
    try:
        found = read_text(text).mistakes
    except FileMistakes as error:
        found = error.mistakes
    assert [(m.line, m.column) for m in found] == [at]
    assert word in found[0].message


def test_mistakes_are_found_together():
    text = "a: &x 1\na: 2\n<<: *x\n5: !!str 6\n"
    assert places(text) == [(1, 4), (2, 1), (3, 1), (3, 5), (4, 1), (4, 4)]


def test_the_first_of_two_keys_counts():
    assert read_text("a: 1\na: 2\n").data == {"a": 1}


def test_what_was_refused_is_broken_and_nothing_else():
    document = read_text("a: *x\nb: {c: !!str 1, d: 2}\n")
    assert isinstance(document.data["a"], Broken)
    assert document.is_broken(("a",))
    assert document.is_broken(("a", "deeper"))
    assert document.is_broken(("b", "c"))
    assert not document.is_broken(("b", "d"))
    assert not document.is_broken(("b", "e"))


def test_a_quoted_merge_key_is_a_name():
    assert read_text("'<<': 1").data == {"<<": 1}


def test_an_alias_bomb_is_never_expanded():
    lines = ["a0: &a0 [x]"] + [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 30)]
    assert len(places("\n".join(lines))) == MOST_MISTAKES


def test_nesting_is_permitted_to_its_limit():
    depth = DEEPEST - 1
    assert not places("a: " + "[" * depth + "]" * depth)


@pytest.mark.parametrize(
    "text",
    [
        "[" * 1_000_000,
        "[a," * 300_000,
        "- " * 500_000,
        "a: b\n" * 200_000,
        "- *a\n" * 200_000,
        "- x\n" * 250_000,
        "{" * 1_000_000,
    ],
    ids=["brackets", "lists", "dashes", "duplicates", "aliases", "items", "braces"],
)
def test_a_hostile_file_is_refused_at_once(text):
    with pytest.raises(FileMistakes):
        read_text(text)


def test_a_file_is_named_in_its_mistakes(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_text("a: 'x\n")
    with pytest.raises(FileMistakes, match=r"c\.yaml:2:1: this is not YAML"):
        read_document(path)


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\n")
    assert read_document(path).data == {"a": 1}
    assert read_document(path).place(("a",)) == Place(1, 4)


@pytest.mark.parametrize(
    ("content", "at"),
    [
        (b"a: 1\nb: \xb5m\n", (2, 4)),
        ("φ: µ".encode() + b"\xff", (1, 5)),
        (b"\xef\xbb\xbfa: \xff", (1, 4)),
        ("a: 1".encode("utf-16"), (1, 1)),
    ],
)
def test_a_byte_that_is_not_utf_8_has_its_place(tmp_path, content, at):
    path = tmp_path / "c.yaml"
    path.write_bytes(content)
    with pytest.raises(FileMistakes, match="not UTF-8") as caught:
        read_document(path)
    assert [(m.line, m.column) for m in caught.value.mistakes] == [at]


@pytest.mark.parametrize("content", ["", "# only a comment\n", "---\n", "null\n", "\n\n"])
def test_an_empty_file_is_said_to_be_empty(tmp_path, content):
    path = tmp_path / "c.yaml"
    path.write_text(content)
    with pytest.raises(UsageError, match=r"c\.yaml: the file is empty; `divideropt init my"):
        read_document(path)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(UsageError, match="no such file"):
        read_document(tmp_path / "c.yaml")


def test_a_folder(tmp_path):
    with pytest.raises(UsageError, match="this is a folder"):
        read_document(tmp_path)


def test_an_impossible_name():
    with pytest.raises(UsageError, match="cannot be the name of a file"):
        read_document("a\0b")
    with pytest.raises(UsageError, match="cannot be read"):
        read_document("a" * 5000)


def test_a_file_one_may_not_read(tmp_path, monkeypatch):
    def refuse(*_args, **_kwargs):
        raise PermissionError

    monkeypatch.setattr("os.open", refuse)
    with pytest.raises(UsageError, match="not permitted"):
        read_document(tmp_path / "c.yaml")


def test_a_file_of_two_mebibytes(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_bytes(b"#" * 2 * LARGEST_FILE)
    with pytest.raises(UsageError, match="larger than 1 MiB"):
        read_document(path)


def test_mistakes_compare_by_value():
    assert read_text("a: *x").mistakes == [Mistake(1, 4, "the alias *x is not permitted; write the value itself")]


words = st.text(st.characters(min_codepoint=32, max_codepoint=0x2FF, exclude_categories=["Cc"]), max_size=8)
values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**17), 10**17)
    | st.floats(allow_nan=False, allow_infinity=False)
    | words,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3),
    max_leaves=10,
)


@given(st.dictionaries(words, values), st.sampled_from([None, 1]))
def test_json_is_read_as_json(data, indent):
    document = read_text(json.dumps(data, ensure_ascii=False, indent=indent))
    assert document.data == data
    assert not document.mistakes


@given(st.text(st.sampled_from("ab1 :-?[]{},&*!|>'\"%@`#\n\t~<.\\x"), max_size=30))
def test_any_text_is_read_or_refused(text):
    try:
        read_text(text)
    except UsageError:
        return
