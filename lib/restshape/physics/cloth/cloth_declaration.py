"""What scenes of cloth may say."""

# More than 15 modules: all tables and keys of such scenes meet here.

from typing import Literal

from restshape.physics.cloth.cloth_derived_effects import CLOTH as DERIVED
from restshape.physics.cloth.cloth_scene_checks import check_cloth
from restshape.physics.cloth.cloth_solver_plan import cloth_plan
from restshape.physics.cloth.effects import EFFECTS, cloth_columns
from restshape.physics.cloth.sheet.cloth_material_keys import CLOTH_MATERIALS, ClothMaterial
from restshape.physics.cloth.sheet.weight import mass_and_weight
from restshape.physics.cloth.support_keys import ClothSupport
from restshape.scene.bodies import Body, Start, body_words, start_words
from restshape.scene.dart_event import DrawnDart
from restshape.scene.dart_keys import Dart
from restshape.scene.held_point import Hold, hold_words
from restshape.scene.load_kind import ENTITIES
from restshape.scene.panels import Panel, PatternLayout, panel_words
from restshape.scene.physics import OwnPictures, Physics, PictureField, Section
from restshape.scene.quantity import QuantityKind
from restshape.scene.seam_keys import Seam

REQUESTED = {
    "stress": "tensions xx, yy and xy [N/m] of the triangles, in the directions of the flat pattern",
    "principal": "smaller principal tension [N/m], and the direction of the larger one from x towards y [rad]",
    "strain": "Green's strains xx, yy and xy (of the tensor) of the triangles, in the directions of the flat pattern",
}
"""Groups of fields that recordings hold where `recording.fields` names them."""

CLOTH = Physics(
    name="cloth",
    summary="sheets that stretch and bend, hang from supports and lie on bodies",
    solver=cloth_plan,
    material=ClothMaterial,
    materials=CLOTH_MATERIALS,
    boundary={"x": "length", "y": "length", "z": "length", "slope": "angle"},
    support=ClothSupport,
    quantities={
        "displacement": QuantityKind(Literal["x", "y", "z", "magnitude"], "length", "mean"),
        "position": QuantityKind(
            Literal["x", "y", "z"],
            "length",
            "mean",
            reductions=("mean", "max", "min"),
            summary="a coordinate in space, whatever the pattern",
        ),
        "reaction": QuantityKind(Literal["x", "y", "z"], "force", "sum", on=tuple(ENTITIES)),
        "energy": QuantityKind(
            Literal["strain", "membrane", "bending", "seams", "potential"],
            "moment",
            "sum",
            summary='of cloth "strain" is "membrane" and "bending", "potential" that with weight, seams and contact',
        ),
        "drape_coefficient": QuantityKind(
            Literal[True],
            "number",
            "sum",
            summary="area of the shadow from above over that of the flat cloth, each less that of `at`, on a disc",
        ),
        "folds": QuantityKind(Literal[True], "number", "sum", whole=True, summary="folds around the shadow from above"),
    },
    sections={
        "bodies": Section(Body, "what cloth comes to lie on", named=True, words=body_words),
        "seams": Section(Seam, "edges that are sewn together", named=True),
        "darts": Section(Dart, "what is cut out of panels, or folded, and sewn", named=True),
        "panels": Section(Panel, "pieces of the pattern, in place of one shape", named=True, words=panel_words),
        "layout": Section(
            PatternLayout, '"auto": all panels are packed in rows', optional=True, words=lambda layout: layout.root
        ),
        "hold": Section(Hold, "a point of the cloth that a hand holds in space", optional=True, words=hold_words),
        "start": Section(Start, "where the flat cloth lies at first", optional=True, words=start_words),
    },
    events={"dart": DrawnDart},
    effects=EFFECTS,
    derived=DERIVED,
    value_drags=("drag", "rotate", "scale"),
    requested=REQUESTED,
    pictured={"tension": PictureField("larger principal tension", "N/m")},
    pictures=OwnPictures(
        shows="restshape.physics.cloth.pictures.drape:shows_cloth",
        draw="restshape.physics.cloth.pictures.drape_frames:draw_drape",
        true_scale="cloth is drawn where it lies",
    ),
    body_surface="restshape.physics.cloth.pictures.body_surfaces:surface_in_scene",
    mesh_keys=("levels",),
    mesh_jumps=False,
    check=check_cloth,
    inspect_shape="restshape.physics.cloth.cloth_inspection:inspect_cloth",
    recorded="restshape.physics.cloth.contact.mesh_bodies:recorded_surfaces",
    doubt_shape="restshape.physics.cloth.coarse_cloth:coarse_words",
    check_start="restshape.physics.cloth.relaxation.start_check:check_start",
    columns=cloth_columns,
    summed=mass_and_weight,
    instead={"loads": "use [effects.gravity] and [bodies.NAME]"},
)
