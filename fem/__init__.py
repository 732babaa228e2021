"""Finite elements of the actuator; numpy and scipy only."""
