"""The lines that panels are unfolded about, in the pattern plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.arrays import Reals
from restshape.scene.dart_keys import IMAGE
from restshape.scene.model import Scene
from restshape.scene.panels import folds_of
from restshape.shape.outline import Outline
from restshape.shape.panels.dart_mouth import ends_of


@dataclass(frozen=True, eq=False)
class FoldLine:
    """The line that a panel is unfolded about.

    Args:
        ends: (k, 2) of its pieces [m].
        half: (2,) a place in the half that is the panel's own [m].
    """

    ends: Reals
    half: Reals

    def of_half(self, start: Reals, end: Reals, near: float) -> list[Reals]:
        """The ends of a line, or of its mirror image, in the panel's own half; on the fold if it is near.

        Args:
            start, end: (2,) of the line [m].
            near: distance from the fold, over the line's length, up to which it lies on that.
        """
        along = (self.ends[1] - self.ends[0]) / np.hypot(*(self.ends[1] - self.ends[0]))
        normal = np.array([-along[1], along[0]])
        normal = normal * np.sign((self.half - self.ends[0]) @ normal)
        away = np.array([(p - self.ends[0]) @ normal for p in (start, end)])
        if np.abs(away).max() <= near * np.hypot(*(end - start)):
            return [p - d * normal for p, d in zip((start, end), away)]
        return [p - (2.0 * d * normal if away.sum() < 0.0 else 0.0) for p, d in zip((start, end), away)]


def fold_of(scene: Scene, outline: Outline, panel: str) -> FoldLine | None:
    """The fold of a panel; None where it has none."""
    name = folds_of(scene).get(panel)
    if name is None:
        return None
    own = outline.entity(panel).vertices
    half = [v for v in own if not outline.vertex_names[v].startswith(f"{panel}.{IMAGE}.")]
    return FoldLine(ends_of(outline, name), outline.points[half].mean(axis=0))
