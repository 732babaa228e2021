"""Rubbers: presets with their sources, and fits to test data."""
