"""Hypothesis strategies of scenes, edit scripts and damage to them, for the fuzz and for tests."""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from restshape.policy import POLICIES
from restshape.stability.cloth_strategies import CLOTH, cloth_scenes, cloth_sets
from restshape.stability.plank_strategies import (
    EXTRA,
    FURNITURE,
    choices,
    plank_edits,
    plank_gestures,
    plank_scenes,
    plank_sets,
)
from restshape.stability.shape_strategies import Table, angles, entities, mesh_size, numbers, places, shapes, sides

MOST_ELEMENTS = 200
"""Of a scene's first mesh."""
SCENE, EDITS = "scene.toml", "edits.jsonl"
RECORDING, TABLE, SUMMARY = "frames.vtkhdf", "frames.csv", "summary.json"
WRITTEN_SHARE = 5
"""Every fifth example, about, is replayed by the command too."""


@dataclass(frozen=True)
class Example:
    """A scene and edits as text, and how they are replayed.

    Args:
        app: application that the scene was made for.
        scene, edits: texts of the two files.
        policy, predict: as after --policy and --predict.
        damaged: what was done to the files; empty where they are as they were made.
        written: the command replays them too, and writes all that it can.
    """

    app: str
    scene: str
    edits: str
    policy: str
    predict: str
    damaged: str = ""
    written: bool = False

    def write(self, folder: Path) -> None:
        """Write the two files and what else a replay wants to know into a folder."""
        (folder / SCENE).write_text(self.scene, encoding="utf-8", errors="surrogatepass")
        (folder / EDITS).write_text(self.edits, encoding="utf-8", errors="surrogatepass")
        (folder / "example.json").write_text(json.dumps(asdict(self)) + "\n")

    @property
    def words(self) -> list[str]:
        """The words after `restshape` that replay the files."""
        written = ["--out", RECORDING, "--csv", TABLE, "--json", SUMMARY] if self.written else []
        return ["replay", SCENE, "--edits", EDITS, "--policy", self.policy, "--predict", self.predict, *written]

    @property
    def command(self) -> str:
        """The command that replays the files."""
        return " ".join(["restshape", *self.words])


def toml(table: Table) -> str:
    """The text of plain tables: a line a key, with inline tables below the second level."""
    lines = [f"{key} = {_inline(value)}" for key, value in table.items() if not isinstance(value, dict)]
    for key, value in table.items():
        if isinstance(value, dict):
            lines += [f"\n[{_key(key)}]", *(f"{_key(k)} = {_inline(v)}" for k, v in value.items())]
    return "\n".join(lines) + "\n"


def _key(name: str) -> str:
    return name if name and all(c.isascii() and (c.isalnum() or c in "_-") for c in name) else json.dumps(name)


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items()) + " }" if value else "{}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_inline(v) for v in value) + "]"
    if isinstance(value, float) and not math.isfinite(value):
        return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    return json.dumps(value)


@st.composite
def isotropic(draw: st.DrawFn) -> Table:
    """A material by E and nu."""
    return {
        "E": draw(st.sampled_from([1e6, 1e3, 2e9, 2.1e11])),
        "nu": draw(st.sampled_from([0.3, 0.0, 0.49, 0.4999, 0.49999999, -0.5])),
        "rho": draw(st.sampled_from([1000.0, 1.0, 8000.0] * 6 + [0.0])),
        "thickness": draw(st.sampled_from([0.01, 1e-4, 1.0])),
    }


WOOD = {"E": [1e10, 1e9, 5e8], "nu": [0.3, 0.3, 0.4], "G": [8e8, 7e8, 2e8]}


@st.composite
def materials(draw: st.DrawFn, shape: Table, layered: bool) -> Table:
    """The [material] of a shape, its region of another one."""
    first = draw(isotropic())
    if layered:
        if draw(st.integers(0, 3)) == 0:
            first = {"orthotropic": WOOD, "grain": draw(angles), "rho": 800.0, "thickness": 0.01}
        if draw(st.integers(0, 3)) == 0:
            first["thickness"] = draw(st.sampled_from(["0.02 + 0.01*x", "0.01*(1 + x*x)", "0.005 - 0.01*x"]))
    found = {"m": first}
    if "regions" in shape and draw(st.booleans()):
        found["inner"] = {**draw(isotropic()), "thickness": first["thickness"], "region": ["patch"]}
    return found


