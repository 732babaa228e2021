"""Drawings: DXF, SVG and CSV read to one profile in mm."""
