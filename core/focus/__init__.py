"""Variable-scale maps: enlarge a region, keep the shape of the rest (section 5.1 of the paper)."""
