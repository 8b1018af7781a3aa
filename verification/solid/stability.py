"""The hard cases of solids at rest, by name."""

from restshape_apps.solid.stability_buckling import CASES as BUCKLING
from restshape_apps.solid.stability_columns import CASES as COLUMNS
from restshape_apps.solid.stability_large import CASES as LARGE
from restshape_apps.solid.stability_mesh import CASES as MESHES
from restshape_apps.solid.stability_static import CASES as STATIC

from restshape.stability.case import Case

CASES: dict[str, Case] = {
    **STATIC,
    **MESHES,
    **LARGE,
    **COLUMNS,
    **{f"buckling_{name}": case for name, case in BUCKLING.items()},
}
