"""How drapes follow the pattern, the bodies and the numbers of a scene: derivatives of an equilibrium of cloth."""
