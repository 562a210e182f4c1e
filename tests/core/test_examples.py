"""The examples in the docstrings of the core."""

import doctest
import importlib
import inspect
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
    if name.startswith("isthmus.core.focus.") or name.split(".")[-1] in ("exact", "lagrangian"):
        pytest.importorskip("scipy")
    failed, _ = doctest.testmod(importlib.import_module(name), extraglobs={"np": np})
    assert not failed


def test_every_public_function_has_one():
    """Whatever the stage, one can try it."""
    finder = doctest.DocTestFinder(recurse=False)
    without = []
    for name in MODULES:
        module = importlib.import_module(name)
        for public in getattr(module, "__all__", ()):
            one = getattr(module, public)
            if inspect.isfunction(one) and not any(test.examples for test in finder.find(one)):
                without.append(f"{name}.{public}")
    assert not without
