"""The elements of one law or effect, by the shape of their cells."""

from collections.abc import Iterator, Mapping

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
