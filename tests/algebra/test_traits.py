"""Preconditioners are chosen by what a problem declares of its matrices."""

from restshape.algebra.choice import PLANE, SPACE, candidates
from restshape.algebra.traits import Traits


def test_candidates_follow_the_declared_dimension_and_not_the_fields():
    assert candidates(Traits(fields=1)) == candidates(Traits(fields=3)) == PLANE
    assert candidates(Traits(fields=1, dimension=3)) == SPACE


def test_without_candidates_there_is_a_complete_factor_that_fits():
    for traits in (Traits(symmetric=False), Traits(definite=False)):
        assert candidates(traits) == ()
    assert (Traits().factor, Traits().krylov) == ("cholesky", "cg")
    assert (Traits(symmetric=False).factor, Traits(symmetric=False).krylov) == ("lu", "gmres")
