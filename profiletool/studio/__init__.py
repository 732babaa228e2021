"""The studio: a page on this machine on which a design is made, seen and changed."""
