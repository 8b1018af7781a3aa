"""Hypothesis strategies of scenes of furniture and of edits of planks, of which most make sense."""

from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.random_scenes import Parts, RandomScenes, never
from restshape_studies.stability.shape_strategies import Table, numbers

FASTENERS = ["nail-thesis", "nail-experiment", "screw", "nail", "dowel"]
WOODS = ["mdf", "pine", "oak"]
PARAMETERS = [f"{kind} {axis}" for kind in ("move", "turn") for axis in "xyz"] + ["length x", "length y"]
EXTRA, BOX = "q", "vase"
"""Names of a plank and of a weight that only edits give."""


def _points(least: float, most: float) -> st.SearchStrategy[list[float]]:
    return st.tuples(*[numbers(least, most)] * 3).map(list)


@st.composite
def benches(draw: st.DrawFn) -> Table:
    """Planks of a board on two to four legs, some slanted or short, with a stretcher or an arm at times."""
    t, high, wide = draw(st.sampled_from([0.012, 0.012, 0.02, 0.03])), draw(numbers(0.2, 0.8)), draw(numbers(0.1, 0.5))
    top = round(high + t / 2, 4)
    planks: Table = {"top": {"from": [-0.5, 0, top], "to": [0.5, 0, top], "width": [0, wide, 0]}}
    four = draw(st.integers(0, 2)) == 0
    places = [(x, y) for x in (-0.4, 0.4) for y in ((-0.3 * wide, 0.3 * wide) if four else (0.0,))]
    for k, (x, y) in enumerate(places, 1):
        lean = draw(st.sampled_from([0.0, 0.0, 0.0, "k", 0.1, 0.35]))
        low = draw(st.sampled_from([0.0] * 12 + [0.005, 0.1]))
        across = round(0.3 * wide, 4) if four else draw(st.sampled_from([wide, wide, 0.05]))
        foot = f"{x} + {lean}" if isinstance(lean, str) else x + lean
        planks[f"leg-{k}"] = {"from": [foot, y, low], "to": [x, y, high], "width": [0, across, 0]}
    if draw(st.integers(0, 3)) == 0 and not four:
        z = round(high * draw(numbers(0.2, 0.8)), 4)
        planks["rail"] = {"from": [round(-0.4 + t / 2, 4), 0, z], "to": [round(0.4 - t / 2, 4), 0, z]}
        planks["rail"]["width"] = [0, draw(st.sampled_from([0.05, 0.3])), 0]
    if draw(st.integers(0, 3)) == 0 and not four:
        z, far = round(high * draw(numbers(0.3, 0.9)), 4), draw(numbers(0.1, 0.5))
        planks["arm"] = {"from": [round(0.4 + t / 2, 4), 0, z], "to": [0.4 + far, 0, z], "width": [0, 0.06, 0]}
    return {"thickness": t, "planks": planks}


@st.composite
def heaps(draw: st.DrawFn) -> Table:
    """Planks anywhere, of which few meet: drawn by two lines, or by their middle."""
    planks: Table = {}
    for k in range(draw(st.integers(1, 4))):
        if draw(st.booleans()):
            plank = {
                "from": draw(_points(-0.5, 0.5)),
                "to": draw(_points(-0.5, 0.5)),
                "width": draw(_points(-0.3, 0.3)),
            }
        else:
            turn = draw(st.sampled_from([[0, 0, 0], [0, "90 deg", 0], ["k", 0, 1], [3, -2, 1]]))
            middle = draw(st.sampled_from([[0, 0, 0.006], [0, 0, 0.1], [0.1, 0, 0.2], [0, 0, 0.1]]))
            plank = {"center": middle, "size": [draw(numbers(0.01, 1)), 0.2], "turn": turn}
        planks[f"p{k}"] = plank
    return {"thickness": 0.012, "planks": planks}


@st.composite
def loads(draw: st.DrawFn, names: list[str]) -> Table:
    """The [weights] and [pushes] of a piece; at times none."""
    place = st.sampled_from([[0, 0, 0.5], [0, 0, -0.5], [0.4, 0, 0.5], [0.5, 0.5, 0.5], [0, 0, 0]] * 3 + [[2, 0, 0.5]])
    found: Table = {}
    for k in range(draw(st.sampled_from([0, 1, 1, 2]))):
        mass = draw(st.sampled_from([0.5, 20, "60 kg", "1 + k", 500]))
        found.setdefault("weights", {})[f"w{k}"] = {"on": draw(st.sampled_from(names)), "mass": mass, "at": draw(place)}
    for k in range(draw(st.sampled_from([0, 0, 1, 2]))):
        force = draw(st.sampled_from([[50, 0, 0], [0, "20 N", 0], [0, 0, 1e4], [0, 0, 0], ["100*k", 1, 0]]))
        found.setdefault("pushes", {})[f"push{k}"] = {"on": draw(st.sampled_from(names)), "force": force}
    return found


