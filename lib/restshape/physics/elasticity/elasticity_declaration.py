"""What scenes of elastic solids may say."""

from dataclasses import replace
from typing import Literal

from restshape.physics.elasticity.elasticity_derived_effects import GRAIN, LARGE, SOLID
from restshape.physics.elasticity.elasticity_material_keys import (
    ELASTIC_MATERIALS,
    ElasticMaterial,
    VibratingMaterial,
)
from restshape.physics.elasticity.elasticity_scene_checks import check_motion, check_static_solids, check_vibrations
from restshape.physics.elasticity.elasticity_solver_plan import solid_plan, vibration_plan
from restshape.physics.elasticity.goal import Goal, goal_words
from restshape.physics.elasticity.modal_effect import IN_PLANE_MODES, MODAL, modal_columns
from restshape.physics.elasticity.motion_effects import IN_MOTION, motion_columns
from restshape.physics.elasticity.named_tones import COMPARED_TONES
from restshape.physics.elasticity.solid_effects import STATIC, buckling_columns
from restshape.scene.derived_effects import REGIONS
from restshape.scene.load_kind import AREAS, CURVES, ENTITIES, POINTS, LoadKind
from restshape.scene.model import Scene
from restshape.scene.physics import Invariant, Physics, PictureField, Section
from restshape.scene.quantity import QuantityKind
from restshape.scene.values import Ordinal, value_of

LOADS = {
    "force": LoadKind(
        tuple[value_of("force"), value_of("force")],
        (*CURVES, *POINTS),
        "a force [N], on an edge a total that is spread evenly",
    ),
    "traction": LoadKind(tuple[value_of("pressure"), value_of("pressure")], CURVES, "a dead traction [Pa]"),
    "pressure": LoadKind(value_of("pressure"), CURVES, "a pressure [Pa] along the inward normal"),
    "body": LoadKind(tuple[value_of("body force"), value_of("body force")], AREAS, "a body force [N/m^3]"),
}

TONE = "restshape.physics.elasticity.tones:tone"

QUANTITIES = {
    "displacement": QuantityKind(
        Literal["x", "y", "magnitude"], "length", "mean", summary="a component of the displacement"
    ),
    "position": QuantityKind(
        Literal["x", "y"],
        "length",
        "mean",
        reductions=("mean", "max", "min"),
        summary="a coordinate after deformation: rest position and displacement",
    ),
    "reaction": QuantityKind(
        Literal["x", "y"], "force", "sum", summary="a component of the force of supports", on=tuple(ENTITIES)
    ),
    "stress": QuantityKind(
        Literal["von_mises", "xx", "yy", "xy", "max_principal", "min_principal"],
        "pressure",
        "max",
        summary="a stress, recovered at nodes",
    ),
    "energy": QuantityKind(
        Literal["strain", "kinetic", "total", "edit", "remesh"],
        "moment",
        "sum",
        summary='"kinetic" is relative to the ground, "total" both, "edit" the work of all edits so far, "remesh" what '
        "carrying the motion to new meshes has added so far; all but the first are for what moves",
    ),
    "distance": QuantityKind(
        str,
        "length",
        "mean",
        reductions=("mean", "max"),
        summary='the distance between a goal and the deformed edges, counted from both: "mean" is half the mean along '
        "the edges of their distance from the goal plus half the mean along the goal of its distance from them",
    ),
    "frequency": QuantityKind(Ordinal, "frequency", "sum", True, "2: the second lowest frequency", beside=TONE),
    # Before `mode`, which may stand beside it.
    **COMPARED_TONES,
    "mode": QuantityKind(
        Ordinal,
        "frequency",
        "sum",
        True,
        "2: the frequency of the mode that was the second one at the start, wherever it has gone since",
        beside=TONE,
    ),
    "load_factor": QuantityKind(
        Ordinal,
        "number",
        "sum",
        True,
        "1: the lowest multiple of all loads at which the body buckles; infinite where there is none",
    ),
}

GOALS = {
    "goal": Section(
        Goal,
        "curves that the deformed shape is measured against",
        named=True,
        words=goal_words,
        curve="restshape.physics.elasticity.target_curves:goal_curve",
    )
}


