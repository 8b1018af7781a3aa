"""Hypothesis strategies of formulas: some numbers of a scene, of its shape above all, follow parameters."""

from collections.abc import Iterator
from copy import deepcopy
from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.shape_strategies import Table

Place = tuple[str | int, ...]

EQUAL = ("{}*u", "u*({}) + 0*k", "{} + 0.1*w", "({})*cos(w)", "{}*sqrt(u)")
"""Formulas of a number that give it where u is 1 and w is 0."""
WRONG = ("{}/w", "{}*uu", "{} + 1 kg", "sqrt({} - 9)*u")
"""Those that mostly give none."""
PARAMETERS: tuple[Table, ...] = (
    {"u": 1.0, "w": 0.0},
    {"u": "1 + w", "w": 0.01},
    {"u": "1 - w", "w": "k*k"},
    {"w": "u - 1", "u": "2^0"},
    {"half": "0.5*u", "u": 0.95, "w": "half - 0.475"},
)
CIRCLE: Table = {"u": "1 + w", "w": "u - 1"}
RARELY = 19
"""One of so many and one is wrong."""
MOST = 4
"""Numbers that follow parameters."""


def numbers_in(content: Any, place: Place = ()) -> Iterator[Place]:
    """The places of the broken numbers of a scene, whole ones and those of parameters left out."""
    if isinstance(content, float):
        yield place
    elif isinstance(content, dict | list):
        for key, part in content.items() if isinstance(content, dict) else enumerate(content):
            if place or key != "parameters":
                yield from numbers_in(part, (*place, key))


@st.composite
def with_formulas(draw: st.DrawFn, scene: Table) -> Table:
    """A scene with formulas for one to four of its numbers, and with their parameters."""
    every = list(numbers_in(scene))
    shape = [place for place in every if place[0] == "shape"]
    found = deepcopy(scene)
    wrong = draw(st.integers(0, RARELY)) == RARELY
    found["parameters"] = {**scene.get("parameters", {}), **(CIRCLE if wrong else draw(st.sampled_from(PARAMETERS)))}
    found["parameters"].setdefault("k", 0.1)
    for _ in range(draw(st.integers(1, MOST))):
        places = shape if shape and draw(st.integers(0, 2)) else every
        if not places:
            break
        *way, last = draw(st.sampled_from(places))
        table: Any = found
        for key in way:
            table = table[key]
        if isinstance(table[last], float):
            form = draw(st.sampled_from(WRONG if draw(st.integers(0, RARELY)) == RARELY else EQUAL))
            table[last] = form.format(repr(table[last]))
    return found


values = st.one_of(
    st.sampled_from([1.0, 1.1, 0.9, 1.02, 0.0, -1.0, "1 + k"]).map(lambda value: ("u", value)),
    st.sampled_from([0.0, 0.05, -0.1, "u/4", "20 deg"]).map(lambda value: ("w", value)),
)
parameter_sets = values.map(lambda pair: [{"do": "set", "key": f"parameters.{pair[0]}", "value": pair[1]}])
"""A new value for one of the parameters."""
