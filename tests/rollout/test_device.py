"""Which device computes: what is said, where it is found, and what is refused."""

import os
import subprocess
import sys

import pytest
import torch

from sheath_manip.exceptions import ParameterError, SetupError
from sheath_manip.rollout import device
from sheath_manip.rollout.device import VARIABLE, computes_on, is_cpu, torch_device, use_device


@pytest.fixture(autouse=True)
def unsaid(monkeypatch) -> None:
    # Set first, so that it is gone again after a test that sets it.
    monkeypatch.setenv(VARIABLE, "cpu")
    monkeypatch.delenv(VARIABLE)


def devices(monkeypatch, count: int) -> None:
    monkeypatch.setattr(torch.cuda, "device_count", lambda: count)
    monkeypatch.setattr(torch.backends.cudnn, "allow_tf32", True)


def test_by_default_the_cpu_computes_and_nothing_is_said():
    use_device(None)
    assert VARIABLE not in os.environ
    assert computes_on() == "cpu"
    assert is_cpu()
    assert torch_device().type == "cpu"


@pytest.mark.parametrize(
    ("said", "count", "found"),
    [
        ("cpu", 2, "cpu"),
        ("auto", 0, "cpu"),
        ("auto", 1, "cuda:0"),
        ("CUDA", 1, "cuda:0"),
        ("cuda:1", 2, "cuda:1"),
    ],
)
def test_a_device_that_is_here_is_taken_and_workers_hear_of_it(monkeypatch, said, count, found):
    devices(monkeypatch, count)
    use_device(said)
    assert os.environ[VARIABLE] == computes_on() == found
    # Convolutions are computed with all bits.
    assert torch.backends.cudnn.allow_tf32 == (found == "cpu")


@pytest.mark.parametrize("said", ["gpu", "cuda:", "cuda:x", "cuda:-1", "cpu:1", "", "auto:0"])
def test_what_is_no_device_is_refused_in_one_line(said):
    with pytest.raises(ParameterError, match="wanted cpu, cuda, cuda:N"):
        use_device(said)


@pytest.mark.parametrize(("said", "count"), [("cuda", 0), ("cuda:1", 1)])
def test_a_device_that_is_not_here_is_told(monkeypatch, said, count):
    devices(monkeypatch, count)
    with pytest.raises(SetupError, match=f"finds {count} CUDA devices; wanted --device cpu"):
        use_device(said)


def test_the_variable_says_it_too(monkeypatch):
    devices(monkeypatch, 1)
    monkeypatch.setenv(VARIABLE, "auto")
    assert computes_on() == "cuda:0"
    use_device(None)
    assert os.environ[VARIABLE] == "cuda:0"


def test_the_cpu_does_without_torch():
    code = (
        "import sys; from sheath_manip.rollout.device import is_cpu; assert is_cpu();"
        "assert 'torch' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
    assert device.CPU == "cpu"
