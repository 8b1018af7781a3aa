"""Hypothesis strategies of scenes of cloth: fabrics, bodies, supports and starts, of which most make sense."""

from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.random_scenes import RandomScenes, edits_with, never
from restshape_studies.stability.shape_strategies import Table, angles, entities, mesh_size, numbers, shapes

BENDING = [None, None, 5e-6, "1e-4 N m", 1e-12, 0]
WOVEN = {"E": [4e6, 1e6, 1e6], "nu": [0.4, 0.3, 0.3], "G": [5e5, 1e6, 1e6]}
PINNED = ["x", "y", "z"]


@st.composite
def fabrics(draw: st.DrawFn) -> Table:
    """A material of cloth."""
    found: Table = {"rho": draw(st.sampled_from([500.0, 100.0, 3000.0] * 8 + [0.0]))}
    found["thickness"] = draw(st.sampled_from([3e-4, 1e-3, "50 um", 0.02]))
    if draw(st.integers(0, 4)) == 0:
        found |= {"orthotropic": WOVEN, "grain": draw(angles)}
    else:
        found |= {"E": draw(st.sampled_from([1e6, 1e4, 1e8])), "nu": draw(st.sampled_from([0.3, 0.0, 0.49, -0.5]))}
    bending = draw(st.sampled_from(BENDING))
    return found if bending is None else found | {"bending": bending}


def _scaled(least: float, most: float) -> st.SearchStrategy[list[float]]:
    return st.tuples(*[numbers(least, most)] * 3).map(list)


@st.composite
def bodies(draw: st.DrawFn) -> Table:
    """A body somewhere below the cloth, or in it."""
    middle = [draw(numbers(-0.6, 0.6)), draw(numbers(-0.6, 0.6)), draw(numbers(-0.9, 0.1))]
    kind = draw(st.sampled_from(["sphere", "plane", "box", "capsule", "cylinder"]))
    size, rounding = draw(numbers(0.02, 0.5)), st.sampled_from([0.0, 0.01, 0.02])
    form: Table = {
        "sphere": {"center": middle, "radius": size},
        "plane": {"point": middle, "normal": [draw(numbers(-0.5, 0.5)), "k", draw(st.sampled_from([1, 1, 1, -1, 0]))]},
        "box": {"center": middle, "half": draw(_scaled(0.02, 0.5)), "radius": draw(rounding)},
        "capsule": {"start": middle, "end": draw(_scaled(-0.8, 0.2)), "radius": size},
        "cylinder": {"start": middle, "end": draw(_scaled(-0.8, 0.2)), "radius": size, "rounded": draw(rounding)},
    }[kind]
    if kind == "box" and draw(st.booleans()):
        form["rotate"] = [draw(angles), "k", draw(angles)]
    return {kind: form, "friction": draw(st.sampled_from([0.3, 0.0, 2.0, "0.1 + k"]))}


@st.composite
def supports(draw: st.DrawFn, shape: Table, some: bool) -> Table:
    """The [supports] of cloth: pins, clamps, planes of symmetry; with `some` at least one that holds a place."""
    found: Table = {}
    for number in range(draw(st.sampled_from([1, 1, 2, 3] if some else [0, 0, 1, 2]))):
        on = draw(st.sampled_from([*shape["vertices"], *shape["edges"], "outline"]))
        moved = {"x": draw(numbers(-0.1, 0.1)), "z": draw(st.sampled_from(["0.1*x", "k", 0.2]))}
        sloped = [*PINNED, "slope"] if on in shape["edges"] or draw(st.integers(0, 9)) == 0 else PINNED
        fix = draw(st.sampled_from([PINNED, PINNED, sloped, ["z"], moved]))
        if number == 0 and some:
            fix = PINNED
        mirror = draw(st.integers(0, 19)) == 19
        found[f"s{number}"] = {"on": on, "symmetry": draw(st.sampled_from("xy"))} if mirror else {"on": on, "fix": fix}
    return found


