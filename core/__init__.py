"""The solver: numpy and shapely, never QGIS."""
