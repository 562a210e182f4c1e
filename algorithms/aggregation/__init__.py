"""The tools that aggregate areas."""
