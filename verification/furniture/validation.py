"""Validation cases of furniture: statics and deflection by hand, redundant joints, derivatives, a range."""

from restshape_studies.validation.case import Case
from restshape_verification.furniture.validation_bending import lifted_foot, max_deflection
from restshape_verification.furniture.validation_guidance import range_ends, taylor
from restshape_verification.furniture.validation_loops import compliance, indeterminate
from restshape_verification.furniture.validation_statics import (
    cantilever_moment,
    incline,
    leaning,
    nail_cantilever,
    tipping,
    tripod,
    two_supports,
)

CASES: dict[str, Case] = {
    "two_supports": two_supports,
    "cantilever": cantilever_moment,
    "tripod": tripod,
    "leaning": leaning,
    "tipping": tipping,
    "incline": incline,
    "nail_cantilever": nail_cantilever,
    "sag": max_deflection,
    "lifted_foot": lifted_foot,
    "indeterminate": indeterminate,
    "compliance": compliance,
    "taylor": taylor,
    "range_ends": range_ends,
}
