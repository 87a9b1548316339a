"""Packages that only some formats need."""

from collections.abc import Iterator
from contextlib import contextmanager

from sheath_manip.exceptions import SetupError


@contextmanager
def needs(extra: str, package: str) -> Iterator[None]:
    """Import in here what the optional dependency `extra` of this project brings.

    Raises SetupError where it is not installed.
    """
    try:
        yield
    except ImportError as error:
        raise SetupError(
            f"this wants the package {package} ({error}); install it with "
            f"`pip install 'sheath-manip[{extra}]'`"
        ) from error
