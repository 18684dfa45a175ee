"""Routes changed by hand, and what of the changes is kept when the mission is planned again."""
