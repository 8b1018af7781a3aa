"""The edited shape of a frame, its mesh and its fields as files of other programs, and as a scene."""
