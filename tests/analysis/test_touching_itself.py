"""Scenes whose cloth touches itself, or does not: what is decided, refused, warned of, and the same to the bit."""

import json

import numpy as np
import pytest
from cloths import BALL, CONTACT, PIN, cloth

from restshape.application import application_of
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.self_contact.self_contact import SelfContact
from restshape.physics.cloth.self_contact.touching_itself import touches_itself
from restshape.scene.plan import plan

SELF = "effects.contact.self"


def row_of(scene, *settings):
    """The row of the first frame of a scene with further settings."""
    return first_frame(scene.path, list(settings)).row


def test_cloth_touches_itself_unless_its_outline_is_constrained(tmp_path):
    pinned = cloth(tmp_path, PIN)
    assert touches_itself(pinned) and plan(pinned, application_of(pinned)).on("self_contact")
    around = cloth(tmp_path, PIN.replace('"a"', '"outline"'))
    assert not touches_itself(around) and not plan(around, application_of(around)).on("self_contact")
    off = cloth(tmp_path, BALL, CONTACT + "self = false\n")
    assert not plan(off, application_of(off)).on("self_contact")


@pytest.mark.slow
def test_where_nothing_meets_energies_are_the_same_to_the_bit(tmp_path):
    scene = cloth(tmp_path, BALL, CONTACT, "[quantities]\npotential = { energy = 'potential' }\n")
    large = "bodies.ball.sphere.radius=0.8", "bodies.ball.sphere.center.2=-0.82"
    on, off = (row_of(scene, f"{SELF}={said}", *large, "mesh.size=0.2") for said in ("true", "false"))
    assert on["crossings"] == off["crossings"] == 0
    assert on["q_potential"] == off["q_potential"]


def test_too_large_a_thickness_is_refused_and_too_coarse_a_mesh_warned_of(tmp_path):
    scene = cloth(tmp_path, PIN, CONTACT + 'self = true\nself_thickness = "9 cm"\n')
    with pytest.raises(UserError, match="a third of that is the most") as refused:
        row_of(scene)
    assert "or less" in refused.value.do
    fine = cloth(tmp_path, PIN, CONTACT + 'self = true\nself_thickness = "1 cm"\n')
    (warned,) = plan(fine, application_of(fine)).warnings
    assert 'set mesh.size to "100 mm"' in warned
    assert (
        plan(
            cloth(tmp_path, PIN, CONTACT + "self = true\n", overrides=("mesh.size=0.02",)), application_of(fine)
        ).warnings
        == ()
    )


def test_a_start_across_itself_is_refused_with_the_place_or_comes_apart(tmp_path):
    scene = cloth(tmp_path, PIN, "[start]\nscatter = '30 cm'\n", overrides=("mesh.size=0.2",))
    with pytest.raises(UserError, match=r"begins across itself at \d+ triangles, first at \("):
        row_of(scene, f"{SELF}=true", "mesh.size=0.2")
    row = row_of(scene, "mesh.size=0.2")
    assert "begins across itself" in row["note"]
    # It rests across itself, and is moved apart from there.
    assert row["converged"] and row["crossings"] == 0 and "passes through itself" not in row["untrusted"]


def test_layers_that_catch_on_each_other_are_warned_of_with_the_size_to_take(tmp_path):
    """With friction between layers, and contact that begins at more than a tenth of the mesh size."""

    def warnings(*keys):
        scene = cloth(tmp_path, PIN, "\n".join([CONTACT, "self = true", *keys]))
        return plan(scene, application_of(scene)).warnings

    (warned,) = warnings('self_thickness = "5 cm"', "self_friction = 0.3")
    assert "catch on each other" in warned and 'effects.contact.self_thickness to "25 mm"' in warned
    assert warnings('self_thickness = "5 cm"') == warnings('self_thickness = "25 mm"', "self_friction = 0.3") == ()


def test_friction_between_layers_goes_on_to_a_new_mesh(tmp_path, monkeypatch):
    """What holds its nodes is handed on where the size of the mesh is another one."""
    cloth(tmp_path, PIN, CONTACT + "self = true\nself_friction = 0.3\n")
    lines = [
        {"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"},
        {"t": 1, "do": "set", "key": "mesh.size", "value": 0.2},
    ]
    (tmp_path / "edits.jsonl").write_text("\n".join(map(json.dumps, lines)))
    handed, hold = [], SelfContact.hold

    def noted(contact, x, slides):
        handed.append((len(contact.surface.flat), np.shape(slides)))
        hold(contact, x, slides)

    monkeypatch.setattr(SelfContact, "hold", noted)
    assert main(["replay", str(tmp_path / "cloth.toml"), str(tmp_path / "edits.jsonl")]) == 0
    ((corners, shape),) = handed
    assert shape == (corners, 4)
