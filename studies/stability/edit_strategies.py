"""Hypothesis strategies of edits of outlines and of values."""

from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.shape_strategies import Table, angles, numbers, places


def gestures(names: Sequence[str], at: st.SearchStrategy[list[float]] = places) -> st.SearchStrategy[list[Table]]:
    """A press or pull, a drag through one to five places, and a release."""
    along: Table = {"do": "press", "along": [1, 2]}
    maps = [along, {**along, "as": [-1, 1]}, {"do": "press", "mirror": [[0.5, 0], [0.5, 1]]}]
    grabs = st.sampled_from([*[{"do": "press"}] * 3, *maps, *[{"do": "pull"}] * 3])
    return st.tuples(grabs, st.sampled_from(list(names)), st.lists(at, min_size=1, max_size=5)).map(
        lambda found: [
            {**found[0], "on": found[1]},
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
        "mesh.relocation": ["mvc", "pmvc", "laplacian", "harmonic"],
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
