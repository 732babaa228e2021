"""Files on a disk: read safely, written whole."""
