"""What scenes and edit scripts of furniture may say."""

from restshape_apps.furniture.physics.solver import solver_plan
from restshape_apps.furniture.scene.effects import DERIVED, EFFECTS, furniture_columns
from restshape_apps.furniture.scene.furniture import Fastening, Floor, Joints, PlankSpec, PushSpec, WeightSpec, Wood
from restshape_apps.furniture.scene.furniture_checks import check_furniture
from restshape_apps.furniture.scene.plank_events import PLANK_EVENTS
from restshape_apps.furniture.scene.plank_quantities import OF_PLANKS

from restshape.scene.physics import Physics, Section

PLANKS = Physics(
    name="planks",
    summary="planks and what joins them",
    solver=solver_plan,
    sections={
        "wood": Section(Wood, "what planks are made of"),
        "fastener": Section(Fastening, "what joins them"),
        "planks": Section(PlankSpec, "the boards of the piece", named=True),
        "joints": Section(Joints, "which ends are joined to which faces"),
        "floor": Section(Floor, "what the piece stands on"),
        "weights": Section(WeightSpec, "masses put on planks", named=True),
        "pushes": Section(PushSpec, "forces on planks, a case of loads each", named=True),
    },
    events=PLANK_EVENTS,
    quantities=OF_PLANKS,
    effects=EFFECTS,
    derived=DERIVED,
    overridden="restshape_apps.furniture.shape.overridden_planks:kept_places",
    check=check_furniture,
    columns=furniture_columns,
)
