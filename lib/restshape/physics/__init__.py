"""Physics: a folder a physics; which unknowns it adds, which element residuals, which loads."""
