"""Mannequins as bodies of cloth: measures that edits change, what lies on them, and what has no derivative."""

import numpy as np
import pytest

from restshape import _kernels
from restshape.application import application
from restshape.errors import UserError
from restshape.physics.cloth import body_path
from restshape.physics.cloth.body_path import BodyPath, between, goes_on, same_kind
from restshape.physics.cloth.contact.body_columns import body_columns, body_row, recorded_bodies
from restshape.physics.cloth.contact.body_motion import is_remade, moved_with
from restshape.physics.cloth.mannequin.body_shape import BodyShape
from restshape.physics.cloth.mannequin.growth import growth, mannequin_distance
from restshape.physics.cloth.sensitivity.scene_numbers import ChangingNumber, number_keys
from restshape.scene.bodies import Body
from restshape.scene.body_sizes import Sizes
from restshape.scene.load import load_scene, revise
from restshape.shape.hand.rigid_body_drag import form_of, scaled, with_form

GROWING = application("couture").folder / "scenes" / "growing.toml"


class NoEffects:
    """A plan without any."""

    def settings(self, _):
        return None


def mannequin(**keys):
    return Body.model_validate({"mannequin": keys}).evaluated({})


@pytest.fixture
def far_apart(monkeypatch):
    """Mannequins whose surfaces are 4 cm apart, each 16 cm thick: the way goes in three parts."""
    body_path.stairs.cache_clear()
    monkeypatch.setattr(body_path, "growth", lambda before, after: 0.04)
    monkeypatch.setattr(body_path, "size_of", lambda body: 0.08)
    monkeypatch.setattr(body_path, "reach_of", lambda form: 1.0)
    yield
    body_path.stairs.cache_clear()


def test_measures_that_are_left_out_follow_the_others():
    form = mannequin(bust=1.0).form
    assert form.neck == pytest.approx(0.11 * 1.68 + 0.19) and form.thigh == pytest.approx(0.575 * 0.96)
    assert mannequin(bust=1.0, neck=0.4).form.neck == 0.4


def test_sections_take_what_lies_on_them_to_the_other_body():
    old, new = BodyShape(Sizes().completed()), BodyShape(Sizes(height=1.75, hip=1.05, waist=0.8).completed())
    angle = np.linspace(0.0, 2.0 * np.pi, 9)
    for part, other in zip(old.parts, new.parts):
        x, y, half, front, back = part.along(np.full(9, np.mean(part.ends))).T
        deep = np.where(np.sin(angle) < 0.0, front, back)
        own = np.column_stack([x + half * np.cos(angle), y + deep * np.sin(angle), np.full(9, np.mean(part.ends))])
        places = own @ part.axes + part.origin
        taken = part.taken_to(other, places)
        np.testing.assert_allclose(other.reach(taken), 0.0, atol=1e-12)
        np.testing.assert_allclose(other.taken_to(part, taken), places, atol=1e-12)
    # The hip of the one is that of the other.
    at_hip = np.array([[0.0, 0.3, old.level("hip")]])
    assert old.trunk.taken_to(new.trunk, at_hip)[0, 2] == pytest.approx(new.level("hip"))


def test_sizes_change_by_stairs_and_places_evenly(far_apart):
    old, new = mannequin(hip=0.9, move=[0, 0, 0]), mannequin(hip=0.99, move=[0, 0, 0.3])
    assert is_remade(old, new) and goes_on(old, new) and not same_kind(old, new)
    ways = [between(old, new, share).form for share in (0.0, 0.2, 1.0 / 3.0, 0.5, 1.0)]
    assert [one.hip for one in ways] == pytest.approx([0.9, 0.93, 0.93, 0.96, 0.99])
    assert [one.move[2] for one in ways] == pytest.approx([0.0, 0.06, 0.1, 0.15, 0.3])


def test_a_body_of_other_settings_is_another_one():
    assert not goes_on(mannequin(), mannequin(spacing=0.01))
    assert same_kind(mannequin(), mannequin(scale=1.1)) and not is_remade(mannequin(), mannequin(scale=1.1))


