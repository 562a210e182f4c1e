"""The QGIS side: Processing tools, thin over the core."""
