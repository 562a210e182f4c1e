"""Tests of the solver; they run where QGIS is not installed."""
