"""The applications of restshape: each composes the library and names its quantities of interest."""
