"""The theta(alpha, openF, P) of a joint: formula, table, look-up and inverse."""
