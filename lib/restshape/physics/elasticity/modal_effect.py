"""The effect of free vibrations: keys of ``[effects.modal]``, its columns, and whether modes in the plane count."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field

from restshape.analysis.modal.hanging_columns import NOTE, PLACES, loss_columns
from restshape.errors import UserError, ValueProblem
from restshape.scene.effect import DerivedEffect, Effect, ResolvedSettings
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table, table_in, tables_in
from restshape.scene.values import Length, Ordinal, Strict, Whole, number_of

MOST_MODES = 40
"""That may be wanted."""


def _two_places(names: tuple[str, ...]) -> tuple[str, ...]:
    """The names of two places, or none.

    Raises:
        ValueProblem: there are one or more than two, or one twice.
    """
    if names and (len(names) != 2 or names[0] == names[1]):
        raise ValueProblem("a plate is hung at two places", 'name two points or holes: at = ["left", "right"]')
    return names


class HangingKeys(Strict):
    """Keys of ``effects.modal.hanging``: the two places at which the plate is hung, as columns.

    Args:
        weights: of the modes by rank, those without one count nothing; left out, all count alike.
        mode: the one on whose nodal lines the places lie: the one that had this rank at the start.
        at: names of two points of ``[shape.points]``, or of holes, that are judged instead; of a hole its rim is.
        apart: the least distance between the two; left out, the radius of gyration.
        margin: the least distance of each from the outline and from holes, as drilling needs it.
    """

    model_config = ConfigDict(title="Hanging")
    weights: Annotated[tuple[Annotated[float, Field(ge=0)], ...], Field(max_length=MOST_MODES)] = ()
    mode: Annotated[Ordinal, Field(le=MOST_MODES)] = 1
    at: Annotated[tuple[str, ...], AfterValidator(_two_places)] = ()
    apart: Annotated[Length, Field(gt=0)] | None = None
    margin: Annotated[Length, Field(ge=0)] = 0.0


class ModalKeys(Strict):
    """Keys of ``[effects.modal]``: the lowest free vibrations.

    Args:
        model: "solid", tetrahedra over the outline in ``mesh.layers`` layers; "plate", of triangles with shear, which
            knows motion out of the plane only; "plane_stress" or "plane_strain", which know motion in the plane only.
        modes: how many are wanted.
        in_plane: those whose motion is mostly in the plane count too; a mallet hardly sounds them.
        a4: frequency of the tone A4 [Hz].
        hanging: where the plate is hung: columns of two places on nodal lines and of what they take from each mode.
    """

    model_config = ConfigDict(title="Modal")
    model: Literal["solid", "plate", "plane_stress", "plane_strain"] = "solid"
    modes: Annotated[Whole, Field(ge=1, le=MOST_MODES)] = 5
    in_plane: bool = False
    a4: Annotated[number_of("frequency"), Field(gt=0)] = 440.0
    hanging: HangingKeys | None = None

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The order of the elements: the second, where the scene names none, for the first is far too stiff in bending.

        Raises:
            UserError: what the keys ask for makes no sense with the scene's mesh.
        """
        if self.model == "plate":
            if scene.mesh.order == 2:
                raise UserError(
                    "plates have elements of the first order only", "mesh.order", "set it to 1, or leave it out"
                )
            return ResolvedSettings(
                self, "plates have no layers: mesh.layers means nothing" if scene.mesh.layers else "", 1
            )
        return ResolvedSettings(
            self, "" if scene.mesh.order else "second-order elements, for the first bend too stiffly", 2
        )


def modal_keys(scene: Scene) -> ModalKeys:
    """The keys of a scene, with defaults filled in."""
    return ModalKeys.model_validate(scene.effects.get("modal", {}))


def modal_columns(scene: Scene) -> dict[str, Any]:
    """The columns that a replay of modes has besides: frequencies, the tone of the first, numbers of the modes."""
    keys = modal_keys(scene)
    modes = keys.modes
    hung = {**dict.fromkeys((*PLACES, *loss_columns(modes)), np.float64), NOTE: "S120"} if keys.hanging else {}
    return {
        **{f"f_{k + 1}": np.float64 for k in range(modes)},
        "tone": "S8",
        "cents": np.float64,
        **{f"tone_{k + 1}": "S8" for k in range(modes)},
        **{f"cents_{k + 1}": np.float64 for k in range(modes)},
        "mode_ids": "S160",
        "inertia_checked": np.int64,
        "missed_modes": np.int64,
        **hung,
    }


def _in_plane(scene: Scene, _: frozenset[str]) -> str:
    """Why modes in the plane count; empty where they are passed over."""
    modal = modal_keys(scene)
    if modal.model in ("plane_stress", "plane_strain"):
        return f'effects.modal.model = "{modal.model}": all modes are in the plane'
    return "effects.modal.in_plane: modes in the plane count too" if modal.model == "solid" and modal.in_plane else ""


def _only_normal(raw: Table, _: frozenset[str]) -> Table:
    """The tables of a scene in which modes in the plane do not count."""
    modal = {**tables_in(raw, "effects").get("modal", {}), "in_plane": False}
    return {**raw, "effects": {**table_in(raw, "effects"), "modal": modal}}


MODAL = Effect(ModalKeys, "free vibrations", required=True)
IN_PLANE_MODES = DerivedEffect("modes in the plane", _in_plane, "modes in the plane are passed over", _only_normal)
