"""A gate that will not do what a gate is for is told in one line, and works as it was asked."""

import warnings

from sheath_manip.cli.warned import warned_in_one_line
from sheath_manip.exceptions import GateWarning
from tests.cli.test_cli_failures import SMALL


def test_the_first_of_many_rounds_is_told_as_a_line(capsys, monkeypatch):
    others = list[str]()
    monkeypatch.setattr(warnings, "showwarning", lambda message, *_: others.append(str(message)))
    with warned_in_one_line():
        warnings.simplefilter("always")
        for number in range(3):
            warnings.warn(f"round {number}", GateWarning, stacklevel=1)
        warnings.warn("of another kind", UserWarning, stacklevel=1)
    assert capsys.readouterr().err == "sheath: warning: round 0\n"
    assert others == ["of another kind"]


def test_train_says_that_its_gate_may_never_take_over(sheath, made, tmp_path):
    rare = ("--gate.threshold.rule", "episodes", "--gate.threshold.false-alarm-rate", 0.26)
    tight = ("--gate.support.bandwidth-factor", 0.003)
    given = ("--store", made / "store", "--checkpoint", tmp_path / "c.npz", *SMALL, *rare, *tight)
    with warnings.catch_warnings():
        warnings.simplefilter("default", GateWarning)
        code, out, err = sheath("train", "corridor", *given)
    assert code == 0
    assert "threshold" in out
    told = [line for line in err.splitlines() if line.startswith("sheath: warning: ")]
    assert len(told) == 1
    assert "may never take over" in told[0]
    assert (tmp_path / "c.npz").exists()
