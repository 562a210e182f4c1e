"""The examples in the docstrings of the core."""

import doctest
import importlib
import pkgutil

import isthmus.core
import numpy as np
import pytest

MODULES = sorted(
    name
    for _, name, is_package in pkgutil.walk_packages(isthmus.core.__path__, "isthmus.core.")
    if not is_package
)


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    failed, _ = doctest.testmod(importlib.import_module(name), extraglobs={"np": np})
    assert not failed


def test_there_are_some():
    """Whatever the stage, one can try it."""
    finder = doctest.DocTestFinder(exclude_empty=True)
    count = {
        name: sum(bool(test.examples) for test in finder.find(importlib.import_module(name)))
        for name in MODULES
    }
    for stage in (
        "rings",
        "partition.solve",
        "partition.polygon",
        "partition.dual_tree",
        "partition.carving",
        "partition.hierarchy",
        "partition.min_weight",
    ):
        assert count[f"isthmus.core.{stage}"], stage
