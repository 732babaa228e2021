"""A design to what a person looks at."""