@st.composite
def supports(draw: st.DrawFn, shape: Table, plate: bool, modal: bool) -> Table:
    """The [supports]: mostly one that holds an edge, at times none."""
    wholly = ["z", "rx", "ry"] if plate else ["x", "y"]
    found = {}
    for k in range(draw(st.sampled_from([1, 1, 1, 1, 1, 2, 2, 2] * 2 + [0]))):
        on = draw(
            st.sampled_from([*shape.get("holes", {}), *list(shape["edges"])[2:], "p3"] if k else ["e1", "outline"])
        )
        given = st.sampled_from([0.0, 0.01, "0.1*x", "k", 1.5]) if not modal else st.just(0.0)
        fix = (
            wholly if k == 0 and draw(st.integers(0, 19)) < 19 else draw(st.sampled_from([wholly, wholly[:1], "given"]))
        )
        found[f"s{k}"] = {"on": on, "fix": {wholly[0]: draw(given)} if fix == "given" else fix}
    return found


@st.composite
def loads(draw: st.DrawFn, shape: Table, stiffness: float, thickness: float) -> Table:
    """The [loads] from hardly any to one that no body bears."""
    found = {}
    for k in range(draw(st.sampled_from([1, 1, 2, 0]))):
        kind = draw(st.sampled_from(["force", "traction", "pressure", "body"]))
        size = stiffness * draw(st.sampled_from([1e-4, 1e-8, 1e-3, -1e-3, 1e-2, 1.0]))
        size *= thickness if kind == "force" else 1.0
        vector = [size * draw(numbers(-1, 1)), size * draw(numbers(-1, 1))]
        value: Any = size if kind == "pressure" else vector
        if draw(st.integers(0, 5)) == 0 and kind != "force":
            value = f"{size!r}*x" if kind == "pressure" else [f"{size!r}*(x + k*y)", vector[1]]
        on = {"force": [*shape["vertices"], *shape["edges"]], "body": ["all", *shape.get("regions", {})]}
        found[f"l{k}"] = {"on": draw(st.sampled_from(on.get(kind, sides(shape)))), kind: value}
    return found


gravity = st.tuples(numbers(-10, 10), numbers(-10, 10)).map(lambda g: {"g": list(g)})


@st.composite
def solid_effects(draw: st.DrawFn, app: str) -> Table:
    """The [effects] of solids at rest or in motion."""
    large = app == "cantilever" or draw(st.booleans())
    found: Table = {"solid": {"model": draw(st.sampled_from(["plane_stress", "plane_strain"]))}}
    if draw(st.integers(0, 5)) == 5:
        found["solid"]["element"] = draw(st.sampled_from(["displacement", "mean_dilatation"]))
    if large:
        found["large_deformation"] = draw(st.sampled_from([{}, {"load_steps": 5}]))
    if draw(st.booleans()):
        found["gravity"] = draw(gravity)
    if app == "solid" and not large and draw(st.booleans()):
        found["buckling"] = {
            "modes": draw(st.integers(1, 4)),
            "load": draw(st.sampled_from(["given", "given", "reversed"])),
        }
    if app == "vibration":
        found |= draw(motion())
    return found


@st.composite
def motion(draw: st.DrawFn) -> Table:
    """The [effects] of motion in time."""
    newmark = draw(st.sampled_from([{}, {"beta": 0.3025, "gamma": 0.6}, {"mass": "lumped"}, {"beta": 0.05}]))
    step = draw(st.sampled_from([0.01, 1e-4, 1.0]))
    found: Table = {"dynamics": {"time_step": step, "steps": draw(st.integers(1, 4)), **newmark}}
    if draw(st.booleans()):
        kind = draw(st.sampled_from(["displacement", "acceleration"]))
        found["ground"] = {kind: draw(st.sampled_from([0.1, 10.0])), "frequency": draw(st.sampled_from([2.0, 200.0]))}
    if draw(st.booleans()):
        ways = [{"ratio": 0.02, "frequencies": [1.0, 30.0]}, {"alpha": 0.5, "beta": 1e-3}, {"beta": 0.1}]
        found["damping"] = draw(st.sampled_from(ways))
    return found


