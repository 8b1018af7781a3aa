"""Outlines with one dart more: cut out of them, or kept as a region between its legs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.dart_keys import PlacedDart
from restshape.shape.draft import Draft, DraftEdge, add_loop, draft_of
from restshape.shape.outline import Outline
from restshape.shape.panels.dart_mouth import Mouth
from restshape.shape.topology_edits import insert

Way = tuple[str, bool]
"""An edge by name, and whether it is traversed forwards."""


def cut_dart(
    outline: Outline,
    placed: PlacedDart,
    tip: Reals,
    left: Reals,
    right: Reals,
    foot: Reals | None,
    mouth: Mouth | None,
) -> Outline:
    """The outline with a dart.

    Args:
        outline: without it; placed: the dart.
        tip, left, right: (2,) its corners [m]; left and right as they lie, also of a mirror image.
        foot: (2,) the other tip of one inside; None: it opens at an edge.
        mouth: of one on an edge.
    """
    ends = {"left": left, "right": right}
    if mouth is not None:
        return _on_edge(outline, placed, tip, ends, mouth)
    assert foot is not None, "a dart inside has two tips"
    return _inside(outline, placed, {"foot": foot, "tip": tip}, ends)


def _named(placed: PlacedDart, side: str) -> str:
    """The side of a dart that is there: the other one of a mirror image."""
    return {"left": "right", "right": "left"}[side] if placed.image else side


def _on_edge(outline: Outline, placed: PlacedDart, tip: Reals, ends: dict[str, Reals], mouth: Mouth) -> Outline:
    mouths = {side: f"{placed.name}.mouth_{_named(placed, side)}" for side in ends}
    for side, parent, place in zip(ends, mouth.names, mouth.meets):
        outline = _with_mouth_end(outline, placed, parent, mouths[side], place)
    between = _between(draft_of(outline), mouths["left"], mouths["right"])
    if placed.dart.folded and len(between) == 1:
        outline = insert(outline, between[0][0], f"{placed.name}.mouth_middle", s=0.5)
    draft = draft_of(outline)
    between = _between(draft, mouths["left"], mouths["right"])
    for side, place in ends.items():
        draft.vertices[mouths[side]] = _pair(place)
    top = f"{placed.name}.tip"
    draft.vertices[top] = _pair(tip)
    legs = {
        side: DraftEdge(f"{placed.name}.{_named(placed, side)}", "line", mouths[side], top)
        for side in ("left", "right")
    }
    if placed.dart.folded:
        _keep(draft, placed, between, legs)
    else:
        _take_out(draft, placed, between, legs)
    return draft.outline()


def _with_mouth_end(outline: Outline, placed: PlacedDart, parent: str, name: str, place: Reals) -> Outline:
    """The outline with one end of a dart's mouth.

    Raises:
        UserError: there is a vertex already.
    """
    try:
        return insert(outline, parent, name, at=place)
    except UserError as error:
        what = f"one end of the dart's mouth is at ({place[0]:.4g}, {place[1]:.4g}) m: {error.what}"
        do = "make it wider, or move it away from the corner or the other dart"
        raise UserError(what, placed.where, do) from None


def _pair(place: Reals) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def _between(draft: Draft, left: str, right: str) -> list[Way]:
    """The edges between two vertices of a loop that bounds cloth, one or two, in its direction."""
    for _, kind, chain in draft.loops:
        begins = [draft.edges[e].start if forward else draft.edges[e].end for e, forward in chain]
        if kind != "region" and left in begins and right in begins:
            k = begins.index(left)
            turned = [*chain[k:], *chain[:k]]
            return turned[: (begins.index(right) - k) % len(chain)]
    raise AssertionError("both ends of a mouth are on one loop")


def _take_out(draft: Draft, placed: PlacedDart, between: Sequence[Way], legs: dict[str, DraftEdge]) -> None:
    """Puts legs in the place of what is between both ends of the mouth."""
    new = {leg.name: leg for leg in legs.values()}
    whole = [(legs["left"].name, True), (legs["right"].name, False)]
    parts = [[one] for one in whole] if len(between) == 2 else [whole]
    for (old, way), part in zip(between, parts):
        _replace(draft, old, part if way else [(e, not f) for e, f in reversed(part)])
    gone = {old: draft.edges[old].parent for old, _ in between}
    if len(between) == 2:
        corner = _end(draft, between[0])
        _drop(draft, [old for old, _ in between])
        # A fold that ends in the corner ends at the tip.
        draft.edges = {name: _moved_end(edge, corner, legs["left"].end) for name, edge in draft.edges.items()}
        del draft.vertices[corner]
        on_left = gone[between[0][0]] == placed.edge
        _name_end(draft, corner, legs["left" if on_left else "right"].start)
    else:
        _drop(draft, [between[0][0]])
    for parent in gone.values():
        _named_alone(draft, parent)
    draft.edges |= new
    draft.groups = {**draft.groups, placed.name: tuple(new)}


def _name_end(draft: Draft, corner: str, end: str) -> None:
    """Lets the name of a corner that is cut away name an end of the mouth, to which the other one is sewn."""
    draft.groups = {
        group: tuple(end if part == corner else part for part in parts) for group, parts in draft.groups.items()
    } | {corner: (end,)}


def _end(draft: Draft, way: Way) -> str:
    edge = draft.edges[way[0]]
    return edge.end if way[1] else edge.start


def _moved_end(edge: DraftEdge, corner: str, to: str) -> DraftEdge:
    return replace(edge, start=to if edge.start == corner else edge.start, end=to if edge.end == corner else edge.end)


def _replace(draft: Draft, old: str, ways: Sequence[Way]) -> None:
    """Puts edges, in the direction of an edge, in its place in all loops."""

    def spliced(chain: list[Way]) -> list[Way]:
        turned = [(e, not f) for e, f in reversed(ways)]
        return [one for e, f in chain for one in ((ways if f else turned) if e == old else [(e, f)])]

    draft.loops = [(name, kind, spliced(chain)) for name, kind, chain in draft.loops]


def _drop(draft: Draft, names: Sequence[str]) -> None:
    draft.edges = {name: edge for name, edge in draft.edges.items() if name not in names}
    draft.groups = {group: tuple(p for p in parts if p not in names) for group, parts in draft.groups.items()}


def _keep(draft: Draft, placed: PlacedDart, between: Sequence[Way], legs: dict[str, DraftEdge]) -> None:
    """Makes what is between the legs two regions, which have a line in the middle in common, along which it folds."""
    name = f"{placed.name}.mouth"
    names = [f"{name}.{_named(placed, side)}" for side in legs]
    middle = _end(draft, between[0])
    _rename(draft, dict(zip((old for old, _ in between), names)), name)
    fold = DraftEdge(f"{placed.name}.fold", "line", middle, legs["left"].end)
    draft.edges |= {leg.name: leg for leg in (*legs.values(), fold)}
    for side, own in zip(legs, names):
        add_loop(draft, f"{placed.name}.half_{_named(placed, side)}", "region", [own, fold.name, legs[side].name])
    draft.groups = {**draft.groups, placed.name: tuple(f"{placed.name}.half_{side}" for side in legs)}


def _named_alone(draft: Draft, parent: str) -> None:
    """Gives an edge of which one piece is left its own name again."""
    pieces = [name for name, edge in draft.edges.items() if edge.parent == parent]
    if len(pieces) == 1:
        _rename(draft, {pieces[0]: parent}, parent)


def _rename(draft: Draft, names: dict[str, str], parent: str) -> None:
    """Gives edges other names, of one parent."""
    renamed: Callable[[str], str] = lambda name: names.get(name, name)  # noqa: E731
    draft.edges = {
        renamed(name): replace(edge, name=names[name], parent=parent) if name in names else edge
        for name, edge in draft.edges.items()
    }
    draft.loops = [(loop, kind, [(renamed(e), f) for e, f in chain]) for loop, kind, chain in draft.loops]
    draft.groups = {group: tuple(map(renamed, parts)) for group, parts in draft.groups.items()}


def _inside(outline: Outline, placed: PlacedDart, tips: dict[str, Reals], ends: dict[str, Reals]) -> Outline:
    """A diamond, as a hole or a region; on a fold, which then ends at it and begins again."""
    name = placed.name
    if placed.fold:
        for end, place in tips.items():
            outline = insert(outline, placed.fold, f"{name}.{end}", at=place)
    draft = draft_of(outline)
    sides = {side: _named(placed, side) for side in ends}
    corners = {f"{name}.tip": tips["tip"], f"{name}.widest_{sides['left']}": ends["left"]}
    corners |= {f"{name}.foot": tips["foot"], f"{name}.widest_{sides['right']}": ends["right"]}
    draft.vertices |= {corner: _pair(place) for corner, place in corners.items()}
    for side in sides.values():
        widest, leg = f"{name}.widest_{side}", f"{name}.{side}"
        draft.edges[f"{leg}.1"] = DraftEdge(f"{leg}.1", "line", f"{name}.foot", widest, leg)
        draft.edges[f"{leg}.2"] = DraftEdge(f"{leg}.2", "line", widest, f"{name}.tip", leg)
    if placed.fold:
        _open_fold(draft, placed)
    left, right = (f"{name}.{side}" for side in sides.values())
    if not placed.dart.folded:
        add_loop(draft, name, "hole", [f"{left}.2", f"{left}.1", f"{right}.1", f"{right}.2"])
        return draft.outline()
    fold = f"{name}.fold"
    draft.edges[fold] = DraftEdge(fold, "line", f"{name}.foot", f"{name}.tip")
    for side in ends:
        add_loop(draft, f"{name}.half_{side}", "region", [f"{name}.{side}.1", f"{name}.{side}.2", fold])
    draft.groups = {**draft.groups, name: tuple(f"{name}.half_{side}" for side in ends)}
    return draft.outline()


def _open_fold(draft: Draft, placed: PlacedDart) -> None:
    """Leads the region of the other half around a diamond on the fold."""
    pair = {f"{placed.name}.foot", f"{placed.name}.tip"}
    old = next(edge for edge in draft.edges.values() if {edge.start, edge.end} == pair)
    upwards = old.start == f"{placed.name}.foot"
    for loop, kind, chain in list(draft.loops):
        way = dict(chain).get(old.name)
        if kind != "region" or way is None:
            continue
        # A region lies on the left of its sides.
        side = "left" if way == upwards else "right"
        legs = [(f"{placed.name}.{side}.{i}", True) for i in (1, 2)]
        own = legs if way == upwards else [(e, False) for e, _ in reversed(legs)]
        around = [one for e, f in chain for one in (own if e == old.name else [(e, f)])]
        draft.loops = [(n, k, around if n == loop else c) for n, k, c in draft.loops]
    _drop(draft, [old.name])
