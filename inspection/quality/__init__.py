"""Finds where the data of the ground looks wrong: one small detector per kind of issue, and what each issue cuts off."""
