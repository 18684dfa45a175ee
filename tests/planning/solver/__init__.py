"""Tests of assignment and order."""
