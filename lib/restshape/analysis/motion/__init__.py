"""Motion in time: implicit steps, linear and nonlinear, harmonic response, and fields brought to new meshes."""
