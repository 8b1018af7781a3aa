"""How much recorded cloth is stretched along warp and weft, triangle by triangle."""

from __future__ import annotations

import numpy as np
from matplotlib.path import Path as Border

from restshape.application import application_of
from restshape.fem.region_materials import materials_of_regions
from restshape.physics.cloth.pictures.drape import places
from restshape.replay.recording.recording import Recording
from restshape.scene.model import Scene
from restshape.scene.panels import frames_of, panels_of
from restshape.scene.plan import plan
from restshape.shape.outline import Loop, Outline

WARP, WEFT = "warp", "weft"


def stretches(X: np.ndarray, x: np.ndarray, cells: np.ndarray, grain: np.ndarray) -> dict[str, np.ndarray]:
    """Strains (ne,) along and across the grain, lengths over those of the pattern less 1: below 0 the cloth is eased.

    Args:
        X: (n, 2) places in the pattern [m]; x: (n, 3) positions [m]; cells: (ne, 3); grain: (ne,) its angle [rad].
    """
    flat, now = (values[cells[:, 1:3]] - values[cells[:, :1]] for values in (X, x))
    # Rows are edges: now = flat F^T.
    gradient = np.linalg.solve(flat, now)
    found = {}
    for name, angle in ((WARP, grain), (WEFT, grain + 0.5 * np.pi)):
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        found[name] = np.linalg.norm(np.einsum("ei,eij->ej", along, gradient), axis=1) - 1.0
    return found


def recorded_stretches(recording: Recording, i: int, scene: Scene, outline: Outline) -> dict[str, np.ndarray]:
    """The strains (ne,) of frame i along warp and weft.

    Args:
        recording: of cloth; i: number of the frame; scene, outline: of it.
    """
    X, cells = recording.mesh(i)
    grain = grain_angles(scene, outline, X[cells[:, :3]].mean(axis=1))
    return stretches(X, places(recording, i), cells[:, :3], grain)


def grain_angles(scene: Scene, outline: Outline, middles: np.ndarray) -> np.ndarray:
    """The angle (n,) [rad] of the grain in the pattern plane at places (n, 2) [m] of the pattern."""
    rest, of_region = materials_of_regions(scene, outline)
    named = np.full(len(middles), rest, object)
    piece = np.zeros(len(middles), int)
    for loop in outline.loops:
        inside = _inside(outline, loop, middles)
        if loop.kind == "outline":
            piece[inside] = loop.piece
        elif loop.kind == "region" and loop.name in of_region:
            named[inside] = of_region[loop.name]
    panels, frames = panels_of(scene), frames_of(scene)
    found = np.zeros(len(middles))
    pairs = zip(named.tolist(), piece.tolist())
    for k, (name, number) in enumerate(pairs):
        panel = outline.piece_names[number]
        material = name if name in of_region.values() else getattr(panels.get(panel), "material", None) or name
        own = scene.material[material].grain if material in scene.material else 0.0
        given = panels[panel].grain if panel in panels else None
        angle = frames[panel].angle if panel in frames else 0.0
        found[k] = (own if given is None else given) + angle
    return found


def _inside(outline: Outline, loop: Loop, middles: np.ndarray) -> np.ndarray:
    """Which of the places (n, 2) are inside of a loop."""
    parts = [outline.polyline(e) if forward else outline.polyline(e)[::-1] for e, forward in loop.edges]
    return Border(np.concatenate(parts)).contains_points(middles)


def trusted_strain(scene: Scene) -> float:
    """The strain up to which a scene's cloth is trusted."""
    return float(plan(scene, application_of(scene)).settings("cloth").trusted_strain)
