"""What an application gives to a fuzz: strategies of its scenes and of their edits."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hypothesis import strategies as st
from restshape_studies.stability.edit_strategies import gestures, sets, single_edits, small_moves
from restshape_studies.stability.shape_strategies import Table, entities

Parts = Sequence[st.SearchStrategy[list[Table]]]
ON_DEMAND: Table = {"analysis": "on demand"}


def outline_edits(scene: Table) -> Parts:
    """Edits of what has an outline."""
    return edits_with(scene, sets(scene))


def edits_with(scene: Table, values: st.SearchStrategy[list[Table]]) -> Parts:
    """Edits of what has an outline, with other values for its keys."""
    names = [*entities(scene["shape"]), *scene.get("bodies", {}), "q", "h1", "outline", "all"]
    return small_moves(scene), gestures(names), single_edits(names), values


def always(scene: Table) -> bool:
    """Of any scene."""
    return True


def never(scene: Table) -> bool:
    """Of no scene."""
    return False


@dataclass(frozen=True)
class RandomScenes:
    """Scenes of an application at random, and edits of them, of which most make sense.

    Args:
        scenes: tables of scenes.
        edits: kinds of edits of a scene, a list of events each.
        heads: what the first lines of scripts may hold besides.
        predictable: whether frames of a scene can be predicted.
        outlined: scenes have a [shape], which may be that of a file.
    """

    scenes: st.SearchStrategy[Table]
    edits: Callable[[Table], Parts] = outline_edits
    heads: tuple[Table, ...] = ({}, {}, {}, ON_DEMAND)
    predictable: Callable[[Table], bool] = always
    outlined: bool = True
