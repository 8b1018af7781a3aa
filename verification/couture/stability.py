"""The hard cases of cloth, by name."""

from restshape_studies.stability.case import Case
from restshape_verification.couture.stability_bodies import CASES as BODIES
from restshape_verification.couture.stability_contact import CASES as CONTACT
from restshape_verification.couture.stability_darts import CASES as DARTS
from restshape_verification.couture.stability_edits import CASES as EDITS
from restshape_verification.couture.stability_fabrics import CASES as FABRICS
from restshape_verification.couture.stability_folds import CASES as FOLDS
from restshape_verification.couture.stability_garments import CASES as GARMENTS
from restshape_verification.couture.stability_layers import CASES as LAYERS
from restshape_verification.couture.stability_meshes import CASES as MESHES
from restshape_verification.couture.stability_predicted import CASES as PREDICTED
from restshape_verification.couture.stability_seams import CASES as SEAMS
from restshape_verification.couture.stability_starts import CASES as STARTS
from restshape_verification.couture.stability_trust import CASES as TRUST

CASES: dict[str, Case] = {
    **STARTS,
    **FABRICS,
    **BODIES,
    **MESHES,
    **CONTACT,
    **LAYERS,
    **FOLDS,
    **SEAMS,
    **GARMENTS,
    **DARTS,
    **EDITS,
    **PREDICTED,
    **TRUST,
}
