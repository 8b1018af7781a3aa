"""Panels: cut on the fold, with darts and pleats, placed in space or wrapped about bodies."""