@st.composite
def effects(draw: st.DrawFn, touched: bool) -> Table:
    """The [effects] of cloth in equilibrium, of few steps."""
    bending = ["morley", "hinge", "nonlinear", "none"]
    found: Table = {"cloth": {"bending": draw(st.sampled_from(bending))}}
    if draw(st.integers(0, 2)) == 0:
        found["cloth"] |= {"membrane": "corotated"} if draw(st.booleans()) else {"hinges": "strip"}
    g = draw(st.sampled_from([None, None, None, [0, 0, 9.81], [1, -2, -3], [0, 0, 0], [0, 0, -1e4]]))
    if draw(st.integers(0, 7)):
        found["gravity"] = {} if g is None else {"g": g}
    if touched and draw(st.integers(0, 9)):
        keys = [{}, {}, {"thickness": 0.02}, {"stiffness": 1e5}, {"slip": 1e-3}, {"thickness": 1e-4, "stiffness": 10.0}]
        found["contact"] = draw(st.sampled_from(keys))
        # Without a weight it takes a stiffness, of which some scenes do not know.
        if "gravity" not in found and draw(st.integers(0, 4)):
            found["contact"] = {"stiffness": 1e5}
    ways = ["auto"] * 6 + ["kinetic", "rayleigh", "newton", "stabilised", "cg"]
    found["drape"] = {"steps": draw(st.sampled_from([60, 200, 3])), "way": draw(st.sampled_from(ways))}
    if draw(st.integers(0, 3)) == 0:
        found["drape"]["rest"] = draw(st.sampled_from([1e-2, 1e-6, 1e-12]))
    return found


@st.composite
def starts(draw: st.DrawFn) -> Table:
    """Where cloth lies at first."""
    found: Table = {"move": [0.0, "k", draw(numbers(0, 0.5))]}
    if draw(st.booleans()):
        found |= {"turn": [draw(angles), 0.0, "k"], "about": [0.1, 0.0, 0.0]}
    if draw(st.booleans()):
        found |= {"scatter": draw(st.sampled_from([1e-3, 0.1, 2.0])), "seed": draw(st.integers(0, 3))}
    return found


@st.composite
def quantities(draw: st.DrawFn, shape: Table) -> Table:
    """The [quantities] of cloth; at times one that it does not have."""
    at = st.sampled_from(entities(shape))
    found: Table = {"area": {"area": True}}
    found["far"] = {"displacement": draw(st.sampled_from(["x", "y", "z", "magnitude"])), "at": draw(at), "take": "max"}
    found["place"] = {"position": draw(st.sampled_from("xyz")), "at": draw(at), "reduce": "min"}
    found["energy"] = {"energy": draw(st.sampled_from(["strain", "membrane", "bending", "potential"]))}
    if draw(st.integers(0, 2)) == 0:
        found["place"] = {"position": draw(st.sampled_from("xyz")), "at": draw(at), "take": "min"}
    if draw(st.integers(0, 2)) == 0:
        found["force"] = {"reaction": draw(st.sampled_from("xyz")), "at": draw(at)}
    if draw(st.integers(0, 19)) == 19:
        found["stress"] = {"stress": "von_mises"}
    return found


@st.composite
def meshes(draw: st.DrawFn, area: float) -> Table:
    """The [mesh] of about 3 to 60 triangles, nested at times."""
    mesh: Table = {"size": mesh_size(area, draw(st.integers(3, 60)))}
    if draw(st.integers(0, 3)) == 0:
        mesh["levels"] = draw(st.sampled_from([2, 2, 3]))
    if draw(st.integers(0, 2)) == 0:
        mesh["relocation"] = draw(st.sampled_from(["harmonic", "pmvc", "mvc", "laplacian"]))
    if draw(st.integers(0, 9)) == 0:
        mesh["order"] = draw(st.sampled_from([1, 1, 2]))
    return mesh


