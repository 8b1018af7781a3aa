"""What an export says that its file leaves out."""

import pytest

from restshape.cli.main import main


@pytest.mark.parametrize("thickness", ['"4 mm"', '"0.004*(1 - 0.3*exp(-((x - 0.085)/0.02)^2))"'])
def test_a_body_whose_thickness_is_a_formula_is_a_face_in_step(tmp_path, capsys, thickness):
    assert main(["new", "metallophone", str(tmp_path / "bar")]) == 0
    scene, out = str(tmp_path / "bar" / "scene.toml"), str(tmp_path / "bar.step")
    capsys.readouterr()
    assert (
        main(["export", scene, "--set", f"material.aluminium.thickness={thickness}", "--as", "step", "--out", out]) == 0
    )
    said = capsys.readouterr()
    assert ("a face without thickness" in said.out + said.err) == ("exp" in thickness)
    assert ("or one by a formula" in said.out + said.err) == ("exp" in thickness)
