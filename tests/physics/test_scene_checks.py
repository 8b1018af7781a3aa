"""What a scene of solids is refused for before anything is solved."""

import pytest
from small_scenes import plate, write_scene

from restshape.errors import UserError
from restshape.scene.load import load_scene


@pytest.mark.parametrize(
    ("quantity", "where", "what"),
    [
        ("{ frequency = 1 }", "quantities.tone", "without modes there are no frequencies"),
        ("{ mode = 2 }", "quantities.tone", "only free vibrations have frequencies"),
        ('{ cents = "C5", mode = 2 }', "quantities.tone", "only free vibrations have tones"),
        ("{ ratio = 2 }", "quantities.tone", "only free vibrations have tones"),
        ("{ load_factor = 1 }", "quantities.tone.load_factor", "without buckling there are no load factors"),
    ],
)
def test_quantities_of_modes_are_refused(tmp_path, quantity, where, what):
    path = write_scene(tmp_path, plate().replace("[quantities]", f"[quantities]\ntone = {quantity}"))
    with pytest.raises(UserError, match=what) as caught:
        load_scene(path)
    assert where in caught.value.where and "leave it out" in caught.value.do


def test_load_factors_are_known_with_buckling(tmp_path):
    text = plate().replace("[quantities]", "[quantities]\nlowest = { load_factor = 1 }") + "[effects.buckling]\n"
    assert load_scene(write_scene(tmp_path, text)).quantities["lowest"].load_factor == 1
