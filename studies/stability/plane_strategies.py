"""Hypothesis strategies of scenes of bodies in the plane, which several applications share."""

from collections.abc import Callable, Sequence
from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.shape_strategies import Table, angles, entities, mesh_size, numbers, shapes, sides


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
def solid_effects(draw: st.DrawFn, always_large: bool = False) -> Table:
    """The [effects] of solids: elasticity, large deformation, weight."""
    large = always_large or draw(st.booleans())
    found: Table = {"solid": {"model": draw(st.sampled_from(["plane_stress", "plane_strain"]))}}
    if draw(st.integers(0, 5)) == 5:
        found["solid"]["element"] = draw(st.sampled_from(["displacement", "mean_dilatation"]))
    if large:
        found["large_deformation"] = draw(st.sampled_from([{}, {"load_steps": 5}]))
    if draw(st.booleans()):
        found["gravity"] = draw(gravity)
    return found


@st.composite
def quantities(draw: st.DrawFn, shape: Table, energies: Sequence[str] = ("strain",)) -> Table:
    """The [quantities] of solids.

    Args:
        energies: kinds of energy that there are.
    """
    at = st.sampled_from(entities(shape))
    found: Table = {"area": {"area": True}}
    found["far"] = {"displacement": draw(st.sampled_from(["x", "y", "magnitude"])), "at": draw(at)}
    if draw(st.booleans()):
        found["far"]["take"] = draw(st.sampled_from(["max", "min", "absmax", "mean"]))
    if draw(st.booleans()):
        found["place"] = {"position": draw(st.sampled_from("xy")), "at": draw(at)}
    if draw(st.integers(0, 2)) == 0:
        found["place"] = {"position": draw(st.sampled_from([*"xy" * 10, "z"])), "at": draw(at)}
    if draw(st.booleans()):
        kind = draw(st.sampled_from(["von_mises", "xy", "max_principal"]))
        found["stress"] = {"stress": kind, "take": draw(st.sampled_from(["max", "mean"]))}
    if draw(st.booleans()):
        found["energy"] = {"energy": draw(st.sampled_from(energies))}
    if draw(st.integers(0, 2)) == 0:
        found["wall"] = {"reaction": "x", "at": "e1"}
    return found


@st.composite
def meshes(draw: st.DrawFn, area: float, effects: Table) -> Table:
    """The [mesh] of about 3 to 60 elements over an area [m^2]."""
    model = effects.get("modal", {}).get("model", "")
    most = 20 if model == "solid" else 60
    size = mesh_size(area, draw(st.integers(3, most)))
    mesh: Table = {"size": size}
    if draw(st.booleans()) and model != "plate":
        mesh["order"] = draw(st.sampled_from([1, 2]))
    if model == "solid":
        mesh["layers"] = draw(st.integers(1, 2))
    if draw(st.integers(0, 2)) == 0:
        mesh["relocation"] = draw(st.sampled_from(["harmonic", "pmvc", "mvc", "laplacian"]))
    if draw(st.integers(0, 3)) == 0:
        mesh["mesher"] = draw(st.sampled_from(["cgal", "gmsh"]))
    if draw(st.integers(0, 3)) == 0:
        mesh |= {"criterion": "author"} if draw(st.booleans()) else {"min_quality": draw(numbers(0.01, 0.6))}
    if draw(st.integers(0, 4)) == 0:
        mesh["near"] = {"p1": round(size * draw(numbers(0.3, 2)), 3)}
    return mesh


def head(app: str, k: float) -> Table:
    """The first tables of a scene: its application and a parameter."""
    return {"format": "restshape-scene", "version": 1, "app": app, "parameters": {"k": k}}


tolerances = st.sampled_from([1e-6, 1e-3, 1e-9, 1e-13])


@st.composite
def solid_scenes(
    draw: st.DrawFn,
    app: str,
    effects: st.SearchStrategy[Table],
    energies: Sequence[str] = ("strain",),
    own: Callable[[Table], Table] = lambda effects: {},
    more: st.SearchStrategy[Table] | None = None,
) -> Table:
    """The tables of a scene of solids in the plane.

    Args:
        app: its application.
        effects: its [effects].
        energies: kinds of energy that there are.
        own: quantities that this application alone has, for the effects.
        more: further tables.
    """
    shape, area = draw(shapes())
    drawn = draw(effects)
    bodies = draw(materials(shape, False))
    scene = head(app, draw(numbers(-0.2, 0.2))) | {"shape": shape, "material": bodies, "effects": drawn}
    scene["supports"] = draw(supports(shape, False, False))
    body = bodies["m"]
    scene["loads"] = draw(loads(shape, body["E"], body["thickness"]))
    if more is not None:
        scene |= draw(more)
    if "gravity" in drawn and not body["rho"] and draw(st.integers(0, 9)):
        del drawn["gravity"]
    scene["mesh"] = draw(meshes(area, drawn))
    scene["solve"] = {"tolerance": draw(tolerances)}
    scene["quantities"] = draw(quantities(shape, energies)) | own(drawn)
    return scene
