"""From the picture of an object to a pneumatic bending actuator that mirrors its shape."""

__version__ = "0.1.0"
