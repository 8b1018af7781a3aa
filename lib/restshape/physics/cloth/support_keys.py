"""What supports of cloth may say besides."""

from typing import Literal, Self

from pydantic import model_validator

from restshape.scene.model import Support
from restshape.scene.units import UnitError


class ClothSupport(Support):
    """``[supports.NAME]``: where and in which directions the displacement is given.

    Cloth may be clamped at an edge, "slope", across which its direction then stays; ``symmetry`` instead of fix puts an
    edge on a plane of symmetry with the normal x or y.

    Args:
        symmetry: the normal of the plane of symmetry that an edge lies on.
    """

    symmetry: Literal["x", "y"] | None = None

    @model_validator(mode="after")
    def _is_of_cloth(self) -> Self:
        if self.fix and self.symmetry is not None:
            raise UnitError("a support has fix or symmetry, not both", "make it two supports")
        if self.fix.get("slope", 0.0) != 0.0:
            raise UnitError("a slope is fixed as it is, and has no displacement", "write slope = 0")
        return self
