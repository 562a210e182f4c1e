"""Layers to arrays and back: the only place that knows both."""
