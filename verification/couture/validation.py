"""Validation cases of cloth in equilibrium: what hangs, bends, buckles, sticks and slips."""

from restshape_studies.validation.case import Case
from restshape_verification.couture.validation_bodies import capstan_mesh, incline_mesh, mesh_ball, winding
from restshape_verification.couture.validation_buckling import blade
from restshape_verification.couture.validation_cantilever import (
    cantilever,
    cantilever_derivative,
    hinged_cantilever,
    wide_cantilever,
)
from restshape_verification.couture.validation_darts import sewn_dart
from restshape_verification.couture.validation_derivatives import drape_identities
from restshape_verification.couture.validation_folds import folded_twice
from restshape_verification.couture.validation_friction import capstan, incline
from restshape_verification.couture.validation_hanging import catenary, hanging
from restshape_verification.couture.validation_layers import folded_strip, two_sheets
from restshape_verification.couture.validation_meshes import meshes
from restshape_verification.couture.validation_plates import plates
from restshape_verification.couture.validation_seams import sewn_cylinder, sewn_loop
from restshape_verification.couture.validation_sewn_panels import gathered, seam_tension, sewn_cone, sewn_refined

CASES: dict[str, Case] = {
    "catenary": catenary,
    "hanging": hanging,
    "cantilever": cantilever,
    "cantilever_derivative": cantilever_derivative,
    "drape_identities": drape_identities,
    "wide_cantilever": wide_cantilever,
    "hinged_cantilever": hinged_cantilever,
    "plates": plates,
    "blade": blade,
    "incline": incline,
    "capstan": capstan,
    "meshes": meshes,
    "incline_mesh": incline_mesh,
    "capstan_mesh": capstan_mesh,
    "mesh_ball": mesh_ball,
    "winding": winding,
    "folded_strip": folded_strip,
    "two_sheets": two_sheets,
    "folded_twice": folded_twice,
    "sewn_loop": sewn_loop,
    "sewn_cylinder": sewn_cylinder,
    "sewn_dart": sewn_dart,
    "sewn_cone": sewn_cone,
    "seam_tension": seam_tension,
    "sewn_refined": sewn_refined,
    "gathered": gathered,
}