@st.composite
def quantities(draw: st.DrawFn, shape: Table, app: str, effects: Table) -> Table:
    """The [quantities] of each kind that the application has, some with a limit."""
    at = st.sampled_from(entities(shape))
    found: Table = {"area": {"area": True}}
    if app == "metallophone":
        found["first"] = {"frequency": 1}
        if draw(st.booleans()):
            found["followed"] = {"mode": draw(st.integers(1, effects["modal"]["modes"]))}
        return found
    found["far"] = {"displacement": draw(st.sampled_from(["x", "y", "magnitude"])), "at": draw(at)}
    if draw(st.booleans()):
        found["far"]["take"] = draw(st.sampled_from(["max", "min", "absmax", "mean"]))
    if draw(st.booleans()):
        kind = draw(st.sampled_from(["von_mises", "xy", "max_principal"]))
        found["stress"] = {"stress": kind, "take": draw(st.sampled_from(["max", "mean"]))}
    if draw(st.booleans()):
        found["energy"] = {"energy": "strain" if app != "vibration" else draw(st.sampled_from(["total", "edit"]))}
    if draw(st.integers(0, 2)) == 0:
        found["wall"] = {"reaction": "x", "at": "e1"}
    if app == "cantilever":
        found["goal"] = {"distance": "curve"}
    if app == "solid" and "buckling" in effects:
        found["critical"] = {"load_factor": 1, "at_least": 1.0}
    if app == "bridge":
        found["strength"] = {"stress": "von_mises", "take": "max", "limit": 1e6}
    return found


@st.composite
def modal_effects(draw: st.DrawFn) -> Table:
    """The [effects] of free vibrations."""
    modal = {"model": draw(st.sampled_from(["plate", "solid", "plane_stress", "plane_strain"]))}
    return {"modal": {**modal, "modes": draw(st.integers(1, 6)), "in_plane": draw(st.booleans())}}


@st.composite
def meshes(draw: st.DrawFn, area: float, effects: Table) -> Table:
    """The [mesh] of about 3 to 120 elements over an area [m^2]."""
    model = effects.get("modal", {}).get("model", "")
    most = 20 if model == "solid" else 120
    size = mesh_size(area, draw(st.integers(3, most)))
    mesh: Table = {"size": size}
    if draw(st.booleans()) and model != "plate":
        mesh["order"] = draw(st.sampled_from([1, 2]))
    if model == "solid":
        mesh["layers"] = draw(st.integers(1, 2))
    if draw(st.integers(0, 2)) == 0:
        mesh["relocation"] = draw(st.sampled_from(["harmonic", "mvc", "laplacian"]))
    if draw(st.integers(0, 3)) == 0:
        mesh["mesher"] = draw(st.sampled_from(["cgal", "gmsh"]))
    if draw(st.integers(0, 3)) == 0:
        mesh |= {"criterion": "author"} if draw(st.booleans()) else {"min_quality": draw(numbers(0.01, 0.6))}
    if draw(st.integers(0, 4)) == 0:
        mesh["near"] = {"p1": round(size * draw(numbers(0.3, 2)), 3)}
    return mesh


@st.composite
def scenes(draw: st.DrawFn, app: str) -> Table:
    """The tables of a scene of an application."""
    if app == CLOTH:
        return draw(cloth_scenes())
    if app == FURNITURE:
        return draw(plank_scenes())
    shape, area = draw(shapes())
    modal = app == "metallophone"
    effects = draw(modal_effects() if modal else solid_effects(app))
    bodies = draw(materials(shape, modal))
    scene: Table = {"format": "restshape-scene", "version": 1, "app": app}
    scene |= {"parameters": {"k": draw(numbers(-0.2, 0.2))}, "shape": shape, "material": bodies, "effects": effects}
    if not modal or draw(st.booleans()):
        scene["supports"] = draw(supports(shape, effects.get("modal", {}).get("model") == "plate", modal))
    if not modal:
        body = bodies["m"]
        scene["loads"] = draw(loads(shape, body["E"], body["thickness"]))
    if app == "cantilever":
        scene["goal"] = {"curve": {draw(st.sampled_from(["spline", "polyline"])): [[-1, -1], [0, 0.4], [1, 1]]}}
    if "gravity" in effects and not bodies["m"]["rho"] and draw(st.integers(0, 9)):
        del effects["gravity"]
    scene["mesh"] = draw(meshes(area, effects))
    scene["solve"] = {"tolerance": draw(st.sampled_from([1e-6, 1e-3, 1e-9, 1e-13]))}
    scene["quantities"] = draw(quantities(shape, app, effects))
    return scene


