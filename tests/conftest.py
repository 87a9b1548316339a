"""Hypothesis' profile that `make soak` asks for; `tests.cases` reads which one is in force."""

from hypothesis import settings

from tests.cases import SOAK

settings.register_profile(SOAK, deadline=None)
