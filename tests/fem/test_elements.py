"""Elements as symbols: what they say of themselves, and that a typo does not import."""

import importlib

import pytest

from restshape import _kernels
from restshape.fem import elements
from restshape.fem.elements import LINEAR_ELASTIC, OSEEN, STOKES, STVK


def test_every_compiled_element_has_a_symbol():
    named = {element.name for family in elements.families().values() for element in family.values()}
    assert named == set(_kernels.element_names())
    for symbol, family in elements.families().items():
        assert list(getattr(elements, symbol)) == list(family)


def test_an_element_knows_its_sizes_and_names():
    element = LINEAR_ELASTIC["tri6"]
    assert (element.name, element.family, element.shape) == ("linear_elastic_tri6", "linear_elastic", "tri6")
    assert (element.nodes, element.dim, element.fields, element.dof_nodes) == (6, 2, 2, 6)
    assert element.parameters == ("lambda", "mu", "thickness", "bx", "by")
    assert element.symmetric and element.layout == () and element.coefficients == ()
    assert sorted(STVK) == ["tet10", "tet4", "tri3", "tri6"]


def test_fields_on_different_nodes_are_a_layout():
    element = STOKES["tri6"]
    assert element.layout == (("velocity", 6, 2), ("pressure", 3, 1))
    assert (element.nodes, element.fields, element.dof_nodes) == (6, 1, 15)
    assert OSEEN["tri6"].coefficients == ("wx", "wy") and not OSEEN["tri6"].symmetric


def test_a_typo_is_an_import_error_that_names_the_nearest():
    with pytest.raises(ImportError, match=r"LINEAR_ELASTICK: did you mean LINEAR_ELASTIC\?"):
        exec("from restshape.fem.elements import LINEAR_ELASTICK")
    module = importlib.import_module("restshape.fem.elements")
    with pytest.raises(ImportError, match=r"STVKK: did you mean STVK\?"):
        _ = module.STVKK
    with pytest.raises(ImportError, match="ZZZ; `families` gives all"):
        _ = module.ZZZ
    with pytest.raises(AttributeError):
        _ = module.nothing


def test_a_missing_shape_says_which_there_are():
    with pytest.raises(KeyError, match="tri3, tri6, tet4, tet10"):
        LINEAR_ELASTIC["quad4"]
