"""Make the repository root importable as package `isthmus`, whatever its folder is called."""

import importlib.util
import os
import shutil
import subprocess
import sys
import threading
import time
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
        "--engine",
        choices=("triangle", "pythoncdt", "shapely"),
        help="triangulate by this engine alone, as if no other were installed",
    )


def pytest_configure(config):
    engine = config.getoption("--engine")
    if engine:  # for the processes that tests start, too
        os.environ["ISTHMUS_ENGINE"] = engine
    pyproj = importlib.util.find_spec("pyproj")
    if pyproj and pyproj.origin.startswith("/usr/lib/"):  # Debian's looks for its data beside a venv's Python
        os.environ.setdefault("PROJ_DATA", "/usr/share/proj")


class Pulse(threading.Thread):
    """Says that the tests go on, and how far they are, where none has ended for a while."""

    def __init__(self, reporter):
        super().__init__(daemon=True)
        self.reporter, self.ended, self.done = reporter, threading.Event(), 0
        self.began = self.said = time.monotonic()
        self.dots = False  # behind which a line begins
        self.tick = float(os.environ.get("ISTHMUS_TICK", 10))

    def pytest_runtest_logreport(self, report):
        self.done += report.when == "teardown"
        self.said, self.dots = time.monotonic(), True

    def run(self):
        while not self.ended.wait(self.tick / 10):
            now = time.monotonic()
            if now - self.said >= self.tick:
                line = f"isthmus: {self.done} tests done, {now - self.began:.0f} s"
                self.reporter.write_line("\n" * self.dots + line)
                self.reporter.flush()  # also into a pipe, which keeps a page of text back
                self.said, self.dots = now, False


def pytest_sessionstart(session):
    config = session.config
    if not hasattr(config, "workerinput"):  # the process that shows, not one that tests for it
        config.pulse = Pulse(config.pluginmanager.get_plugin("terminalreporter"))
        config.pluginmanager.register(config.pulse)
        config.pulse.start()


def pytest_sessionfinish(session, exitstatus):
    if hasattr(session.config, "pulse"):
        session.config.pulse.ended.set()
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
def qgis_process(tmp_path_factory):
    """Run the real qgis_process with this plugin, in a profile of its own: ``qgis_process("run", ...)``.

    It returns what was printed, of one that ``fails`` the errors as well.
    """
    program = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
    if not program:
        pytest.skip("no qgis_process on this machine")
    import shapely

    home = tmp_path_factory.mktemp("qgis_process")
    (home / "plugins").mkdir()
    (home / "plugins" / "isthmus").symlink_to(ROOT)
    (home / "runtime").mkdir(mode=0o700)
    environment = {
        **os.environ, "QT_QPA_PLATFORM": "offscreen", "QGIS_PLUGINPATH": str(home / "plugins"),
        "QGIS_CUSTOM_CONFIG_PATH": str(home / "profile"), "XDG_RUNTIME_DIR": str(home / "runtime"),
        "PYTHONPATH": str(Path(shapely.__file__).parents[1]),  # the packages of this environment
    }  # fmt: skip

    def qgis_process(*words, fails=False, folder=None):
        done = subprocess.run(
            [program, *map(str, words)], env=environment, cwd=folder, stdin=subprocess.DEVNULL,
            capture_output=True, encoding="utf-8",
        )  # fmt: skip
        assert (done.returncode != 0) == fails, done.stdout + done.stderr
        return done.stdout + done.stderr * fails

    assert "Enabled" in qgis_process("plugins", "enable", "isthmus")
    return qgis_process


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
