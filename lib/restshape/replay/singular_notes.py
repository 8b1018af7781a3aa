"""What is said of quantities at singular places, the same wherever their values are shown."""

from __future__ import annotations

from collections.abc import Mapping

MARK = "singular place: value of the mesh"
"""Beside the name of such a quantity in a picture."""
ESTIMATES_NOTE = (
    "estimated errors are estimates, no bounds: in the benchmarks of the docs nearly all are within half and twice "
    "the true error; a finer mesh.size shows the true one"
)


def singular_notes(singular: Mapping[str, float]) -> list[str]:
    """A line for each quantity that does not converge.

    Args:
        singular: exponent of displacements by quantity, as recordings have it; 0 at a point load.
    """
    return [_note(name, exponent) for name, exponent in singular.items()]


def _note(name: str, exponent: float) -> str:
    how = f"r^{exponent - 1.0:.3f} there" if exponent else "a point load there"
    more = "restshape check says more of the first shape"
    return f"{name} is taken at a singular place ({how}): its value is one of the mesh size; {more}"


def marked(name: str, singular: Mapping[str, float], frames: str = "") -> str:
    """The name of a quantity, with a mark where it does not converge, in these frames where it does in others."""
    mark = f"{MARK}, in frames {frames}" if frames else MARK
    return f"{name} ({mark})" if name in singular else name
