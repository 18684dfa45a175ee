"""How ./check runs its steps and judges what the tests report."""
