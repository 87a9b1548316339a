from tests.writing import writes_here

__all__ = ["writes_here"]
