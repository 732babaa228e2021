"""A silhouette or a vector profile to the curve that the tube can follow, in mm."""
