"""Partitioning polygons via graph augmentation: the solver, stage by stage."""

from .solve import Partition, partition

__all__ = ["Partition", "partition"]
