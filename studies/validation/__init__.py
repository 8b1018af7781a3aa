"""Validation: computed values beside references that restshape did not compute."""
