"""Triangle meshes of outlines: generation, import, numbering, partition, motion, quality, transfer."""
