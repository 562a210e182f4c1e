"""The tool that enlarges a region of a map."""
