"""What leaves the program for a workshop: engraved drawings with holes for a cord, a sheet of a bar, and its sound."""
