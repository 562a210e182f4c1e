"""The scripts of tools/, which are no package, as modules."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def load(name):
    path = ROOT / "tools" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"isthmus_tools_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def check_plugin():
    return load("check_plugin")


@pytest.fixture(scope="session")
def check_qt6(qgis_app):
    return load("check_qt6")
