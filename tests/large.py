"""Small scenes of large deformation for tests, which hard cases have too."""

from restshape_verification.solid.hard_scenes import LARGE, RUBBER, TIP, WALL, beam, gravity, solid

__all__ = ["LARGE", "RUBBER", "TIP", "WALL", "beam", "gravity", "solid"]
