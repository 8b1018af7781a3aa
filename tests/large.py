"""Small scenes of large deformation for tests."""

from functools import partial

from restshape_studies.stability import rubber

LARGE, WALL, solid, gravity = rubber.LARGE, rubber.WALL, rubber.solid, rubber.gravity
beam = partial(rubber.beam, "plane")
