from typing import Any

# The compiled module: what its elements and functions take is written where each is bound.
def __getattr__(name: str) -> Any: ...
