"""Formulas of the place end in a message where their values are so large that squares of them are no numbers."""

import pytest
from small_scenes import PULLED, plate, write_scene


@pytest.mark.parametrize(
    ("formula", "says"),
    [
        ("1e59*x", ""),
        ("1e60*1e60*1e60*(1 + y)", "the expression is 1e+180, beyond 1e+60, at x = 2 m, y = 0 m"),
        ("-1e60^5*(1 + y)", "the expression is -1e+300, beyond 1e+60, at x = 2 m, y = 0 m"),
        ("1e60^6*(1 + y)", "the expression is not a finite number at x = 2 m, y = 0 m"),
    ],
)
def test_a_load_by_a_formula(command, tmp_path, formula, says):
    pulled = f'\n[loads.pull]\non = "right"\ntraction = ["{formula}", 0]\n'
    write_scene(tmp_path, plate(0.3).replace(PULLED, pulled))
    done = command("replay", "scene.toml", "--csv", "a.csv")
    assert "Traceback" not in done.stderr and "Warning" not in done.stderr
    if says:
        assert done.returncode != 0 and f"loads.pull.traction: {says}" in done.stderr
    else:
        assert done.returncode == 0 and "e+" in (tmp_path / "a.csv").read_text()