def test_the_way_ends_where_sizes_change_next(far_apart):
    class Nothing:
        cells = None

    path = BodyPath([mannequin(hip=0.9)], [mannequin(hip=0.99)], Nothing())
    x, ends = np.zeros((3, 3)), [0.0]
    while ends[-1] < 1.0:
        ends.append(path.farthest(ends[-1], x, np.zeros((3, 3))))
    assert ends == pytest.approx([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0])
    assert path.least(0.0, x, np.zeros((3, 3))) == pytest.approx(1.0 / 3.0)
    # A change of sizes takes a third of 4 cm from the 2 cm that it may be in the cloth.
    moved = BodyPath([mannequin(hip=0.9)], [mannequin(hip=0.99, move=[0, 0, 0.3])], Nothing())
    assert moved.least(0.0, x, np.zeros((3, 3))) == pytest.approx((0.02 - 0.04 / 3.0) / 0.3)


@pytest.mark.parametrize("begin", [0.0, 1.0 / 3.0, 0.4])
def test_depths_are_those_of_the_sizes_that_the_body_has_there(far_apart, monkeypatch, begin):
    class Nothing:
        cells = None

    class Far:
        def __init__(self, body):
            asked.append(body.form)

        def lowest(self, x, cells, tolerance):
            return 1.0, 0, None

    asked = []
    monkeypatch.setattr(body_path, "kernel_body", Far)
    path = BodyPath([mannequin(hip=0.9)], [mannequin(hip=0.99, move=[0, 0, 0.3])], Nothing())
    end = path.farthest(begin, np.zeros((3, 3)), np.zeros((3, 3)))
    at = [path.at(share)[0].form.hip for share in (begin + 0.01, 0.5 * (begin + end), end)]
    assert asked and at == pytest.approx([asked[0].hip] * 3) and {one.hip for one in asked} == {asked[0].hip}


def test_a_recording_has_all_measures():
    body = mannequin(bust=1.0)
    columns = body_columns({"form": Body.model_validate({"mannequin": {"bust": 1.0}})})
    table = {name: np.array([value]) for name, value in body_row({"form": body}, columns).items()}
    assert table.keys() == columns.keys() and "bodies.form.mannequin.thigh" in table
    assert recorded_bodies(table, 0)["form"].form == body.form


def test_a_body_that_a_hand_makes_larger_keeps_what_is_left_out():
    scene = load_scene(GROWING)
    kind, form = form_of(scene, "body")
    made = with_form(scene, "body", kind, scaled(kind, form, 1.1, None))
    written = made.raw["bodies"]["body"]["mannequin"]
    assert written["scale"] == pytest.approx(1.1) and written["hip"] == "hip" and "neck" not in written


@pytest.mark.parametrize(
    ("key", "value", "what"),
    [
        ("parameters.hip", "3 m", "hip 300 cm cannot be made"),
        ("bodies.body.mannequin.height", "9 m", "height 900 cm"),
    ],
)
def test_measures_that_no_body_has_are_refused(key, value, what):
    with pytest.raises(UserError, match=what) as refused:
        revise(load_scene(GROWING), key, value)
    assert "bodies.body" in str(refused.value) and refused.value.do


def test_no_drape_has_a_derivative_by_a_measure():
    scene = load_scene(GROWING)
    keys = number_keys(scene, NoEffects())
    assert "bodies.body.mannequin.height" not in keys and "bodies.body.mannequin.move.0" in keys
    number = ChangingNumber(scene, NoEffects(), "parameters.hip")
    assert "hip" not in number.form("body", scene.bodies["body"])


@pytest.mark.slow
@pytest.mark.skipif(not _kernels.has_cgal, reason="bodies of triangles need CGAL")
def test_places_on_a_mannequin_stay_as_far_from_it(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    keys = {"size": 0.028, "spacing": 0.025, "band": 0.03}
    old, new = mannequin(**keys), mannequin(hip=1.04, waist=0.8, turn=[0, 0, 0.3], move=[0.1, 0, 0], **keys)
    grid = mannequin_distance(old.form.sizes, 0.028, 0.025, 0.03)
    x = grid.X[::40]
    moved = moved_with(old, new, x)
    found = _kernels.Body.mesh(mannequin_distance(new.form.sizes, 0.028, 0.025, 0.03).grid, new.form.move, np.eye(3))
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    own = (moved - new.form.move) @ turn + new.form.move
    assert np.abs(found.distances(own) - grid.grid.values(x)).max() < 2e-3
    assert np.linalg.norm(moved_with(new, old, moved) - x, axis=1).max() < 2e-3
    assert 0.01 < growth(old.form, new.form) < 0.03