@st.composite
def cloth_scenes(draw: st.DrawFn) -> Table:
    """The tables of a scene of cloth."""
    shape, area = draw(shapes())
    scene: Table = {
        "format": "restshape-scene",
        "version": 1,
        "app": "couture",
        "parameters": {"k": draw(numbers(-0.1, 0.2))},
    }
    scene |= {"shape": shape, "material": {"m": draw(fabrics())}}
    if "regions" in shape and draw(st.booleans()):
        scene["material"]["inner"] = {**draw(fabrics()), "region": ["patch"]}
    there = {f"body{number}": draw(bodies()) for number in range(draw(st.sampled_from([0, 1, 1, 2])))}
    if there:
        scene["bodies"] = there
    scene["effects"] = draw(effects(bool(there)))
    scene["supports"] = draw(supports(shape, not there or draw(st.booleans())))
    if draw(st.integers(0, 2)) == 0:
        scene["start"] = draw(starts())
    scene["mesh"] = draw(meshes(area))
    scene["quantities"] = draw(quantities(shape))
    return scene


def cloth_sets(scene: Table) -> st.SearchStrategy[list[Table]]:
    """A new value for a key of cloth that may be set during an edit; not always one that suits it."""
    size = scene["mesh"]["size"]
    keys: dict[str, list[Any]] = {
        "material.m.E": [1e6, "3 MPa", 1e-3],
        "material.m.bending": [1e-3, 0, "1e-6 N m"],
        "material.m.rho": [0, 1, 1e4],
        "material.m.thickness": ["1 mm", 0],
        "parameters.k": [0.0, 0.1, -3.0],
        "mesh.size": [1.3 * size, 2 * size, 10.0],
        "mesh.levels": [1, 2],
        "supports.s0.fix": [["x"], PINNED, {"z": 0.02}, [*PINNED, "slope"]],
        "supports.s0.on": ["e2", "outline", "p1"],
        "effects.cloth.bending": ["morley", "hinge", "none"],
        "effects.cloth.membrane": ["corotated", "stvk"],
        "effects.gravity.g": [[0, 0, -1], [0, 0, 100], [0, 0, 0]],
        "effects.contact.thickness": ["1 mm", 0.05],
        "effects.contact.stiffness": [1e4, 1e8],
        "effects.drape.strategy": ["auto", "kinetic"],
        "effects.drape.steps": [10, 100],
        "start.scatter": [0.1, 0],
    }
    for name, body in scene.get("bodies", {}).items():
        kind = next(iter(body))
        sizes = {
            "plane": ("point", [[0, 0, -0.1], [0, 0, 0.1]]),
            "box": ("half", [[0.1, 0.2, 0.3], [0.01, 0.01, 0.01]]),
        }
        key, values = sizes.get(kind, ("radius", [0.3, "1 mm", 0]))
        keys |= {f"bodies.{name}.{kind}.{key}": values, f"bodies.{name}.friction": [0, 0.5, -1]}
    pairs = [(key, value) for key, values in keys.items() for value in values]
    return st.tuples(st.sampled_from(pairs), st.sampled_from([None, None, 3])).map(_event)


@st.composite
def space_drags(draw: st.DrawFn, scene: Table) -> list[Table]:
    """A body or a pin that a hand takes through space; not always one that is there, or that may go there."""
    names = [*(f"supports.{name}" for name in scene.get("supports", {})), *scene.get("bodies", {}), "supports.s9"]
    on, path = draw(st.sampled_from(names)), draw(st.lists(_scaled(-0.5, 0.5), min_size=1, max_size=2))
    press: Table = {"do": "press", "on": on}
    if draw(st.booleans()):
        press["at"] = draw(_scaled(-0.5, 0.5))
    drag: Table = {"do": "drag", "path": path}
    if draw(st.booleans()):
        drag["frames"] = draw(st.integers(1, 3))
    return [press, drag, {"do": "release"}]


def cloth_edits(scene: Table) -> st.SearchStrategy[list[Table]]:
    """New values for keys, and what goes through space."""
    return st.one_of(cloth_sets(scene), space_drags(scene))


def _event(drawn: tuple[tuple[str, Any], int | None]) -> list[Table]:
    (key, value), frames = drawn
    return [{"do": "set", "key": key, "value": value} | ({"frames": frames} if frames else {})]


SCENES = RandomScenes(cloth_scenes(), edits=lambda scene: edits_with(scene, cloth_edits(scene)), predictable=never)
