"""The compiled core of the planners: its location, and warm-up of programs."""
