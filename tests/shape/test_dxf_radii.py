"""Circles and arcs of drawings whose radius is no length are refused, with their layer."""

import ezdxf
import pytest

from restshape.errors import UserError
from restshape.shape.drawings.dxf import read_dxf


@pytest.mark.parametrize("radius", [8.0, -8.0, float("nan"), float("inf")])
@pytest.mark.parametrize("arc", [False, True])
def test_radii_that_are_none(tmp_path, radius, arc):
    drawing = ezdxf.new(units=4)
    place, look = drawing.modelspace(), {"layer": "bore"}
    place.add_arc((30, 25), radius, 0, 90, dxfattribs=look) if arc else place.add_circle((30, 25), radius, look)
    drawing.saveas(tmp_path / "part.dxf")
    if radius == 8.0:
        assert read_dxf(tmp_path / "part.dxf").curves
        return
    with pytest.raises(UserError, match=f"on layer bore: a radius of {radius:g} is none"):
        read_dxf(tmp_path / "part.dxf")
