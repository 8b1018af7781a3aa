"""Sewing patterns as scenes of cloth, and the patterns that scenes have."""

# More than 15 modules: a scene and its pattern are turned into each other, by tables and by outlines.

from __future__ import annotations

from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from restshape.export.panel_tables import panel_shapes
from restshape.export.shape_tables import shape_tables
from restshape.export.toml_scene import toml_text
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.scene.bodies import Start, start_of
from restshape.scene.model import FORMAT, VERSION, Scene, ShapeSpec
from restshape.scene.panels import panels_of
from restshape.scene.plain_values import Table, table_in
from restshape.scene.space_values import evaluated
from restshape.shape.build import unchecked_outline
from restshape.shape.outline import Outline
from restshape.shape.patterns.pattern import Pattern, PatternPiece, Stitch, Triple
from restshape.shape.patterns.pattern_axes import UPRIGHT, angles_of
from restshape.shape.patterns.seam_parts import seam_names
from restshape.shape.placement import rotation

TRIANGLES = 2000
"""How many there are about in the meshes of all pieces."""
SHEET = "sheet"
"""The piece that the shape of a scene without panels is."""
FABRIC = "dress cloth"
TO_DO = """# Still to be given: what the pieces lie on, [bodies.NAME] with friction and [effects.contact], or what
# holds them, [supports.NAME]; then [effects.gravity]; and their fabric.
"""
DIGITS = 12
"""Significant digits of angles in degrees."""


def write_pattern_scene(pattern: Pattern, path: Path, title: str) -> list[str]:
    """Writes the scene of a pattern: a panel a piece, and its seams; bodies and supports are the user's to add.

    Raises:
        UserError: a piece is none.
        OSError: it cannot be written.
    """
    write_whole(path, f"# {EXPORT_MARK}\n{TO_DO}{toml_text(scene_tables(pattern, title))}")
    kept = [piece.name for piece in pattern.pieces if piece.kept or any(piece.kept_edges.values())]
    return [f"left out, for a scene has no such keys: what the file says besides of {', '.join(kept)}"] if kept else []


def scene_tables(pattern: Pattern, title: str) -> Table:
    """The plain tables of the scene of a pattern."""
    area = sum(piece.outline().area() for piece in pattern.pieces)
    # Equilateral triangles.
    size = np.sqrt(area / TRIANGLES * 4.0 / np.sqrt(3.0))
    tables: Table = {"format": FORMAT, "version": VERSION, "app": "couture", "title": title}
    if pattern.up == "y":
        tables["start"] = {"turn": _angles(UPRIGHT)}
    tables["panels"] = {piece.name: _panel(piece) for piece in pattern.pieces}
    if pattern.stitches:
        tables["seams"] = {
            name: {"from": _one_or_all(_whole(stitch, pattern)), "to": _one_or_all(stitch.second), **stitch.keys}
            for name, stitch in zip(seam_names(pattern), pattern.stitches)
        }
    tables["material"] = {"cloth": {"name": FABRIC}}
    tables["mesh"] = {"size": f"{1e3 * size:.2g} mm"}
    return tables


def _whole(stitch: Stitch, pattern: Pattern) -> tuple[str, ...]:
    """The first side of a seam; where pleats part its edges, these as they were before."""
    if "pleats" not in stitch.keys:
        return stitch.first
    former = {
        f"{piece.name}.{edge}": f"{piece.name}.{table_in(table_in(piece.shape, 'edges'), edge).get('part_of', edge)}"
        for piece in pattern.pieces
        for edge in table_in(piece.shape, "edges")
    }
    return tuple(dict.fromkeys(former.get(edge, edge) for edge in stitch.first))


def _panel(piece: PatternPiece) -> Table:
    table: Table = dict(piece.shape)
    if any(piece.move):
        table["move"] = list(piece.move)
    if any(piece.turn):
        table["turn"] = _angles(piece.turn)
    if piece.grain is not None:
        table["grain"] = _angles((piece.grain,))[0]
    return table


