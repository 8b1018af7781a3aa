"""Random formulas: those that change nothing leave a scene's numbers as they are, and wrong ones are refused."""

import tomllib
from functools import reduce

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from restshape_studies.stability import strategies
from restshape_studies.stability.batch import DRAWN
from restshape_studies.stability.formula_strategies import WRONG, numbers_in, with_formulas

from restshape.scene.expressions import Expression

SCENE = {
    "parameters": {"k": 0.2},
    "shape": {"vertices": {"p": [0.5, -1.25]}, "circle": {"radius": 0.1}},
    "mesh": {"size": 0.3},
}
QUICK = settings(
    max_examples=60, deadline=None, database=None, derandomize=True, suppress_health_check=list(HealthCheck)
)


def at(scene, place):
    return reduce(lambda table, key: table[key], place, scene)


def test_all_decimal_numbers_but_parameters_may_follow_one():
    assert [place[-1] for place in numbers_in(SCENE)] == [0, 1, "radius", "size"]


@QUICK
@given(with_formulas(SCENE))
def test_formulas_give_the_numbers_that_they_stand_for(drawn):
    """Each where u is 1 and w is 0, by Python's own arithmetic."""
    names = {"u": 1.0, "w": 0.0, "k": 0.2}
    changed = [place for place in numbers_in(SCENE) if at(drawn, place) != at(SCENE, place)]
    assert 1 <= len(changed) <= 4 and {"u", "w", "k"} <= drawn["parameters"].keys()
    for place in changed:
        text, number = at(drawn, place), at(SCENE, place)
        if text not in {form.format(repr(number)) for form in WRONG}:
            assert Expression(text).evaluate(0.0, 0.0, names) == pytest.approx(number, rel=1e-15)


@pytest.mark.slow
def test_examples_have_formulas_and_set_their_parameters(monkeypatch):
    """In all of them where every one shall."""
    monkeypatch.setattr(strategies, "FORMULA_SHARE", 1)
    drawn = []

    @settings(QUICK, max_examples=15, phases=[Phase.generate])
    @given(strategies.examples(["solid"], DRAWN))
    def take(example):
        drawn.append(example)

    take()
    assert all({"u", "w"} <= tomllib.loads(one.scene)["parameters"].keys() for one in drawn)
    assert any("u" in str(tomllib.loads(one.scene)["shape"]["vertices"]) for one in drawn)
    assert any('"parameters.u"' in one.edits for one in drawn)
