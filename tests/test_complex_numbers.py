"""A PETSc that is built with complex numbers is refused where it starts, with what to do."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape.errors import UserError
from restshape.surroundings import start_petsc


def test_a_petsc_with_complex_numbers_is_refused(monkeypatch):
    start_petsc()
    monkeypatch.setattr(PETSc, "ScalarType", np.complex128)
    with pytest.raises(UserError, match=r"complex numbers(.|\n)*PETSC_ARCH"):
        start_petsc()
