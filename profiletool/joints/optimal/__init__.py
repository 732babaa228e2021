"""The optimal choice of joints: dynamic programming, then polishing."""
