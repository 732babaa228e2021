"""Models of bending: from a chain of joints and a pressure to a bent shape."""