@st.composite
def effects(draw: st.DrawFn, pushed: bool) -> Table:
    """The [effects] of furniture."""
    found: Table = {}
    if draw(st.integers(0, 19)):
        found["gravity"] = draw(st.sampled_from([{}, {}, {}, {"g": [0, 0, -10]}, {"g": [1, 0, -9]}, {"g": [0, 0, 9]}]))
    if (pushed and draw(st.integers(0, 3))) or draw(st.integers(0, 29)) == 29:
        found["push"] = {}
    if draw(st.integers(0, 3)) == 0:
        found["bending"] = {}
    if draw(st.integers(0, 2)) == 0:
        keys = [{"suggestions": 0}, {"freedoms": 1}, {"freedoms": 2, "suggestions": 3}, {"ranges": False}]
        found["guidance"] = draw(st.sampled_from(keys))
    return found


@st.composite
def plank_scenes(draw: st.DrawFn) -> Table:
    """The tables of a scene of furniture."""
    piece = draw(heaps() if draw(st.integers(0, 5)) == 5 else benches())
    planks, names = piece["planks"], list(piece["planks"])
    scene: Table = {"format": "restshape-scene", "version": 1, "app": "furniture"}
    scene["parameters"] = {"k": draw(numbers(-0.1, 0.2))}
    thickness = draw(st.sampled_from([piece["thickness"]] * 8 + ["8 mm", 0.05]))
    scene["wood"] = {"name": draw(st.sampled_from(WOODS)), "thickness": thickness}
    # Handbooks do not know the strength of all fasteners in boards of fibres.
    kinds = FASTENERS if scene["wood"]["name"] != "mdf" or draw(st.integers(0, 4)) == 0 else FASTENERS[:2]
    scene["fastener"] = {"name": draw(st.sampled_from(kinds)), "spacing": draw(st.sampled_from([0.02, 0.005, 0.5]))}
    if draw(st.integers(0, 3)) == 0:
        planks[draw(st.sampled_from(names))]["wood"] = draw(st.sampled_from(WOODS))
    scene["planks"] = planks
    if draw(st.integers(0, 9)) == 0:
        scene["joints"] = draw(st.sampled_from([{"near": False}, {"reach": 0.05}, {"reach": 1e-4}]))
    elif draw(st.integers(0, 5)) == 0:
        ends = {"plank": draw(st.sampled_from(names)), "end": draw(st.sampled_from(["+x", "-x", "+y"]))}
        face = {"to": draw(st.sampled_from(names)), "face": draw(st.sampled_from(["-z", "+z"]))}
        scene["joints"] = {"j1": {**ends, **face, "fastener": draw(st.sampled_from(FASTENERS))}}
    scene["floor"] = {"friction": draw(st.sampled_from([0.5, 0.5, 0.0, 0.1, 3])), "height": 0}
    scene |= draw(loads(names))
    scene["effects"] = draw(effects("pushes" in scene))
    return scene


def plank_gestures(names: list[str]) -> st.SearchStrategy[list[Table]]:
    """A press of a plank or a parameter of it, a drag there or by so much, and a release, forgotten at times."""
    on, frames = st.sampled_from(names), st.integers(1, 6)
    mended = [{"do": "release"}, {"do": "choose", "number": 1}, {"do": "slide", "to": 0.5, "frames": 2}]
    ends = st.sampled_from([mended[:1]] * 5 + [mended] * 4 + [[]])
    size = st.sampled_from([0.02, -0.05, 0.2, -0.3, 0.7, 3.0])
    constrained = st.builds(
        lambda on, parameter, by, n, end: [
            {"do": "press", "on": on, "parameter": parameter},
            {"do": "drag", "by": by, "frames": n},
            *end,
        ],
        on,
        st.sampled_from(PARAMETERS),
        size,
        frames,
        ends,
    )
    led = st.builds(
        lambda on, path, n, end: [{"do": "press", "on": on}, {"do": "drag", "path": path, "frames": n}, *end],
        on,
        st.lists(_points(-0.8, 0.8), min_size=1, max_size=3),
        frames,
        ends,
    )
    return constrained | constrained | led


