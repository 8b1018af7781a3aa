"""A number of a scene that changes, and how fast others follow it: dual numbers through formulas and bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from graphlib import TopologicalSorter
from typing import Any

import numpy as np
from pydantic import BaseModel

from restshape.errors import UserError
from restshape.scene.bodies import MEASURES, Body, Start, numbers_of
from restshape.scene.duals import Dual
from restshape.scene.expressions import Expression, Value
from restshape.scene.given_numbers import given_numbers, value_below
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

TABLES = ("material", "bodies", "supports", "seams", "start", "effects", "parameters")
"""Whose numbers drapes have derivatives by."""
PATTERN = ("shape", "panels", "darts")
"""Those whose numbers draw or lay the pattern."""
EFFECTS = ("gravity", "contact")
"""Those whose numbers drapes have derivatives by."""
SILENT = ("slope", "scatter", "seed", "ease", "unit", "spacing", "band")
"""Numbers that give a support its kind, a start its chance, a seam its note, or a body its grid."""
STEP = 1e-30
"""Of complex steps, which are exact: nothing is subtracted."""


class ChangingNumber:
    """One number of a scene, by which all others are differentiated.

    Args:
        scene: as it is; plan: its effects.
        key: dotted, such as "bodies.ball.sphere.center.2" or "parameters.slope".

    Raises:
        UserError: it names no number of these tables.
    """

    def __init__(self, scene: Scene, plan: Plan, key: str) -> None:
        self.scene, self.plan, self.key = scene, plan, key
        parts = key.split(".")
        if parts[0] == "effects":
            here = value_below(plan.settings(parts[1]), tuple(parts[2:])) if len(parts) > 2 else None
        else:
            here = value_below(_with_start(scene), tuple(parts)) if parts[0] in (*TABLES, *PATTERN) else None
        if isinstance(here, bool) or not isinstance(here, int | float):
            tables = ", ".join((*TABLES, *PATTERN))
            like = f"material.{next(iter(scene.material), 'cotton')}.{parts[-1] if parts[0] == 'material' else 'E'}"
            raise UserError(f"{key!r} is no number of this scene in {tables}", "--by", f"name one like {like}")
        self.value = float(here)
        self.parameter = parts[1] if parts[0] == "parameters" else ""
        self.parameters = _parameter_rates(scene, self.parameter) if self.parameter else {}

    def scene_with(self, value: float) -> Scene:
        """The scene with another value of the number; of a list with the others as they are written.

        Raises:
            UserError: the value does not suit it.
        """
        whole, _, last = self.key.rpartition(".")
        written = value_below(self.scene.raw, tuple(whole.split(".")))
        if self.key.startswith("supports.") and isinstance(written, list):
            return revise(self.scene, whole, {name: value if name == last else 0.0 for name in written})
        if not last.isdigit():
            return revise(self.scene, self.key, value)
        values = written if isinstance(written, list) else self._settled(whole.split("."))
        return revise(self.scene, whole, [value if k == int(last) else one for k, one in enumerate(values)])

    def _settled(self, parts: list[str]) -> Sequence[Value]:
        """A list that the file need not have: of an effect, of the start or of a fabric that is given by name."""
        if parts[0] == "effects":
            return value_below(self.plan.settings(parts[1]), tuple(parts[2:]))
        return value_below(_with_start(self.scene), tuple(parts))

    def rate(self, value: Value, where: str) -> float:
        """The rate of a value at a place of the scene."""
        return float(self.rates(value, where, np.zeros((1, 2)))[0])

    def rates(self, value: Value, where: str, X: np.ndarray) -> np.ndarray:
        """Rates (n,) of a value at a place of the scene, at material coordinates X (n, 2) [m]."""
        if isinstance(value, Expression):
            return _rates(value, X, self.scene.parameters, self.parameters)
        return np.full(len(X), float(where == self.key))

    def vector(self, values: Sequence[Value], where: str) -> np.ndarray:
        """Rates (k,) of a list of values."""
        return np.array([self.rate(value, f"{where}.{k}") for k, value in enumerate(values)])

    def form(self, name: str, body: Body) -> dict[str, Any]:
        """Rates of the keys of a body's form, numbers and arrays."""
        where, form = f"bodies.{name}.{body.kind}", body.form
        # Sizes of mannequins make other grids, which have no derivative by them.
        keys = [key for key in numbers_of(form) if not is_measure(("bodies", name, body.kind, key))]
        return {key: self._either(getattr(form, key), f"{where}.{key}") for key in keys}

    def start(self) -> dict[str, np.ndarray]:
        """Rates (3,) of the keys of where the flat cloth lies."""
        start = self.scene.start or Start()
        return {key: self.vector(getattr(start, key), f"start.{key}") for key in ("move", "turn", "about")}

    def dual_body(self, name: str, body: Body) -> Body:
        """The body, of numbers, with dual ones in their place."""
        numbers, rates = body.evaluated(self.scene.parameters).form, self.form(name, body)
        form = numbers.model_copy(update={key: _dual(getattr(numbers, key), rate) for key, rate in rates.items()})
        return body.model_copy(update={body.kind: form})

    def dual(self, value: float, where: str) -> Dual:
        """A plain number with its rate."""
        return Dual(np.float64(value), self.rate(value, where))

    def stepped(self, name: str) -> Any:
        """A material with a complex step on the number that changes, or None where it stays."""
        material, parts = self.scene.material[name], self.key.split(".")
        if parts[:2] != ["material", name]:
            return None
        return _stepped(material, parts[2:])

    def _either(self, value: Value | Sequence[Value], where: str) -> Any:
        if isinstance(value, tuple):
            return self.vector(value, where)
        return self.rate(value, where)


