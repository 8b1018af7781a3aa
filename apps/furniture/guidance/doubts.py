"""What makes a piece doubtful that passes the full test."""

from __future__ import annotations

from collections.abc import Mapping

from restshape_apps.furniture.guidance.quantity_limits import violated_limits
from restshape_apps.furniture.physics import plank_findings
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.physics.joint_compliance import utilisation_range
from restshape_apps.furniture.shape.free_ends import free_ends
from restshape_apps.furniture.shape.planks import Piece

from restshape.findings import Finding
from restshape.scene.model import Quantity


def doubts(piece: Piece, quantities: Mapping[str, Quantity], bending: bool = False) -> tuple[Finding, ...]:
    """Joints and planks that are overloaded by what does not count, free ends, what compliances decide, and limits of
    quantities.

    Args:
        piece: that is valid, with closed joints.
        quantities: of its scene, by name.
        bending: whether planks bend.
    """
    result = Furniture(piece).test()
    return (*result.doubts, *free(piece), *depends(piece), *violated_limits(piece, quantities, bending))


def judged(piece: Piece, quantities: Mapping[str, Quantity], bending: bool = False) -> tuple[Finding, ...]:
    """What is wrong with a piece with closed joints, or doubtful where nothing is; arguments as of `doubts`."""
    result = Furniture(piece).test()
    if result.valid:
        return doubts(piece, quantities, bending)
    return (*result.findings, *depends(piece), *violated_limits(piece, quantities))


def free(piece: Piece) -> tuple[Finding, ...]:
    """Ends of a piece with closed joints that nothing holds, near a face."""
    return tuple(plank_findings.free(piece, free_ends(piece)))


def depends(piece: Piece) -> tuple[Finding, ...]:
    """Joints whose compliance, which nobody knows, decides whether a piece with closed joints holds."""
    known = utilisation_range(piece, Compliance())
    return known.findings(piece) if known else ()
