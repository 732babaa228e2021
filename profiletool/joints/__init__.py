"""A profile to the joints of an actuator, and the actuator's shape."""
