"""The sheet by itself: membrane, bending, weight, material, supports of its unknowns, and its estimated error."""
