"""Effects of furniture: keys of ``[effects]``, what they settle for a scene, and its columns."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field
from restshape_apps.furniture.physics.fasteners import fastener, wood
from restshape_apps.furniture.scene.furniture import RANGES_BYTES, REDUNDANT_BYTES, SUGGESTIONS_BYTES

from restshape.errors import UserError
from restshape.scene.effect import DerivedEffect, Effect, ResolvedSettings
from restshape.scene.model import Scene
from restshape.scene.source import suggestion
from restshape.scene.space_values import number
from restshape.scene.values import Number, Strict, Whole, number_of

SEARCHES = ("ranges", "suggestions")
OF_EACH_CASE = ("bending", *SEARCHES)
"""What looks at every case of loads. Without any load a piece is tested all the same: none of them drives it alone."""

KEPT_OF_ALL, KEPT_OF_ONE = ("symmetry", "level", "height"), ("level", "height", "place")
"""What may be kept of the whole piece, and of a plank."""

MANY = 3
"""Freedoms of a suggestion from which on the search is announced."""


class Nails(Strict):
    """Keys of ``[effects.nails]``: what counts in the durability of joints, which ``[fastener]`` and ``[joints]`` name.

    Args:
        moments: "line", of a joint's moments that about its line alone; "all", also those that bend it along its line
            and twist it. Where these do not count and overload a joint, the constraint status is "uncertain".
    """

    moments: Literal["line", "all"] = "line"

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The same.

        Raises:
            UserError: a wood or a fastener has a name that nobody knows.
        """
        places = [("wood.name", wood, scene.wood.name), ("fastener.name", fastener, scene.fastener.name)]
        places += [(f"planks.{name}.wood", wood, p.wood) for name, p in scene.planks.items() if p.wood]
        places += [
            (f"joints.{name}.fastener", fastener, j.fastener) for name, j in scene.joints.named.items() if j.fastener
        ]
        for key, known, name in places:
            try:
                known(name)
            except UserError as error:
                raise UserError(error.what, key, error.do) from error
        idle = []
        if scene.pushes and "push" not in scene.effects:
            idle.append("pushes are not looked at: there is no [effects.push]")
        if scene.weights and "gravity" not in scene.effects:
            idle.append("weights weigh nothing: there is no [effects.gravity]")
        return ResolvedSettings(self, "; ".join(idle), warns=bool(idle))


class Gravity(Strict):
    """Keys of ``[effects.gravity]``: the acceleration g [m/s^2] that planks and weights have.

    Args:
        g: acceleration (x, y, z).
    """

    g: Annotated[list[number_of("acceleration")], Field(min_length=3, max_length=3)] = [0.0, 0.0, -9.80665]

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The same, with a doubt where it does not press the piece on its floor."""
        g = [number(one, scene.parameters) for one in self.g]
        odd = g[2] >= 0.0 and any(g)
        why = "it does not press on the floor; g = [0, 0, -9.81] points down" if odd else ""
        return ResolvedSettings(self, why, warns=odd)


class Push(Strict):
    """Keys of ``[effects.push]``: none; each of ``[pushes]`` is a case of its own beside the weights."""

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The same.

        Raises:
            UserError: there is no push.
        """
        if not scene.pushes:
            raise UserError("there is no push", "effects.push", "add [pushes.NAME], or leave out [effects.push]")
        return ResolvedSettings(self)


class Bending(Strict):
    """Keys of ``[effects.bending]``: none; planks deflect as beams under the forces of rigid ones."""


