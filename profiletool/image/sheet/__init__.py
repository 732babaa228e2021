"""The printed sheet: perspective, lens and parallax taken out of a photograph."""
