"""Fabrics by name: weight, membrane and bending by area are those of their sources, and what is given comes first."""

import numpy as np
import pytest

from restshape.physics.cloth.sheet.cloth_material_keys import CLOTH_MATERIALS, ClothMaterial
from restshape.physics.cloth.sheet.cloth_materials import bending, membrane
from restshape.scene.materials import FABRIC
from restshape.scene.scene_type import material_type

FABRICS = [name for name, values in CLOTH_MATERIALS.items() if FABRIC in values]

MEASURED = {
    "interlock": (0.187, (16.593832, 0.0, 34.477123, 36.860302), (23.191698, 24.749964, 14.267624)),
    "denim": (0.324, (205.352005, 10.234077, 1013.88629, 53.387184), (64.196457, 73.384567, 96.951576)),
    "trouser cloth": (0.220, (2016.55456, 9.170511, 2034.97644, 104.759674), (125.409805, 107.997696, 125.409805)),
    "polyester cloth": (0.128, (2002.08618, 0.345588, 2027.48559, 19.189022), (51.713814, 40.659470, 31.282822)),
}
"""Of Wang, O'Brien and Ramamoorthi 2011: kg/m^2, c11, c12, c22 and c33 [N/m], three of bending [1e-6 N m]."""


def fabric(**keys) -> ClothMaterial:
    return material_type(ClothMaterial, CLOTH_MATERIALS).model_validate(keys)


@pytest.mark.parametrize(
    ("name", "stiffness", "bent", "weight"), [("soft cloth", 10.0, 1e-8, 0.2), ("dress cloth", 20.0, 5e-6, 0.15)]
)
def test_two_are_those_of_the_thesis(name, stiffness, bent, weight):
    found = fabric(name=name)
    assert found.E * found.thickness == pytest.approx(stiffness)
    assert found.rho * found.thickness == pytest.approx(weight)
    assert bending(found)[0, 0] == pytest.approx(bent)


@pytest.mark.parametrize("name", MEASURED)
def test_four_are_as_they_were_measured(name):
    weight, (c11, c12, c22, c33), bent = MEASURED[name]
    found = fabric(name=name)
    wanted = np.array([[2 * c11, 2 * c12, 0], [2 * c12, 2 * c22, 0], [0, 0, c33]])
    assert membrane(found) == pytest.approx(wanted, rel=1e-3, abs=1e-9)
    assert np.diag(bending(found))[:2] == pytest.approx(1e-6 * np.mean(bent), rel=3e-3)
    assert found.rho * found.thickness == pytest.approx(weight)


@pytest.mark.parametrize("name", FABRICS)
def test_each_has_a_source_and_is_positive(name):
    found = fabric(name=name)
    assert len(str(CLOTH_MATERIALS[name]["source"])) > 20
    assert min(np.linalg.eigvalsh(sheet(found)).min() for sheet in (membrane, bending)) > 0.0


def test_any_key_comes_before_that_of_the_name():
    found = fabric(name="dress cloth", bending="2e-6 N m", rho="180 kg/m^3")
    assert bending(found)[0, 0] == pytest.approx(2e-6)
    assert (found.rho, found.E, found.thickness) == (180.0, 2e4, 1e-3)
