"""Elements as names of this module: a family such as LINEAR_ELASTIC, from which its shape is taken: FAMILY["tri6"].

The names are those of the compiled elements' families in capitals, so a family that does not exist is an ImportError.
The type checker reads them in `elements.pyi`, which `scripts/stubs.py` writes.
"""

from difflib import get_close_matches

from restshape import _kernels
from restshape.fem.family import Family

__all__ = ["Family", "families"]


def families() -> dict[str, Family]:
    """All families by their symbols, such as LINEAR_ELASTIC."""
    found: dict[str, dict[str, _kernels.Element]] = {}
    for element in map(_kernels.Element, _kernels.element_names()):
        found.setdefault(element.family, {})[element.shape] = element
    return {name.upper(): Family(name, members) for name, members in found.items()}


globals().update(families())


def __getattr__(name: str) -> Family:
    """No family has this name.

    Raises:
        ImportError: it looks like one; the message names the nearest.
        AttributeError: it does not.
    """
    if not name.isupper():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    near = get_close_matches(name, [known for known in globals() if known.isupper()], 1)
    hint = f": did you mean {near[0]}?" if near else "; `families` gives all of them"
    raise ImportError(f"there is no family of elements {name}{hint}", name=__name__)
