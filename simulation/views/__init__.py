"""API views of rehearsals and simulations."""
