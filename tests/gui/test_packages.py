"""Packages that are missing are fetched from the registry into the profile, for real; and what is said if that fails."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from isthmus.algorithms import dependencies, packages

ROOT = Path(__file__).resolve().parents[2]
QGIS_PROCESS = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
ROOMS = "POLYGON((0 0,10 0,10 4.5,12 4.5,12 0,22 0,22 10,12 10,12 5.5,10 5.5,10 10,0 10,0 0))"


# --- which wheel ------------------------------------------------------------------------------------


@pytest.mark.parametrize("tag, system, machine, release, fits", [
    ("manylinux_2_28_x86_64", "linux", "x86_64", (2, 36), True),
    ("manylinux_2_28_x86_64", "linux", "x86_64", (2, 27), False),
    ("manylinux2014_x86_64", "linux", "x86_64", (2, 17), True),
    ("manylinux2014_aarch64", "linux", "x86_64", (2, 36), False),
    ("musllinux_1_2_x86_64", "linux", "x86_64", (2, 36), False),
    ("win_amd64", "win32", "AMD64", None, True),
    ("win_arm64", "win32", "AMD64", None, False),
    ("macosx_11_0_arm64", "darwin", "arm64", (14, 1), True),
    ("macosx_15_0_arm64", "darwin", "arm64", (14, 1), False),
    ("macosx_10_9_universal2", "darwin", "x86_64", (10, 15), True),
    ("macosx_10_9_x86_64", "darwin", "arm64", (14, 1), False),
    ("any", "win32", "ARM64", None, True),
])  # fmt: skip
def test_platforms(tag, system, machine, release, fits):
    assert packages.fits_platform(tag, system=system, machine=machine, release=release) is fits


def test_python_tags():
    own = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    assert packages.fits_tags(own, own, "any") and packages.fits_tags("py3", "none", "any")
    assert packages.fits_tags("cp38", "abi3", "any") and not packages.fits_tags("cp399", "abi3", "any")
    assert not packages.fits_tags(own, own + "t", "any") and not packages.fits_tags("cp27", "cp27mu", "any")


def test_specifications_are_read_as_pip_reads_them():
    from packaging.specifiers import SpecifierSet

    versions = ["1.21", "1.23.5", "1.24", "1.24.2", "2.0", "2.0.1", "2.4.0", "3.13.1"]
    for text in (
        "",
        ">=1.23.5,<2.5",
        "<2.8,>=2.0.0",
        "!=1.24.*,>=1.21",
        "~=1.23",
        "==2.0",
        ">1.24, <=2.0.1",
        "!=2.0.1",
    ):
        for version in versions:
            assert packages.accepts(text, version) == (version in SpecifierSet(text)), (text, version)


class Registry:
    """A registry in memory."""

    def __init__(self, numpy_of):
        self.files, self.asked = {}, []
        own = f"cp{sys.version_info[0]}{sys.version_info[1]}"
        import hashlib
        import io

        for version, needs in numpy_of.items():
            for name in (f"made-{version}-{own}-{own}-any.whl", f"made-{version}-cp27-cp27m-any.whl"):
                stream = io.BytesIO()
                with zipfile.ZipFile(stream, "w") as archive:
                    archive.writestr("made/__init__.py", f"version = {version!r}\n" + "# long\n" * 40_000)
                    archive.writestr(
                        f"made-{version}.dist-info/METADATA",
                        f"Name: made\nRequires-Dist: {needs}\nRequires-Dist: pytest; extra == 'test'\n\ntext",
                    )
                data = stream.getvalue()
                self.files[name] = data, hashlib.sha256(data).hexdigest()

    def get(self, url, headers=None):
        self.asked.append((url, dict(headers or {})))
        if url.endswith("/"):
            return json.dumps({"files": [
                {"filename": name, "url": f"https://files.test/{name}", "hashes": {"sha256": sha}, "size": len(data)}
                for name, (data, sha) in self.files.items()
            ]}).encode()  # fmt: skip
        data = self.files[url.rsplit("/", 1)[1]][0]
        if "Range" in (headers or {}):
            lo, hi = map(int, headers["Range"][6:].split("-"))
            return data[lo : hi + 1]
        return data


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "folder", lambda: tmp_path / "isthmus")
    before = list(sys.path)
    yield tmp_path / "isthmus"
    sys.path[:] = before
    sys.modules.pop("made", None)


def test_the_newest_that_goes_with_this_numpy(place):
    registry = Registry(
        {
            "1.0": "numpy>=1.20",
            "1.9": "numpy (>=1.23)",
            "1.10": "numpy<2",
            "2.0": "numpy>=1.26",
            "2.1rc1": "numpy",
            "2.2": "numpy===odd",  # of a form that is not understood: as if it did not fit
        }
    )
    assert packages.find("made", "1.24.2", registry.get).version == "1.10"
    assert packages.find("made", "2.1.0", registry.get).version == "2.0"
    # only a piece of each wheel was fetched
    assert all("Range" in headers for url, headers in registry.asked if url.endswith(".whl"))
    with pytest.raises(packages.PackageError, match="no wheel of made"):
        packages.find("made", "1.24.2", Registry({"1.0": "numpy>=2"}).get)
    with pytest.raises(packages.PackageError, match="no wheel of made"):
        packages.find("made", "1.24.2", Registry({"1.0": "somethingelse"}).get)


def test_install_and_undo(place):
    said = []
    packages.install(["made"], "1.24.2", said.append, get=Registry({"1.0": "numpy"}).get)
    import made

    assert made.version == "1.0" and Path(made.__file__).parent.parent == place
    assert packages.installed() == ["made 1.0"] and len(said) == 2 and "made-1.0" in said[0]
    assert packages.remove() and not place.exists() and str(place) not in sys.path


def test_what_comes_damaged_is_not_unpacked(place):
    registry = Registry({"1.0": "numpy"})
    name = next(iter(registry.files))
    registry.files[name] = registry.files[name][0], "0" * 64
    with pytest.raises(packages.PackageError, match="checksum"):
        packages.install(["made"], "1.24.2", print, get=registry.get)
    assert not place.exists()


def test_what_windows_holds_goes_at_the_next_start(place, monkeypatch):
    packages.install(["made"], "1.24.2", str, get=Registry({"1.0": "numpy"}).get)
    with monkeypatch.context() as patch:
        patch.setattr(shutil, "rmtree", lambda *a, **b: (_ for _ in ()).throw(PermissionError()))
        assert not packages.remove() and place.exists()
    packages.activate()
    assert not place.exists() and str(place) not in sys.path


# --- the hint ---------------------------------------------------------------------------------------


def test_hint_names_the_running_python(monkeypatch, tmp_path):
    assert Path(dependencies.python_program()).name.startswith("python")
    (tmp_path / "MacOS" / "bin").mkdir(parents=True)
    (tmp_path / "MacOS" / "bin" / "python3").touch()
    qgis = tmp_path / "MacOS" / "QGIS"
    assert dependencies.python_program(executable=str(qgis), prefix="/nowhere", system="darwin") == str(
        tmp_path / "MacOS/bin/python3"
    )
    (tmp_path / "apps").mkdir()
    (tmp_path / "apps" / "python3.exe").touch()
    found = dependencies.python_program(
        executable=str(tmp_path / "bin" / "qgis-bin.exe"), prefix=str(tmp_path / "apps"), system="win32"
    )
    assert found == str(tmp_path / "apps" / "python3.exe")


def test_hint_where_there_is_no_pip(monkeypatch):
    import importlib.util

    real = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "pip" else real(name, *more)
    )
    monkeypatch.setattr(shutil, "which", lambda name: "/usr/bin/apt-get")
    assert "apt install python3-pip" in dependencies.install_hint("1.24.2")
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert "ensurepip" in dependencies.install_hint("1.24.2")


def test_hint_of_old_python_and_of_conda(monkeypatch, tmp_path):
    monkeypatch.setattr(dependencies.sys, "version_info", (3, 9, 5))
    monkeypatch.setattr(dependencies, "engines_with_wheels", lambda: ["triangle"])
    hint = dependencies.install_hint("1.20.1")
    assert '"shapely>=2.0" triangle' in hint and "commercial" in hint
    monkeypatch.undo()
    assert " --user" in dependencies.install_hint("1.24.2")
    (tmp_path / "conda-meta").mkdir()
    monkeypatch.setattr(dependencies.sys, "prefix", str(tmp_path))
    hint = dependencies.install_hint("1.24.2")
    assert " --user" not in hint and "--break" not in hint


# --- for real ---------------------------------------------------------------------------------------


@pytest.fixture
def online():
    import socket

    try:
        socket.create_connection(("pypi.org", 443), timeout=5).close()
    except OSError as error:
        if not any(os.environ.get(name) for name in ("https_proxy", "HTTPS_PROXY")):
            pytest.skip(f"no network: pypi.org cannot be reached ({error})")


def test_no_network_is_said_in_a_sentence(place, qgis_app):
    with pytest.raises(packages.PackageError, match="cannot be reached.*Nothing was changed.*network"):
        packages.install(
            ["shapely"],
            "1.24.2",
            print,
            get=lambda url, headers=None: packages.fetch(url.replace("pypi.org", "nowhere.invalid"), headers),
        )
    assert not place.exists()


CLEAN = """
import os, sys
from qgis.core import QgsApplication
app = QgsApplication([], False)
app.initQgis()
sys.path.insert(0, sys.argv[1])
sys.path.append("/usr/share/qgis/python/plugins")
import isthmus
plugin = isthmus.classFactory(None)
from isthmus.algorithms import packages
from isthmus.algorithms.dependencies import dependency_problem
import numpy
before = dependency_problem()
names = packages.missing()
if not before:
    print("HAD all that is needed")
