"""Physics: one module an effect; which unknowns it adds, which element residuals, which loads."""
