"""Materials that heat conduction knows by name, beside published diffusivities and the library that solids share."""

import pytest

from restshape.physics.cloth.sheet.cloth_material_keys import CLOTH_MATERIALS
from restshape.physics.elasticity.elasticity_material_keys import ELASTIC_MATERIALS, ElasticMaterial
from restshape.physics.heat.heat_declaration import HEAT, ThermalMaterial
from restshape.scene.materials import LIBRARY, library
from restshape.scene.scene_type import material_type

KNOWN = library("conductivity")


def conductor(**keys) -> ThermalMaterial:
    return material_type(ThermalMaterial, KNOWN).model_validate(keys)


@pytest.mark.parametrize("name", KNOWN)
def test_a_name_is_enough(name):
    found = conductor(name=name)
    assert found.conductivity > 0 and found.rho > 0 and found.specific_heat > 0
    # Solids store between 1 and 4.2 MJ/(m^3 K): by Dulong and Petit's law, and less in wood, which is mostly air.
    assert 0.7e6 < found.rho * found.specific_heat < 4.2e6
    assert len(KNOWN[name]["source"]) > 20


@pytest.mark.parametrize(
    ("name", "diffusivity"),
    [("copper", 117e-6), ("aluminium", 69e-6), ("brass", 34.1e-6), ("stainless steel", 3.95e-6)],
)
def test_diffusivities_are_those_of_a_textbook(name, diffusivity):
    """F. P. Incropera and others, Fundamentals of Heat and Mass Transfer, 6th edition, 2007, table A.1 (300 K): pure
    copper, cartridge brass, AISI 304; of 6061-T6 that of Metals Handbook's values."""
    found = conductor(name=name)
    assert found.conductivity / (found.rho * found.specific_heat) == pytest.approx(diffusivity, rel=0.12)


def test_solids_and_heat_share_one_library():
    assert set(KNOWN) >= {
        "steel",
        "stainless steel",
        "aluminium",
        "copper",
        "brass",
        "glass",
        "concrete",
        "timber",
        "PLA",
    }
    assert dict(HEAT.materials) == KNOWN and set(KNOWN) | set(ELASTIC_MATERIALS) | set(CLOTH_MATERIALS) == set(LIBRARY)
    for name in set(KNOWN) & set(ELASTIC_MATERIALS):
        assert (
            conductor(name=name).rho
            == material_type(ElasticMaterial, ELASTIC_MATERIALS).model_validate({"name": name}).rho
        )
    # Each knows what it has values of.
    assert "timber" not in ELASTIC_MATERIALS and "rosewood" not in KNOWN


def test_own_values_come_first():
    found = conductor(name="steel", conductivity="45 W/(m K)")
    assert (found.conductivity, found.specific_heat, found.rho) == (45.0, 450.0, 7850.0)
