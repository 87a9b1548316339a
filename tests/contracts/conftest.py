"""What the contracts' tests want of packages that are not among the development ones."""

from tests.small_encoder import small_encoder

__all__ = ["small_encoder"]
