"""Everything in mujoco is Any: it ships no stubs, and pyright cannot read its extensions."""

from typing import Any

def __getattr__(name: str) -> Any: ...
