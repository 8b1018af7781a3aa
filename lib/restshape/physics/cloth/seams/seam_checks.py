"""Whether what a scene says about its seams makes sense."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.scene.edge_names import edge_suggestion
from restshape.scene.panels import folds_of
from restshape.scene.seam_keys import Seam, edges_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from restshape.scene.model import Scene
    from restshape.scene.source import Source


def lines_inside(scene: Scene, kinds: Mapping[str, str]) -> set[str]:
    """Edges of regions that are on no outline and on no hole: lines inside the cloth."""

    def of(loops: Mapping[str, object]) -> set[str]:
        named = {edge for loop in loops.values() for edge in getattr(loop, "loop", ())}
        return named | {edge for edge in kinds if edge.rpartition(".")[0] in loops}

    around = {edge for edges in scene.shape.pieces.values() for edge in edges}
    return of(scene.shape.regions) - of(scene.shape.holes) - around


def check_seams(scene: Scene, kinds: Mapping[str, str], source: Source) -> None:
    """Checks what seams join.

    Args:
        scene: of cloth; source: of it.
        kinds: of the shape's entities by name.

    Raises:
        UserError: a side is no edge or on a plane of symmetry, or two seams pair the same edges in unlike ways.
    """
    folds = set(folds_of(scene).values())
    mirrored = {name for support in scene.supports.values() if support.symmetry for name in edges_of(support.on)}
    inside = lines_inside(scene, kinds)
    for name, seam in scene.seams.items():
        for key, side in zip(("from", "to"), seam.sides):
            for edge in side:
                if edge in folds:
                    what = f"the seam is on {edge!r}, about which the panel is unfolded: there the cloth goes on"
                    raise source.error(("seams", name, key), what, "take out the seam, or the panel's mirror")
                if not kinds.get(edge, "").endswith("edge"):
                    is_it = f"is {kinds[edge]!r}" if edge in kinds else "is not there"
                    edges = [one for one, kind in kinds.items() if kind.endswith("edge")]
                    what = f"the seam is to join the edge {edge!r}, which {is_it}"
                    raise source.error(("seams", name, key), what, edge_suggestion(edge, edges))
                if edge in mirrored:
                    what = f"the seam is on {edge!r}, which lies on a plane of symmetry: there the cloth goes on"
                    raise source.error(("seams", name, key), what, "take out the seam, or the symmetry")
        inner = next((edge for edge in (*seam.sides[0], *seam.sides[1]) if edge in inside), None)
        if seam.stitched == "flat" and inner is not None:
            what = f"the edge {inner!r} lies inside a panel, where the cloth goes on: nothing bends across a seam there"
            raise source.error(("seams", name, "stitched"), what, "take out stitched")
        if seam.pleats and (inner := next((edge for edge in seam.sides[0] if edge in inside), None)) is not None:
            what = f"the edge {inner!r} lies inside a panel, where the cloth goes on: it has no pleats there"
            raise source.error(("seams", name, "pleats"), what, "take out the pleats, or let the seam begin at an edge")
        for other in scene.seams:
            if other == name:
                break
            if shared := _shared(scene.seams[other], seam):
                alike = _joins_alike(scene.seams[other], seam)
                what = f"the seams {other!r} and {name!r} both join {shared[0]!r} and {shared[1]!r}"
                what += "" if alike else ", in unlike ways"
                raise source.error(("seams", name), what, "keep one of them")


def _shared(one: Seam, other: Seam) -> tuple[str, str] | None:
    """Two edges that both of two seams sew to each other; None where there are none."""
    for first, second in (other.sides, other.sides[::-1]):
        pair = [
            next((edge for edge in mine if edge in theirs), None) for mine, theirs in zip(one.sides, (first, second))
        ]
        if pair[0] is not None and pair[1] is not None:
            return pair[0], pair[1]
    return None


def _joins_alike(one: Seam, other: Seam) -> bool:
    """Whether two seams join the same edges the same way round."""
    return frozenset(one.sides) == frozenset(other.sides) and one.reverse == other.reverse
