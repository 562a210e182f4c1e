"""The tools that cut polygons."""
