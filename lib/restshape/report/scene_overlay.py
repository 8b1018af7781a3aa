"""Supports, loads, the hand and names over the frames of a recording, from the scene and the script in its header."""

# More than 15 modules: what is drawn over a field comes from scene, script and recording.

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from restshape.errors import UserError
from restshape.replay.recording.recording import Recording
from restshape.replay.sessions import session_of
from restshape.report.conditions import Moved, draw_loads, draw_supports
from restshape.report.outlines import border, lines
from restshape.report.scene_picture import labels_beside, name_entities
from restshape.report.scenery import Scenery
from restshape.report.style import INK
from restshape.report.survey import known_displacement
from restshape.report.tables import refused
from restshape.scene.edit_script import Script, read_script
from restshape.scene.load import recorded_scene
from restshape.shape.script_frame import ScriptFrame

SAME = 1e-6
"""How far vertices that are rebuilt may be from nodes of the recording, over the size of the shape."""
HAND = 8.0
"""Size of the mark of the hand [points]."""
SAMPLES = np.linspace(0.0, 1.0, 9)


class Overlay:
    """What frames show besides the field, as it was in each frame.

    Args:
        recording: of a shape in the plane.
        scenery: common to all frames.
        wanted: frames that will be drawn.
        things: some of `REBUILT`.

    Raises:
        UserError: the recorded scene names a file, or makes other shapes now.
    """

    def __init__(self, recording: Recording, scenery: Scenery, wanted: Sequence[int], things: Sequence[str]) -> None:
        self.recording, self.scenery, self.things = recording, scenery, things
        self.frames = rebuilt_frames(recording, wanted)

    def draw(self, axes: Axes, i: int) -> list[Artist]:
        """Draws what frame i shows over its field; returns the artists."""
        before = set(axes.get_children())
        frame, moved = self.frames[i], follow(self.recording, i, self.scenery)
        scene, outline = frame.scene, frame.outline
        if "supports" in self.things:
            draw_supports(axes, scene, outline, moved)
        if "loads" in self.things:
            draw_loads(axes, scene, outline, moved, width=1.5)
        labels = labels_beside(axes, outline, moved)
        if "hand" in self.things and frame.hand:
            name, cursor = frame.hand
            (here,) = moved(np.array([cursor]))
            axes.plot(*here, marker="P", ms=HAND, mfc="white", mec=INK, mew=1.2, zorder=10)
            labels.occupy(here, 0.5 * HAND)
            labels.add(here, f"hand on {name}", INK, 7.0)
        if "names" in self.things:
            used = {name for table in (scene.supports, scene.loads) for one in table.values() for name in one.on}
            name_entities(labels, outline, moved, used, size=6.0)
        return [artist for artist in axes.get_children() if artist not in before]


def follow(recording: Recording, i: int, scenery: Scenery) -> Moved:
    """Where places at rest are drawn in frame i: moved as the nearest place of the border, or the nearest node, is."""
    from scipy.spatial import cKDTree

    X, cells = recording.mesh(i)
    u, around = scenery.scale * known_displacement(recording, i), border(cells)
    sides = around[:, :2] if around.shape[1] == 2 else around
    at, way = (_along(field, sides) for field in (X, u))
    tree, factor = cKDTree(np.vstack([at, X])), scenery.unit[0]
    ways = np.vstack([way, u])
    return lambda places: factor * (places + ways[tree.query(places)[1]])


def _along(field: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """A field (n, 2) at samples along sides (m, 2) or (m, 3)."""
    if sides.shape[1] == 3:
        return lines(field, sides).reshape(-1, 2)
    a, b = field[sides[:, 0]], field[sides[:, 1]]
    return (a[:, None] + SAMPLES[None, :, None] * (b - a)[:, None]).reshape(-1, 2)


def rebuilt_frames(recording: Recording, wanted: Sequence[int]) -> dict[int, ScriptFrame]:
    """Frames of the recorded session: scene, outline and hand of each that is wanted.

    Raises:
        UserError: the recorded scene names a file, has no outline, or makes other shapes now.
    """
    header, path = recording.header, recording.path
    raw: dict[str, Any] = header.get("scene_values", {})
    if any(isinstance(table, dict) and "file" in table for table in raw.values()):
        what = "the recorded scene takes its shape from a file, which a report does not read"
        raise UserError(what, "--show", "--show mesh,goal")
    raw = _without_body_files(raw, header.get("surfaces", {}))
    scene = recorded_scene(raw, path.with_name(Path(header.get("scene") or "scene").name))
    text, name = header.get("script_text", ""), path.with_name(Path(header.get("script") or "script").name)
    script = read_script(text, name, scene, keep_good=True) if text else Script.empty(scene)
    session, stopped, left = session_of(scene, script), refused(recording), set(map(int, wanted))
    if session.outline is None:
        raise UserError("what is recorded has no outline", str(path), "leave --show out")
    found: dict[int, ScriptFrame] = {}
    for frame in session.frames():
        if frame.index >= recording.n or not left:
            break
        if stopped[frame.index] and not frame.refused and frame.change != "none":
            # It had no solution.
            session.rollback()
        if frame.index in left:
            found[frame.index] = _checked(recording, frame)
            left.remove(frame.index)
    if left:
        raise UserError("its scene and its script make fewer frames now", str(path), "record it again")
    return found


def _without_body_files(raw: dict[str, Any], surfaces: dict[str, Any]) -> dict[str, Any]:
    """The tables of a scene with capsules for bodies whose surface a recording holds: the shape does not hang on them.

    Args:
        raw: plain tables; surfaces: of bodies of triangles by name, with their corners ``X``.
    """
    bodies = raw.get("bodies")
    if not surfaces or not isinstance(bodies, dict):
        return raw
    found = dict(bodies)
    for name, surface in surfaces.items():
        if isinstance(found.get(name), dict) and "mesh" in found[name]:
            X = np.array(surface["X"], float)
            low, high = X.min(axis=0), X.max(axis=0)
            middle, radius = 0.5 * (low + high), 0.5 * float((high - low)[:2].max())
            ends = {"start": [*middle[:2].tolist(), float(low[2])], "end": [*middle[:2].tolist(), float(high[2])]}
            kept = {key: value for key, value in found[name].items() if key != "mesh"}
            found[name] = {**kept, "capsule": {**ends, "radius": radius}}
    return {**raw, "bodies": found}


def _checked(recording: Recording, frame: ScriptFrame) -> ScriptFrame:
    """The frame, if its vertices are nodes of the recorded one.

    Raises:
        UserError: they are not.
    """
    from scipy.spatial import cKDTree

    assert frame.outline is not None, "what has no outline is refused"
    outline, X = frame.outline, recording.points(frame.index)
    on_edges = sorted({end for edge in outline.edges for end in (edge.start, edge.end)})
    far = cKDTree(X).query(outline.points[on_edges])[0].max()
    if not refused(recording)[frame.index] and far > SAME * outline.size:
        raise UserError("its scene and its script make other shapes now", str(recording.path), "record it again")
    return frame
