"""The silhouette search: from a photograph to the outline of its one object."""
