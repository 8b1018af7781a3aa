"""Work-precision studies: what accuracy costs in time, for any scene."""
