"""Experiments on the shipped programs, each a program of its own: python -m tests.chaos.experiments.NAME --row ROW [--seed N] [--short]."""
