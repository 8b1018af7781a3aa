"""The hard cases of cloth, by name."""

from restshape_apps.couture.stability_bodies import CASES as BODIES
from restshape_apps.couture.stability_edits import CASES as EDITS
from restshape_apps.couture.stability_fabrics import CASES as FABRICS
from restshape_apps.couture.stability_starts import CASES as STARTS

from restshape.stability.case import Case

CASES: dict[str, Case] = {**STARTS, **FABRICS, **BODIES, **EDITS}
