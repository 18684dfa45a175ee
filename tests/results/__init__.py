"""Tests of what inspections found."""
