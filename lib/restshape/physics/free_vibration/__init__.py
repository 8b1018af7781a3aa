"""Free vibrations of solids and plates."""
