"""What live sessions show of furniture as quantities: columns with their limits."""

from restshape.application import applications
from restshape.live.frame_header import limits_of_columns
from restshape.live.welcome import quantities_said
from restshape.scene.load import load_scene

SCENES = applications()["furniture"].folder / "scenes"


def test_columns_are_quantities_with_limits():
    scene = load_scene(SCENES / "table.toml")
    said = {one["name"]: one for one in quantities_said(scene)}
    assert said["utilisation"]["limitHigh"] == 1.0 and said["stability_margin"]["limitLow"] == 0.0
    assert ("deflection" in said) == ("bending" in scene.effects)
    row = {"utilisation": 1.25, "stability_margin": 0.2, "refused": "", "findings": ""}
    found = limits_of_columns(row, scene)
    assert found["utilisation"] == "fails" and found["stability_margin"] == "holds"
    assert limits_of_columns(row | {"refused": "no"}, scene) == {}
    assert "utilisation" not in limits_of_columns(row | {"utilisation": float("nan")}, scene)
