"""Studies: what measures accuracy, speed, stability and prices of scenes, and the commands that show it."""