def follower_loads(scene: Scene, on: frozenset[str]) -> dict[str, list[str]]:
    """Where each pressure acts that follows the boundary: the pattern of the tangent depends on it."""
    loads = scene.loads.items() if LARGE in on else ()
    return {name: list(load.on) for name, load in loads if load.pressure is not None}


_AXES = {"xx": "along x", "yy": "along y", "xy": "shear"}

PICTURED = {
    "von_mises": PictureField("von Mises stress", "Pa", quantity=("stress", "von_mises")),
    "max_principal": PictureField("larger principal stress", "Pa", signed=True, quantity=("stress", "max_principal")),
    "min_principal": PictureField("smaller principal stress", "Pa", signed=True, quantity=("stress", "min_principal")),
    **{
        f"stress_{key}": PictureField(f"stress {key}, {axis}", "Pa", signed=True, quantity=("stress", key))
        for key, axis in _AXES.items()
    },
    "stress_zz": PictureField("stress zz, through the thickness", "Pa", signed=True),
    **{
        f"strain_{key}": PictureField(f"strain {key}, {axis}", "", signed=True)
        for key, axis in {**_AXES, "zz": "through the thickness"}.items()
    },
}

REQUESTED = {
    "stress": "stresses xx, yy, xy and zz [Pa], recovered at nodes",
    "principal": "principal stresses in the plane [Pa], and the direction of the larger one from x towards y [rad]",
    "strain": "strains xx, yy, xy (of the tensor) and zz, recovered at nodes; Green's under large deformation",
}

PLANE_SOLIDS = Physics(
    name="plane solids",
    summary="elastic solids in the plane, in static equilibrium",
    solver=solid_plan,
    material=ElasticMaterial,
    materials=ELASTIC_MATERIALS,
    boundary={"x": "length", "y": "length"},
    loads=LOADS,
    quantities=QUANTITIES,
    sections=GOALS,
    effects=STATIC,
    derived=SOLID,
    invariants=(
        Invariant(
            follower_loads,
            "which pressures follow the boundary, and where, cannot change during an edit",
            "make it two scenes, or give the load in both and set it to 0",
        ),
    ),
    requested=REQUESTED,
    pictured=PICTURED,
    true_scale=(LARGE,),
    orders=(2, 1),
    order_why="at equal time of a frame their error is smaller than that of first order",
    check=check_static_solids,
    check_shape="restshape.physics.elasticity.outline_checks:check_plane_solid",
    inspect_shape="restshape.physics.elasticity.inspection:inspect_solid",
    singular_shape="restshape.physics.elasticity.singular_places:exponents_and_points",
    columns=buckling_columns,
)

MOVING_SOLIDS = replace(
    PLANE_SOLIDS,
    name="moving solids",
    summary="elastic solids in the plane, in motion",
    effects=IN_MOTION,
    columns=motion_columns,
    check=check_motion,
    check_shape="restshape.physics.elasticity.outline_checks:check_moving_solid",
    inspect_shape="restshape.physics.elasticity.inspection:inspect_motion",
)

FREE_VIBRATIONS = Physics(
    name="free vibrations",
    summary="the lowest modes of elastic bodies, which nothing needs to hold",
    solver=vibration_plan,
    material=VibratingMaterial,
    materials=ELASTIC_MATERIALS,
    boundary={"x": "length", "y": "length", "z": "length", "rx": "angle", "ry": "angle"},
    loads=LOADS,
    quantities=QUANTITIES,
    sections=GOALS,
    effects={"modal": MODAL},
    derived={"in_plane_modes": IN_PLANE_MODES, "grain": GRAIN, "regions": REGIONS},
    orders=(2, 1),
    mesh_keys=("layers",),
    pictured={"size_of_mode_1": PictureField("size of mode 1, amplitude arbitrary", "")},
    none_requested="the amplitude of a mode is arbitrary, and so are its stresses and strains",
    check=check_vibrations,
    check_shape="restshape.physics.elasticity.outline_checks:check_vibrating",
    inspect_shape="restshape.physics.elasticity.inspection:inspect_vibrating",
    columns=modal_columns,
)
