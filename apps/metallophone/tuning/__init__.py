"""Tuning a bar: the smallest change of its shape that brings it to a tone."""
