"""Elements as names of this module: a family such as LINEAR_ELASTIC, from which its shape is taken: FAMILY["tri6"].

The names are those of the compiled elements' families in capitals, so a family that does not exist is an ImportError.
The type checker reads them in `elements.pyi`, which `scripts/stubs.py` writes.
"""

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
