"""The subject of a design: a picture or drawing, its scale and its profile."""
