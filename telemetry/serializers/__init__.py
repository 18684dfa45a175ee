"""Shapes of the app's requests and answers."""
