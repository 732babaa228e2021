"""Frozen records that pass from stage to stage."""
