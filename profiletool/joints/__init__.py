"""Joints of an actuator for a profile, by either method, and the objective they are chosen by."""
