"""Registries through which later apps supply facts to missions without being imported."""
