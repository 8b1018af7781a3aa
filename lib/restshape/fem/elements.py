"""Elements as names of this module: a family such as LINEAR_ELASTIC, from which its shape is taken: FAMILY["tri6"].

The names are those of the compiled elements' families in capitals, so a family that does not exist is an ImportError.
"""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from restshape import _kernels


class Family(Mapping[str, _kernels.Element]):
    """The elements of one law or effect, by the shape of their cells.

    Args:
        name: of the family, as the compiled elements say it.
        members: an element a shape.
    """

    def __init__(self, name: str, members: dict[str, _kernels.Element]) -> None:
        self.name = name
        self._members = members

    def __getitem__(self, shape: str) -> _kernels.Element:
        try:
            return self._members[shape]
        except KeyError:
            raise KeyError(f"no {self.name} on {shape}: it is on {', '.join(self._members)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._members)

    def __len__(self) -> int:
        return len(self._members)

    def __repr__(self) -> str:
        return f"Family({self.name!r}: {', '.join(self._members)})"


def families() -> dict[str, Family]:
    """All families by their symbols, such as LINEAR_ELASTIC."""
    found: dict[str, dict[str, _kernels.Element]] = {}
    for element in map(_kernels.Element, _kernels.element_names()):
        found.setdefault(element.family, {})[element.shape] = element
    return {name.upper(): Family(name, members) for name, members in found.items()}


if TYPE_CHECKING:

    def __getattr__(name: str) -> Family: ...

else:
    globals().update(families())
