"""Free vibrations: matrices, modes and their errors, modes that are followed from frame to frame, and tones."""