def gestures(names: Sequence[str], at: st.SearchStrategy[list[float]] = places) -> st.SearchStrategy[list[Table]]:
    """A press or pull, a drag through one to five places, and a release."""
    held = st.sampled_from(["press", "press", "pull"])
    return st.tuples(held, st.sampled_from(list(names)), st.lists(at, min_size=1, max_size=5)).map(
        lambda found: [
            {"do": found[0], "on": found[1]},
            {"do": "drag", "path": found[2]},
            {"do": "release"},
        ]
    )


def single_edits(names: Sequence[str], at: st.SearchStrategy[list[float]] = places) -> st.SearchStrategy[list[Table]]:
    """One event that changes a shape by itself."""
    on, frames = st.sampled_from(list(names)), st.integers(1, 4)
    return st.one_of(
        st.builds(lambda on, by, n: {"do": "rotate", "on": on, "by": by, "frames": n}, on, angles, frames),
        st.builds(lambda on, by, n: {"do": "scale", "on": on, "factor": by, "frames": n}, on, numbers(0.2, 2), frames),
        st.builds(lambda on, by, n: {"do": "arc", "on": on, "bulge": by, "frames": n}, on, numbers(-2, 2), frames),
        st.builds(lambda on, at: {"do": "insert", "on": on, "at": at, "name": "q"}, on, at),
        st.builds(lambda on, n: {"do": "smooth", "on": on, "frames": n}, on, frames),
        st.builds(lambda on: {"do": "delete", "on": on}, on),
        st.builds(
            lambda n, at, r: {"do": "hole", "name": n, "center": at, "radius": r},
            st.sampled_from(["h1", "h2"]),
            at,
            numbers(0.01, 0.3),
        ),
        st.sampled_from([{"do": "undo"}, {"do": "redo"}]),
    ).map(lambda event: [event])


def small_moves(scene: Table) -> st.SearchStrategy[list[Table]]:
    """A drag of a corner or of the hole in steps that a mesh can follow."""
    shape = scene["shape"]
    starts: dict[str, list[float]] = dict(shape["vertices"])
    if "holes" in shape:
        starts["window"] = [-0.1, 0.0]
    step = st.tuples(numbers(-0.05, 0.05), numbers(-0.05, 0.05))

    def events(on: str, by: tuple[float, float], frames: int, idle: int) -> list[Table]:
        x, y = starts[on]
        path = [[round(x + k * by[0], 6), round(y + k * by[1], 6)] for k in range(1, frames + 1)]
        rest = [{"do": "idle", "frames": idle}] if idle else []
        return [{"do": "press", "on": on, "at": [x, y]}, {"do": "drag", "path": path}, *rest, {"do": "release"}]

    return st.builds(events, st.sampled_from(list(starts)), step, st.integers(1, 12), st.integers(0, 2))


def sets(scene: Table) -> st.SearchStrategy[list[Table]]:
    """A new value for a key that may be set during an edit; not always one that suits it."""
    size = scene["mesh"]["size"]
    keys: dict[str, list[Any]] = {
        "material.m.E": [1e6, "3 GPa", 1e-3],
        "material.m.nu": [0.0, 0.3, 0.4999, 0.5],
        "material.m.rho": [0, 1, 1e4],
        "material.m.thickness": [0.02, "5 mm", 0],
        "parameters.k": [0.0, 0.1, -3.0],
        "mesh.size": [1.3 * size, 2 * size, 10.0],
        "mesh.order": [1, 2],
        "mesh.relocation": ["mvc", "laplacian", "harmonic"],
        "solve.tolerance": [1e-2, 1e-10],
        "supports.s0.fix": [["x"], ["x", "y"], {"x": 0.02}],
        "supports.s0.on": ["e2", "outline", "p1"],
        "effects.gravity.g": [[0, -1], [100, 0]],
        "effects.dynamics.steps": [1, 3],
        "effects.dynamics.time_step": [1e-3, 0.1],
        "effects.damping.alpha": [0.0, 1.0],
        "effects.ground.frequency": [1.0, 50.0],
        "effects.modal.modes": [1, 3, 7],
        "effects.modal.model": ["plate", "solid", "plane_stress"],
        "effects.buckling.modes": [1, 2],
        "effects.solid.model": ["plane_strain", "plane_stress"],
        "effects.solid.element": ["displacement", "mean_dilatation", "auto"],
    }
    for name, load in scene.get("loads", {}).items():
        kind = next(key for key in load if key != "on")
        keys[f"loads.{name}.{kind}"] = [0.0, 1e3, "k"] if kind == "pressure" else [[0, 0], [1e3, -1e3], [1e9, 0]]
    pairs = [(key, value) for key, values in keys.items() for value in values]
    return st.sampled_from(pairs).map(lambda pair: [{"do": "set", "key": pair[0], "value": pair[1]}])


