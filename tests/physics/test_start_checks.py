"""What `restshape check` says of where cloth starts: it refuses what the first frame would, and warns of lengths."""

import pytest
from cloths import CONTACT, PIN, write_cloth

from restshape.cli.main import main

FLOOR = "[bodies.floor]\nplane = { point = [0, 0, -0.3], normal = [0, 0, 1] }\n"
GAP = 0.005
"""How far below the cloth the lower ball ends [m]."""


def balls(overlap: float) -> str:
    """A ball below the cloth, and one that begins so far [m] within it from above."""
    lower, upper = -0.25 - GAP, 0.25 - GAP - overlap
    forms = {"lower": lower, "upper": upper}
    return "".join(
        f"[bodies.{name}]\nsphere = {{ center = [0.5, 0.5, {z}], radius = 0.25 }}\n" for name, z in forms.items()
    )


@pytest.fixture
def both(tmp_path, capsys):
    """Exit code and output of check and of replay, of the first frame, of a scene of cloth."""

    def ran(*parts: str) -> list[tuple[int, str]]:
        scene = str(write_cloth(tmp_path, *parts))
        found = []
        for command in ("check", "replay"):
            code = main([command, scene, "--set", "effects.drape.steps=1"])
            out = capsys.readouterr()
            found.append((code, " ".join((out.out + out.err).split())))
        return found

    return ran


@pytest.mark.parametrize(
    ("parts", "why"),
    [
        ((PIN, CONTACT + 'self = true\nself_thickness = "9 cm"\n'), "effects.contact.self_thickness (line "),
        ((PIN, "[effects.contact]\nself = true\n[start]\nscatter = '30 cm'\n"), "begins across itself at"),
        # The lower ball does not reach the cloth, and the way out of the upper one leads into it.
        ((balls(0.02), CONTACT), "bodies.lower and bodies.upper overlap where the cloth starts, and hold it between"),
    ],
)
def test_check_refuses_what_the_first_frame_would(both, parts, why):
    (checked, said), (replayed, printed) = both(*parts)
    assert checked == replayed == 2
    assert why in said and why in printed


@pytest.mark.parametrize("overlap", [0.0, -0.004])
def test_bodies_that_do_not_overlap_may_have_cloth_between_them(both, overlap):
    (checked, said), (replayed, _) = both(balls(overlap), CONTACT)
    assert checked == replayed == 0
    assert "warning cloth begins" in said and "inside bodies.upper" in said


def test_a_coarse_mesh_and_a_thick_layer_of_contact_are_warned_of(both):
    coarse = "mesh.size: triangles of 250 mm show no folds of cloth 1 m long"
    thick = "[effects.contact]\nthickness = '11 cm'\n"
    for _, said in both(PIN, FLOOR, thick):
        # Four triangles along a side are just enough.
        assert 'cloth lies up to 110 mm above bodies, and is 1 m wide: set it to "10 mm" or so' in said
        assert coarse not in said
    for _, said in both(PIN, FLOOR, CONTACT):
        assert "cloth lies up to" not in said


def test_triangles_of_half_of_the_cloth_are_warned_of(tmp_path, capsys):
    scene = str(write_cloth(tmp_path, PIN))
    for command in ("check", "replay"):
        assert main([command, scene, "--set", "mesh.size='50 cm'"]) == 0
        out = capsys.readouterr()
        words = " ".join((out.out + out.err).split())
        assert 'show no folds of cloth 1 m long: set mesh.size to "100 mm" or less' in words
    assert main(["check", scene, "--set", "mesh.size=25"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert words.count("warning mesh.size") == 1 and "no folds" not in words


def test_cloth_as_heavy_as_a_wall_is_warned_of(tmp_path, capsys):
    """A thickness of 0.5 in a scene that is drawn in millimetres is half a metre."""
    scene = str(write_cloth(tmp_path, PIN))
    for thickness, words in (("0.5", "200 kg/m^2"), ("1e-9", "4e-07 kg/m^2"), ("'5 mm'", None)):
        assert main(["check", scene, "--set", f"material.cotton.thickness={thickness}"]) == 0
        said = " ".join(capsys.readouterr().out.split())
        assert (f"{words}, which is rho times thickness, is no cloth's" in said) == bool(words)
        assert ("is no cloth's" in said) == bool(words)