class Guide(Strict):
    """Keys of ``[effects.guidance]``: what is looked for while the piece is edited.

    Args:
        ranges: where the parameter under the hand may go.
        suggestions: for a piece that does not hold, or holds in doubt, at most so many.
        freedoms: of the design that one of them changes at most.
        keep: what none of them changes: "symmetry", "level", "height" of the piece; "PLANK level", "PLANK height", or
            "PLANK place" of a plank.
        farthest: how far one of them moves any corner of a plank at most, in parts of the piece's longest side; without
            it 0.2 where something as near holds, else 0.5.
    """

    ranges: bool = True
    suggestions: Annotated[Whole, Field(ge=0, le=8)] = 8
    freedoms: Annotated[Whole, Field(ge=1, le=5)] = MANY
    keep: list[str] = []
    farthest: Annotated[Number, Field(gt=0, le=10)] | None = None

    def resolve(self, scene: Scene) -> ResolvedSettings:
        """The same keys, with a warning of how many combinations there are of more freedoms than usual.

        Raises:
            UserError: `keep` names no plank of the scene, or nothing that can be kept.
        """
        for lock in self.keep:
            plank, _, what = lock.rpartition(" ")
            if what not in (KEPT_OF_ALL if not plank else KEPT_OF_ONE):
                do = f"write {', '.join(map(repr, KEPT_OF_ALL))}, or a plank and one of {', '.join(KEPT_OF_ONE)}"
                raise UserError(f"{lock!r} cannot be kept", "effects.guidance.keep", do)
            if plank and plank not in scene.planks:
                do = suggestion(plank, sorted(scene.planks))
                raise UserError(f"there is no plank {plank!r}", "effects.guidance.keep", do)
        if self.freedoms <= MANY or not self.suggestions:
            return ResolvedSettings(self)
        # The kernels are not loaded before a scene asks for it.
        from restshape.guidance.force_space import forecast

        most = forecast(8 * len(scene.planks), self.freedoms)
        tried, seconds = f"{most.combinations:,}", f"{most.seconds:.3g} s"
        why = f"up to {tried} combinations of {self.freedoms} freedoms, nominally {seconds} a search"
        return ResolvedSettings(self, why, warns=True)


def furniture_columns(scene: Scene) -> dict[str, Any]:
    """The columns that a replay of furniture has besides."""
    reals = ("utilisation", "stability_margin", "unbalanced_load", "deflection", "bending_utilisation", "at")
    reals += ("range_low", "range_high")
    reals += ("ms_equilibrium", "ms_range", "ms_suggestions")
    integers = ("flaws", "redundant_count", "inside", "tried", "tested", "suggested")
    texts = dict.fromkeys(("note", "violated_constraints"), "S400")
    texts |= {"parameter": "S96", "ranges": "S240", "valid_ranges": f"S{RANGES_BYTES}"}
    texts |= {"suggestions": f"S{SUGGESTIONS_BYTES}"}
    texts |= {"no_suggestions": "S240", "redundant": f"S{REDUNDANT_BYTES}"}
    return dict.fromkeys(integers, np.int64) | dict.fromkeys(reals, np.float64) | texts


def _guided(key: str, what: str) -> DerivedEffect:
    """A part of guidance that its key switches off where it is false or 0."""

    def cause(scene: Scene, on: frozenset[str]) -> str:
        asked = getattr(Guide.model_validate(scene.effects.get("guidance", {})), key)
        return f"effects.guidance.{key}: {what}" if asked else ""

    def without(raw: dict[str, Any], on: frozenset[str]) -> dict[str, Any]:
        effects = raw.get("effects", {})
        return {
            **raw,
            "effects": {
                **effects,
                "guidance": {**effects.get("guidance", {}), key: type(Guide.model_fields[key].default)()},
            },
        }

    return DerivedEffect(what, cause, f"the scene has none in effects.guidance.{key}", without)


EFFECTS = {
    "nails": Effect(Nails, "joints of planks, and the strength of what holds them", required=True),
    "gravity": Effect(Gravity, "weight of planks and of what is put on them", repeats=("push", *OF_EACH_CASE)),
    "push": Effect(Push, "sideways forces, a case each", repeats=OF_EACH_CASE),
    "bending": Effect(Bending, "deflection of planks by beam theory", quantities=("deflection",), repeats=SEARCHES),
    "guidance": Effect(Guide, "valid ranges and suggestions", required=True),
}
DERIVED = {
    "ranges": _guided("ranges", "valid ranges of what is under the hand"),
    "suggestions": _guided("suggestions", "suggestions for what does not hold"),
}
