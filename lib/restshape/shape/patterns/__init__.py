"""Sewing patterns of other programs: read from GarmentCode, DXF and SVG, and what drawings keep of them."""
