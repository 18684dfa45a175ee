"""One candidate plan: the solver's problem, the assignment, and why targets are left out of it."""