rests = st.sampled_from([[{"do": "idle", "frames": 2}], [{"do": "analyse"}]])


def scripts(scene: Table) -> st.SearchStrategy[list[Table]]:
    """Events of at most some 60 frames for a scene, with the header first."""
    if scene["app"] == FURNITURE:
        names = [*scene["planks"], EXTRA]
        part = st.one_of(plank_gestures(names), plank_edits(names), choices(), plank_sets(scene), rests)
    else:
        names = [*entities(scene["shape"]), *scene.get("bodies", {}), "q", "h1", "outline", "all"]
        values = cloth_sets(scene) if scene["app"] == CLOTH else sets(scene)
        part = st.one_of(small_moves(scene), gestures(names), single_edits(names), values, rests)
    heads = [{}, {}, {}] + [{"analysis": "on demand"}] * (scene["app"] != "vibration")
    return st.builds(timed, st.sampled_from(heads), st.lists(part, min_size=1, max_size=8))


def timed(head: Table, parts: list[list[Table]]) -> list[Table]:
    """The lines of a script whose events are a tenth of a second apart."""
    events = [event for part in parts for event in part]
    first = {"format": "restshape-edits", "version": 1, "units": "m", **head}
    return [first, *({"t": round(0.1 * k, 6), **event} for k, event in enumerate(events))]


splices = st.tuples(st.floats(0, 1), st.integers(0, 12), st.text(alphabet="{}[]\"=.,:-\n abxt019eN#'\\\0", max_size=6))
values = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**30), 10**30) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)
plain_values = values.filter(lambda value: "null" not in json.dumps(value))
"""Those that TOML can hold."""


def spliced(text: str, changes: list[tuple[float, int, str]]) -> str:
    """The text with pieces cut out and others put in."""
    for place, length, piece in changes:
        at = int(place * len(text))
        text = text[:at] + piece + text[at + length :]
    return text


def keys_of(table: Table, before: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Every key of nested tables."""
    inner = [k for key, value in table.items() if isinstance(value, dict) for k in keys_of(value, (*before, key))]
    return [(*before, key) for key in table] + inner


def replaced(table: Table, key: tuple[str, ...], value: Any) -> Table:
    """A copy of the tables with another value at one key."""
    inner = value if len(key) == 1 else replaced(table[key[0]], key[1:], value)
    return {**table, key[0]: inner}


def without(table: Table, key: tuple[str, ...]) -> Table:
    """A copy of the tables without one key."""
    if len(key) == 1:
        return {name: value for name, value in table.items() if name != key[0]}
    return {**table, key[0]: without(table[key[0]], key[1:])}


@st.composite
def examples(draw: st.DrawFn, apps: Sequence[str], damaged: bool) -> Example:
    """A scene of one of the applications with its edits; or the same after some damage."""
    app = draw(st.sampled_from(list(apps)))
    scene = draw(scenes(app))
    lines = draw(scripts(scene))
    harm = draw(st.sampled_from(["a value", "a key", "an event", "scene", "edits"])) if damaged else ""
    if harm == "a value":
        scene = replaced(scene, draw(st.sampled_from(keys_of(scene))), draw(plain_values))
    elif harm == "a key":
        scene = without(scene, draw(st.sampled_from(keys_of(scene))))
    elif harm == "an event":
        line = draw(st.integers(0, len(lines) - 1))
        lines = [*lines]
        lines[line] = {**lines[line], draw(st.sampled_from(list(lines[line]))): draw(values)}
    text, edits = toml(scene), "".join(json.dumps(line) + "\n" for line in lines)
    if harm == "scene":
        text = spliced(text, draw(st.lists(splices, min_size=1, max_size=3)))
    elif harm == "edits":
        edits = spliced(edits, draw(st.lists(splices, min_size=1, max_size=3)))
    policy = draw(st.sampled_from(list(POLICIES)[::-1]))
    # What cannot be predicted is asked for at times, for it is refused.
    can = app not in ("vibration", CLOTH, FURNITURE) and policy != "rebuild" and "analysis" not in lines[0]
    predict = draw(st.sampled_from(["none", "linear"])) if can or draw(st.integers(0, 19)) == 19 else "none"
    written = draw(st.integers(1, WRITTEN_SHARE)) == WRITTEN_SHARE
    return Example(app, text, edits, policy, predict, harm, written)
