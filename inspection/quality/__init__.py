"""Finds where the data of the ground looks wrong: one small detector per kind of gap, and what each gap cuts off."""
