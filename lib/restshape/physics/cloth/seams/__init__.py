"""Seams: the lines that they join, their springs, bending across them, pleats, and what they may not be."""
