"""Make the repository root importable as package `isthmus`, whatever its folder is called."""

import importlib.util
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def _load(name, root, *more):
    init = root / "__init__.py"
    spec = importlib.util.spec_from_file_location(
        name, init, submodule_search_locations=[str(root), *map(str, more)]
    )
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    if init.exists():
        spec.loader.exec_module(package)
    return package


def pytest_addoption(parser):
    parser.addoption(
        "--engine", choices=("triangle", "pythoncdt", "shapely"),
        help="triangulate by this engine alone, as if no other were installed",
    )


def pytest_configure(config):
    engine = config.getoption("--engine")
    if engine:  # for the processes that tests start, too
        os.environ["ISTHMUS_ENGINE"] = engine
    pyproj = importlib.util.find_spec("pyproj")
    if pyproj and pyproj.origin.startswith("/usr/lib/"):  # Debian's looks for its data beside a venv's Python
        os.environ.setdefault("PROJ_DATA", "/usr/share/proj")


def pytest_sessionfinish(session, exitstatus):
    session.config.exit_status = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    # after some thousand tests QGIS 3.40 crashes when Python takes it down, with all told and written
    if "qgis.core" in sys.modules and hasattr(config, "exit_status"):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.exit_status)


if "isthmus" not in sys.modules:
    _load("isthmus", ROOT)


@pytest.fixture(scope="session")
def package():
    """The Python package as pip installs it, of the files here; by another name, for the plugin has its own."""
    name = "isthmus_package"
    return sys.modules.get(name) or _load(name, ROOT / "python", ROOT)


@pytest.fixture(scope="session")
def provider(qgis_app, qgis_processing):
    """The provider of the tools, registered."""
    from isthmus.algorithms.provider import IsthmusProvider
    from qgis.core import QgsApplication

    registry = QgsApplication.processingRegistry()
    provider = registry.providerById("isthmus")
    if provider is None:
        provider = IsthmusProvider()
        registry.addProvider(provider)
    yield provider


@pytest.fixture(scope="session")
def tool():
    """Load a script of tools/, which is no package, as a module: ``tool(name)``."""

    def tool(name):
        path = ROOT / "tools" / f"{name}.py"
        spec = importlib.util.spec_from_file_location(f"isthmus_tools_{name}", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return tool