def _with_start(scene: Scene) -> Scene:
    """The scene with where its flat cloth lies, which it need not say."""
    return scene.model_copy(update={"start": scene.start or Start()})


def number_keys(scene: Scene, plan: Plan) -> list[str]:
    """Keys of all numbers of a scene that may change its drape, in the order of its tables."""
    found = [key for table in TABLES if table != "effects" for key in _numbers(getattr(scene, table), (table,))]
    if scene.start is None and scene.supports:
        found += _numbers(Start().move, ("start", "move"))
    for name in EFFECTS:
        found += _numbers(plan.settings(name), ("effects", name))
    return [key for key in found if key.rpartition(".")[2] not in SILENT and not is_measure(key.split("."))]


def is_measure(key: Sequence[str]) -> bool:
    """Whether the key of a number is that of a size of a mannequin."""
    return len(key) == 4 and key[0] == "bodies" and key[2] == "mannequin" and key[3] in MEASURES


def _numbers(here: object, key: tuple[str, ...]) -> Iterator[str]:
    """Dotted keys of the numbers in models, tables and lists; formulas are none."""
    if isinstance(here, BaseModel):
        here = {name: getattr(here, name) for name in type(here).model_fields}
    if isinstance(here, list | tuple):
        here = {str(place): one for place, one in enumerate(here)}
    if isinstance(here, Mapping):
        for name, one in here.items():
            yield from _numbers(one, (*key, name))
    elif isinstance(here, int | float) and not isinstance(here, bool):
        yield ".".join(key)


def _parameter_rates(scene: Scene, name: str) -> dict[str, float]:
    """Rates of a parameter, its own being 1, and of those that formulas make of it, by name."""
    formulas = {one.key[1]: one.formula for one in given_numbers(scene) if one.key[0] == "parameters"}
    formulas.pop(name, None)
    found = {name: 1.0}
    # No parameter is made of itself.
    for key in TopologicalSorter({key: one.parameters for key, one in formulas.items()}).static_order():
        if key in formulas and not formulas[key].names.isdisjoint(found):
            found[key] = float(_rates(formulas[key], np.zeros((1, 2)), scene.parameters, found)[0])
    return found


def _rates(formula: Expression, X: np.ndarray, values: Mapping[str, float], rates: Mapping[str, float]) -> np.ndarray:
    """Rates (n,) of a formula at material coordinates X (n, 2) [m], by values and rates of parameters by name."""
    named = [(name, rate) for name, rate in rates.items() if name in formula.names]
    parts = (rate * formula.parameter_rate(X[:, 0], X[:, 1], values, name) for name, rate in named)
    return np.sum([np.zeros(len(X)), *parts], axis=0)


def _dual(value: Any, rate: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(Dual(np.float64(part), slope) for part, slope in zip(value, rate))
    return Dual(np.float64(value), rate)


def _stepped(model: Any, parts: Sequence[str]) -> Any:
    """A copy of nested models, lists and numbers with a complex step on one number."""
    if not parts:
        return complex(model, STEP)
    if isinstance(model, tuple | list):
        return tuple(_stepped(one, parts[1:]) if k == int(parts[0]) else one for k, one in enumerate(model))
    return model.model_copy(update={parts[0]: _stepped(getattr(model, parts[0]), parts[1:])})
