"""Half the precision is for processors that compute in it: elsewhere it is emulated, and slow."""

import pytest
import torch

from sheath_manip.policies.precision import training_dtype, training_precision

CPU = torch.device("cpu")


@pytest.fixture
def told(monkeypatch):
    """Have torch tell other capabilities of the CPU."""

    def tell(**capabilities: bool) -> None:
        monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: capabilities, raising=False)
        training_dtype.cache_clear()

    yield tell
    training_dtype.cache_clear()


def product(dtype: torch.dtype) -> torch.dtype:
    return (torch.ones(2, 2, dtype=dtype) @ torch.ones(2, 2)).dtype


def test_a_cpu_that_computes_in_it_trains_in_it(told):
    told(avx2=True, avx512_bf16=True)
    with training_precision(CPU) as dtype:
        assert dtype is torch.bfloat16
        assert product(dtype) is torch.bfloat16


def test_another_cpu_trains_in_float32(told):
    told(avx2=True, avx512_bf16=False, amx_bf16=False)
    with training_precision(CPU) as dtype:
        assert dtype is torch.float32
        assert product(dtype) is torch.float32


def test_where_torch_does_not_tell_it_is_float32(monkeypatch):
    monkeypatch.delattr(torch.cpu, "get_capabilities", raising=False)
    training_dtype.cache_clear()
    assert training_dtype("cpu") is torch.float32
    training_dtype.cache_clear()
    assert training_dtype("cuda") is torch.bfloat16
