"""How long both sides of seams are, and which halves of a panel on the fold are left open, before anything is sewn."""

from __future__ import annotations

from dataclasses import dataclass

from restshape.outputs.si_numbers import si
from restshape.physics.cloth.seams.loose_panels import loose_panels
from restshape.scene.dart_keys import IMAGE
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline


@dataclass(frozen=True)
class SeamLengths:
    """A seam in the pattern.

    Args:
        name: of the seam; ease: as of `Seam`.
        start, to: lengths of its sides [m]; folded: what pleats take from the first one [m].
    """

    name: str
    ease: float
    start: float
    to: float
    folded: float = 0.0

    @property
    def excess(self) -> float:
        """How much longer one side is than the other one, over the length of that."""
        shorter, longer = sorted((self.start - self.folded, self.to))
        return longer / shorter - 1.0 if shorter > 0.0 else float("inf")

    @property
    def doubt(self) -> str:
        """What to warn of where they differ by more than the ease; else empty."""
        if self.excess <= self.ease:
            return ""
        key = "from" if self.start - self.folded > self.to else "to"
        more = f"{100.0 * self.excess:.3g} % longer than the other side"
        return f"seams.{self.name}.{key}: {more}, which gathers it: name other edges, or set seams.{self.name}.ease"

    def __str__(self) -> str:
        start = si(self.start - self.folded, "m", 4) + (f" (flat {si(self.start, 'm', 4)})" if self.folded else "")
        return f"from {start}, to {si(self.to, 'm', 4)}"


def seam_lengths(scene: Scene, outline: Outline) -> list[SeamLengths]:
    """Those of all seams of a scene but of darts, whose sides are as long as each other."""
    lengths, own = outline.lengths(), {dart.seam_name for dart in scene.shape.darts}
    found = []
    for name, seam in scene.seams.items():
        if name in own:
            continue
        start, to = (sum(float(lengths[list(outline.entity(e).edges)].sum()) for e in side) for side in seam.sides)
        folded = sum(2.0 * one.pleat.depth for one in scene.shape.pleats if one.seam == name)
        found.append(SeamLengths(name, seam.ease, start, to, folded))
    return found


def open_halves(scene: Scene) -> list[str]:
    """What there is to doubt of panels on the fold that are sewn on one half alone: seams have no mirror images."""
    sewn = {edge for seam in scene.seams.values() for side in seam.sides for edge in side}
    border = {edge for edges in scene.shape.pieces.values() for edge in edges}
    found = []
    for edge in sorted(sewn & border):
        panel, _, own = edge.partition(".")
        half = own.removeprefix(f"{IMAGE}.")
        other = f"{panel}.{IMAGE}.{own}" if half == own else f"{panel}.{half}"
        if other in border and other not in sewn:
            found.append(f"{edge} is sewn, and its image {other} is not: seams are not mirrored, write one of it")
    return found


def inspect_seams(scene: Scene, outline: Outline) -> Inspection:
    """What `restshape check` shows of seams: lengths of their sides, and what is doubtful."""
    found = seam_lengths(scene, outline)
    data = {one.name: {"from": one.start - one.folded, "to": one.to} for one in found}
    doubts = [one.doubt for one in sorted(found, key=lambda one: -one.excess) if one.doubt]
    rows = [(f"lengths of {one.name}", str(one)) for one in found]
    return Inspection(
        {"seam_lengths": data} if data else {}, rows, (*doubts, *open_halves(scene), *loose_panels(scene, outline))
    )
