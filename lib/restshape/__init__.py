"""restshape: simulates an object while its rest shape is being edited."""

__version__ = "0.1.0"
