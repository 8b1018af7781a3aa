"""Plates of metal or wood that sound when they are struck: their lowest tones while their outline is edited.

After section 4.4 of the thesis. Quantities of interest: frequencies, by rank or of a mode that is followed, and areas.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from restshape.application import Application
from restshape.errors import UserError
from restshape.physics.elasticity.declaration import FREE_VIBRATIONS
from restshape.scene.effect import Decision, Effect, Implied
from restshape.scene.model import Scene
from restshape.scene.values import Strict, number_of


class Modal(Strict):
    """Keys of ``[effects.modal]``: the lowest free vibrations.

    Args:
        model: "solid", tetrahedra over the outline in ``mesh.layers`` layers; "plate", of triangles with shear, which
            knows motion out of the plane only; "plane_stress" or "plane_strain", which know motion in the plane only.
        modes: how many are wanted.
        in_plane: those whose motion is mostly in the plane count too; a mallet hardly sounds them.
        a4: frequency of the tone A4 [Hz].
    """

    model: Literal["solid", "plate", "plane_stress", "plane_strain"] = "solid"
    modes: Annotated[int, Field(ge=1, le=40)] = 5
    in_plane: bool = False
    a4: Annotated[number_of("frequency"), Field(gt=0)] = 440.0

    def decide(self, scene: Scene) -> Decision:
        """The order of the elements: the second, where the scene names none, for the first is far too stiff in bending.

        Raises:
            UserError: what the keys ask for makes no sense with the scene's mesh.
        """
        if self.model == "plate":
            if scene.mesh.order == 2:
                raise UserError(
                    "plates have elements of the first order only", "mesh.order", "set it to 1, or leave it out"
                )
            return Decision(self, "plates have no layers: mesh.layers means nothing" if scene.mesh.layers else "", 1)
        return Decision(self, "" if scene.mesh.order else "second-order elements, for the first bend too stiffly", 2)


def columns(scene: Scene) -> dict[str, Any]:
    """The columns that a replay of modes has besides: frequencies, the tone of the first, numbers of the modes."""
    modes = Modal.model_validate(scene.effects.get("modal", {})).modes
    return {
        **{f"f_{k + 1}": np.float64 for k in range(modes)},
        "tone": "S8",
        "cents": np.float64,
        "mode_ids": "S160",
        "inertia_checked": np.int64,
        "missed_modes": np.int64,
    }


def in_plane(scene: Scene, _: frozenset[str]) -> str:
    """Why modes in the plane count; empty where they are passed over."""
    modal = Modal.model_validate(scene.effects.get("modal", {}))
    if modal.model in ("plane_stress", "plane_strain"):
        return f'effects.modal.model = "{modal.model}": all modes are in the plane'
    return "effects.modal.in_plane: modes in the plane count too" if modal.model == "solid" and modal.in_plane else ""


def only_normal(raw: dict[str, Any], _: frozenset[str]) -> dict[str, Any]:
    """The tables of a scene in which modes in the plane do not count."""
    modal = {**raw.get("effects", {}).get("modal", {}), "in_plane": False}
    return {**raw, "effects": {**raw.get("effects", {}), "modal": modal}}


application = Application(
    name="metallophone",
    summary="plates that sound when struck: eigenfrequencies and modes",
    effects={"modal": Effect(Modal, "free vibrations", required=True)},
    implied={
        "in_plane_modes": Implied("modes in the plane", in_plane, "modes in the plane are passed over", only_normal),
        **FREE_VIBRATIONS.implied,
    },
    folder=Path(__file__).parent,
    physics=(FREE_VIBRATIONS,),
    analysis="restshape.physics.vibrating_bodies:modal_analysis",
    columns="restshape_apps.metallophone:columns",
)
