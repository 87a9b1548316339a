"""A line that does not parse: one sentence, with what was meant."""

import sys

import pytest


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (("colect", "corridor"), "unknown verb 'colect'; known: claims, collect, "),
        (("colect", "corridor"), "; did you mean collect?"),
        (("data",), "the line lacks one of list, show, check, export, "),
        (("data", "lst", "x"), "unknown verb of data 'lst'; known: check, drop, "),
        (("data", "list"), "the line lacks STORE (see sheath data list --help)"),
        (("collect", "corridor"), "the line lacks --store PATH (see sheath collect --help)"),
        (("collect", "corridor", "--episode", 3), "unknown option --episode; did you mean --ep"),
        (("collect", "corridor", "now", "--store", "x"), "nothing takes the word 'now'; wanted"),
        (("collect", "corridor", "--store"), "--store came without a value; wanted PATH"),
        (("--quick",), "unknown option --quick (see sheath --help)"),
        (("train", "corridor", "--calibration=x"), "the line lacks --store STR and --checkpoint"),
        (("run", "corridor", "--checkpoint", "y", "--seed=x"), "--seed is 'x'; wanted a whole n"),
        (("experiment", "corridor", "--seeds", 1, "b"), "--seeds is '1 b'; wanted a whole numb"),
        # A benchmark has no use for these.
        (("experiment", "gates", "--rounds", 3), "unknown option --rounds"),
        (("experiment", "nu", "--dashboard"), "unknown option --dashboard"),
    ],
)
def test_line_that_does_not_parse(complaint, argv, said):
    assert said in complaint(*argv)


def test_value_that_does_not_parse(complaint):
    line = complaint("collect", "corridor", "--store", "x", "--episodes", "two")
    wanted = "--episodes is 'two'; wanted a whole number, like 20 (see sheath collect --help)"
    assert line == f"sheath: {wanted}\n"


def test_a_parser_that_does_not_say_why_says_what_it_always_did(sheath, monkeypatch):
    monkeypatch.setitem(sys.modules, "tyro._errors", None)
    code, out, err = sheath("collect", "corridor", "--store")
    assert (code, out) == (2, "")
    assert "Missing value for argument '--store'" in err