elif names:
    packages.install(names, numpy.__version__, print)
import shapely
assert not dependency_problem(), dependency_problem()
print("NUMPY", numpy.__version__, numpy.__file__)
print("MISSING", *names)
print("SHAPELY", shapely.__version__, shapely.__file__)
"""


@pytest.mark.skipif(not QGIS_PROCESS, reason="no qgis_process on this machine")
def test_a_clean_profile_gets_its_packages_and_runs(tmp_path, online):
    """As for a user without any: from the registry, by a Python that sees the distribution's packages only."""
    (tmp_path / "plugins").mkdir()
    (tmp_path / "plugins" / "isthmus").symlink_to(ROOT)
    environment = {
        **os.environ, "QGIS_CUSTOM_CONFIG_PATH": str(tmp_path / "profile"), "QGIS_PLUGINPATH": str(tmp_path / "plugins"),
    }  # fmt: skip
    shared = "/usr/share/qgis/python"
    environment["PYTHONPATH"] = shared if os.path.isdir(f"{shared}/qgis") else ""
    script = tmp_path / "clean.py"
    script.write_text(CLEAN)

    def call(*words):
        done = subprocess.run(
            words, env=environment, cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8",
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def said(text):
        return {line.split()[0]: line.split()[1:] for line in text.splitlines() if line[:1].isupper()}

    first = said(call("/usr/bin/python3", str(script), str(tmp_path / "plugins")))
    if "HAD" in first:
        pytest.skip("this distribution has the packages itself")
    assert {"shapely", "pythoncdt"} <= set(first["MISSING"]) and "numpy" not in first["MISSING"]
    assert first["SHAPELY"][1].startswith(str(tmp_path / "profile"))
    assert "profile" not in first["NUMPY"][1]
    assert not list((tmp_path / "profile").rglob("numpy-*"))
    # and from then on, in qgis_process too
    call(QGIS_PROCESS, "plugins", "enable", "isthmus")
    (tmp_path / "rooms.csv").write_text(f'id,wkt\n1,"{ROOMS}"\n')
    answer = call(
        QGIS_PROCESS, "run", "--json", "isthmus:partition", "--", f"INPUT={tmp_path / 'rooms.csv'}",
        "SMALLEST_PART=0", "PLACES=1", f"OUTPUT={tmp_path / 'parts.gpkg'}",
    )  # fmt: skip
    assert json.loads(answer[answer.index("{") :])["results"]["PART_COUNT"] == 3


def test_the_dialog_installs_and_undoes(iface, wait, place, monkeypatch):
    """What it says, does, and takes back; with a registry in memory."""
    from isthmus.gui.packages_dialog import PackagesDialog

    registry = Registry({"1.0": "numpy"})
    for table in (packages.PURPOSES, packages.LICENCES, packages.SIZES):
        monkeypatch.setitem(table, "made", "x")
    monkeypatch.setattr(packages, "missing", lambda: [] if packages.installed() else ["made"])
    real = packages.install
    monkeypatch.setattr(packages, "install", lambda *a, **_: real(*a, get=registry.get))
    gone_on = []
    dialog = PackagesDialog(iface.window, then=lambda: gone_on.append(True))
    dialog.show()
    assert str(place) in dialog.text.text() and not dialog.remove_button.isEnabled()
    dialog.install_button.click()
    assert not dialog.install_button.isEnabled()
    wait(lambda: dialog.task is None)
    assert gone_on == [True] and not dialog.isVisible()
    dialog = PackagesDialog(iface.window)
    assert "Nothing is missing" in dialog.text.text() and not dialog.install_button.isEnabled()
    dialog.remove_button.click()
    assert not place.exists() and "Removed" in dialog.log.toPlainText() and dialog.install_button.isEnabled()


def test_the_dialog_says_what_went_wrong(iface, wait, place, monkeypatch):
    from isthmus.gui.packages_dialog import PackagesDialog

    monkeypatch.setattr(packages, "missing", lambda: ["shapely"])

    def fail(*_, **__):
        raise packages.PackageError("pypi.org cannot be reached. Nothing was changed.")

    monkeypatch.setattr(packages, "install", fail)
    dialog = PackagesDialog(iface.window)
    dialog.install_button.click()
    wait(lambda: dialog.task is None)
    text = dialog.log.toPlainText()
    assert "cannot be reached" in text and "pip install" in text and dialog.install_button.isEnabled()
