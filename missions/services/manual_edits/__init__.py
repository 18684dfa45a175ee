"""Manually edited routes, and which edits are kept when the mission is planned again."""
