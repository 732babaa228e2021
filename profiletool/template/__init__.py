"""A design to the flat cut sheet of its gauze; the only room that writes DXF."""
