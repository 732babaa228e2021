"""Verification: designs as finite-element models, run and compared."""
