"""The hard cases of static solids, by name."""

from restshape_studies.stability.case import Case
from restshape_verification.solid.stability_buckling import CASES as BUCKLING
from restshape_verification.solid.stability_columns import CASES as COLUMNS
from restshape_verification.solid.stability_large import CASES as LARGE
from restshape_verification.solid.stability_mesh import CASES as MESHES
from restshape_verification.solid.stability_reach import CASES as REACH
from restshape_verification.solid.stability_static import CASES as STATIC

CASES: dict[str, Case] = {
    **STATIC,
    **MESHES,
    **LARGE,
    **COLUMNS,
    **{f"reach_{name}": case for name, case in REACH.items()},
    **{f"buckling_{name}": case for name, case in BUCKLING.items()},
}