def plank_edits(names: list[str]) -> st.SearchStrategy[list[Table]]:
    """One event that changes a piece by itself."""
    on, frames = st.sampled_from(names), st.integers(1, 3)
    return st.one_of(
        st.builds(
            lambda on, by, axis, n: {"do": "rotate", "on": on, "by": by, "about": axis, "frames": n},
            on,
            st.sampled_from([0.1, -0.3, "20 deg", 1.57, 4]),
            st.sampled_from("xyz"),
            frames,
        ),
        st.builds(
            lambda on, factor, axis, n: {"do": "scale", "on": on, "factor": factor, "along": axis, "frames": n},
            on,
            st.sampled_from([0.5, 0.9, 1.2, 3, 0.01]),
            st.sampled_from("xy"),
            frames,
        ),
        st.builds(
            lambda start, to, width: {"do": "plank", "name": EXTRA, "from": start, "to": to, "width": width},
            st.sampled_from([[-0.394, 0, 0.1], [0, 0, 0], [-0.3, 0, 0]]) | _points(-0.5, 0.5),
            st.sampled_from([[0.394, 0, 0.1], [0, 0, 0.5], [0.3, 0, 0.3]]) | _points(-0.5, 0.5),
            st.sampled_from([[0, 0.1, 0], [0, 0.1, 0], [0.1, 0, 0], [0, 0, 0]]),
        ),
        st.builds(lambda on: {"do": "connect", "on": on}, on),
        st.builds(
            lambda name, on, mass, at: {"do": "weight", "name": name, "on": on, "mass": mass, "at": at},
            st.sampled_from([BOX, BOX, "w0", "top"]),
            on,
            st.sampled_from([1, 30, "200 kg"]),
            st.sampled_from([[0, 0, 0.5], [0.5, 0, 0.5]]),
        ),
        st.builds(lambda on: {"do": "delete", "on": on}, st.sampled_from([*names, BOX, "w0"])),
        st.sampled_from([{"do": "undo"}, {"do": "redo"}]),
    ).map(lambda event: [event])


def choices() -> st.SearchStrategy[list[Table]]:
    """A suggestion taken, and followed at times."""
    direction_views = st.sampled_from([[], [{"do": "slide", "to": 0.3, "frames": 3}], [{"do": "slide", "to": 1}]])
    return st.builds(lambda n, more: [{"do": "choose", "number": n}, *more], st.integers(1, 4), direction_views)


def plank_sets(scene: Table) -> st.SearchStrategy[list[Table]]:
    """A new value for a key of furniture that may be set during an edit; not always one that suits it."""
    first = next(iter(scene["planks"]))
    keys: dict[str, list[Any]] = {
        "wood.thickness": [0.015, "25 mm", 0, 0.3],
        "wood.name": ["oak", "pine", "steel"],
        "fastener.name": FASTENERS,
        "fastener.spacing": [0.01, 0.1, 0],
        "floor.friction": [0, 0.2, 1],
        "floor.height": [0.01, -0.1],
        "parameters.k": [0.0, 0.1, -3.0],
        "effects.gravity.g": [[0, 0, -1.6], [0, 0, 0], [0, 3, -9]],
        "effects.guidance.suggestions": [0, 2],
        "effects.guidance.freedoms": [1, 2],
        "weights.w0.mass": [1, "90 kg", 0],
        "weights.w0.at": [[0.3, 0, 0.5]],
        "pushes.push0.force": [[0, 0, 0], [300, 0, 0]],
        "joints.near": [False],
        f"planks.{first}.thickness": [0.03],
        f"planks.{first}.width": [[0, 0.2, 0], [0, 0, 0]],
    }
    pairs = [(key, value) for key, values in keys.items() for value in values]
    frames = st.sampled_from([{}, {}, {"frames": 3}])
    return st.tuples(st.sampled_from(pairs), frames).map(
        lambda drawn: [{"do": "set", "key": drawn[0][0], "value": drawn[0][1], **drawn[1]}]
    )


def edits(scene: Table) -> Parts:
    """Edits of planks."""
    names = [*scene["planks"], EXTRA]
    return plank_gestures(names), plank_edits(names), choices(), plank_sets(scene)


SCENES = RandomScenes(plank_scenes(), edits=edits, predictable=never, outlined=False)
