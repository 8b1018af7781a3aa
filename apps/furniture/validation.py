"""Validation cases of furniture: statics by hand, redundant joints, derivatives, ranges, suggestions."""

from restshape_apps.furniture.validation_guidance import missed, range_ends, taylor
from restshape_apps.furniture.validation_loops import compliance, indeterminate
from restshape_apps.furniture.validation_statics import (
    cantilever_moment,
    incline,
    leaning,
    nail_cantilever,
    tipping,
    tripod,
    two_supports,
)

from restshape.validation.case import Case

CASES: dict[str, Case] = {
    "two_supports": two_supports,
    "cantilever": cantilever_moment,
    "tripod": tripod,
    "leaning": leaning,
    "tipping": tipping,
    "incline": incline,
    "nail_cantilever": nail_cantilever,
    "indeterminate": indeterminate,
    "compliance": compliance,
    "taylor": taylor,
    "range_ends": range_ends,
    "missed": missed,
}