def _angles(angles: tuple[float, ...]) -> list[str]:
    return [f"{np.degrees(angle):.{DIGITS}g} deg" for angle in angles]


def _one_or_all(names: tuple[str, ...]) -> str | list[str]:
    return names[0] if len(names) == 1 else list(names)


def pattern_of_scene(scene: Scene) -> Pattern:
    """The pattern of a scene: its panels where they begin, and its seams; of one without panels its shape.

    Raises:
        UserError: the scene has no outline.
    """
    start = evaluated(start_of(scene) or Start(), scene.parameters)
    upright = bool(np.allclose(start.turn, UPRIGHT, atol=1e-12)) and not any((*start.move, *start.about))
    panels = panels_of(scene)
    outline = unchecked_outline(scene.shape, scene.folder)
    shapes = panel_shapes(outline, scene) if panels else {SHEET: shape_tables(outline)}
    pieces = tuple(
        _piece(name, shape, panels.get(name, scene.shape), Start() if upright else start, scene)
        for name, shape in shapes.items()
    )
    wrapped = [f"{name} on {panel.around}" for name, panel in panels.items() if panel.around is not None]
    notes = (f"left out, for pieces are flat: what is wrapped on a body, {', '.join(wrapped)}",) if wrapped else ()
    if layered := [f"{name} in {panel.layer}" for name, panel in panels.items() if panel.layer is not None]:
        notes += (f"left out, for patterns have none: layers of cloth, {', '.join(layered)}",)
    seams = scene.sections.get("seams") or {}
    assert isinstance(seams, dict)
    before = "" if panels else f"{SHEET}."
    stitches = tuple(_stitch(name, seam, before, outline) for name, seam in seams.items() if isinstance(seam, _Sewn))
    return Pattern(pieces, stitches, "y" if upright else "z", notes=notes)


@runtime_checkable
class _Sewn(Protocol):
    """What a seam says of itself."""

    @property
    def sides(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Names of edges."""

    @property
    def keys(self) -> Table:
        """What the scene says of it besides."""


def _stitch(name: str, seam: _Sewn, before: str, outline: Outline) -> Stitch:
    first, second = (_drawn(side, before, outline) for side in seam.sides)
    return Stitch(first, second, keys=dict(seam.keys), name=name)


def _drawn(names: tuple[str, ...], before: str, outline: Outline) -> tuple[str, ...]:
    """The edges of one side of a seam, ``PIECE.EDGE``; of one that a dart parts, its pieces in order along it."""
    return tuple(f"{before}{outline.edges[e].name}" for name in names for e in outline.entity(name).edges)


def _piece(name: str, shape: Table, panel: ShapeSpec, start: Start, scene: Scene) -> PatternPiece:
    """The piece that a panel of this shape is, in axes that all of them share."""
    keys = {key: getattr(panel, key) for key in ("turn", "about", "move") if hasattr(panel, key)}
    own = evaluated(Start.model_construct(**keys), scene.parameters)
    turn, all_turned = rotation(own.turn), rotation(start.turn)
    about, all_about = (np.array(one.about, dtype=float) for one in (own, start))
    move = all_turned @ (about - turn @ about + np.array(own.move) - all_about) + all_about + np.array(start.move)
    x, y, z = (float(value) for value in move)
    grain = _grain(panel, scene)
    turned: Triple = angles_of(all_turned @ turn) if any((*own.turn, *start.turn)) else (0.0, 0.0, 0.0)
    return PatternPiece(name, shape, (x, y, z), turned, grain)


def _grain(panel: ShapeSpec, scene: Scene) -> float | None:
    """The grain [rad] that a scene gives a panel, or else the material that it is of; None where neither is given."""
    own = getattr(panel, "grain", None)
    if own is None:
        named = {getattr(one, "material", None) for one in panels_of(scene).values()}
        rest = next((key for key, one in scene.material.items() if not one.region and key not in named), None)
        material = scene.material.get(getattr(panel, "material", None) or rest or "")
        given = material is not None and "grain" in material.model_fields_set
        own = getattr(material, "grain", None) if given else None
    return float(own) if isinstance(own, float) else None
