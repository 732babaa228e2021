"""Reports: the pictures, tables and pages that show a design to a person."""
