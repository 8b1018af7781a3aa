"""What furniture adds to scenes and edit scripts."""

from restshape_apps.furniture.scene.furniture import Fastening, Floor, Joints, PlankSpec, PushSpec, WeightSpec, Wood
from restshape_apps.furniture.scene.furniture_checks import check_furniture
from restshape_apps.furniture.scene.plank_events import PLANK_EVENTS
from restshape_apps.furniture.scene.plank_quantities import OF_PLANKS

from restshape.scene.extension import SceneExtension, Section

EXTENSION = SceneExtension(
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
    check=check_furniture,
)
