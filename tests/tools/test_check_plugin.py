"""The rules of plugins.qgis.org find faults that are planted, and none in a good zip."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCANNERS = ROOT / "build" / "check" / "bin"
METADATA = """[general]
name=Good
description=Does good.
about=More of that.
version=1.0.2
qgisMinimumVersion=3.22
qgisMaximumVersion=4.99
author=Somebody
email=somebody@somewhere.org
tracker=https://somewhere.org/good/issues
repository=https://somewhere.org/good
icon=icon.svg
experimental=False
homepage=https://somewhere.org/good/pages/start.html
changelog=Version 1.0.2
  Better.
"""
FILES = {
    "good/__init__.py": "def classFactory(iface):\n    return iface\n",
    "good/metadata.txt": METADATA,
    "good/LICENSE": "Do what you like.\n",
    "good/icon.svg": "<svg/>",
    "good/requirements.txt": "# not numpy\nshapely >= 2.1; python_version >= '3.10'\nnumpy-stl\n",
}


@pytest.fixture(scope="module")
def check_plugin(tool):
    return tool("check_plugin")


def make(path, files):
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def with_metadata(old, new):
    assert old in METADATA
    return {**FILES, "good/metadata.txt": METADATA.replace(old, new)}


def renamed(folder):
    return {name.replace("good", folder, 1): content for name, content in FILES.items()}


def without(name):
    return {key: content for key, content in FILES.items() if key != name}


def test_a_good_zip(check_plugin, tmp_path):
    faults, metadata = check_plugin.zip_faults(make(tmp_path / "good.zip", FILES))
    assert faults == []
    assert metadata["name"] == "Good" and check_plugin.placeholders(metadata) == []


PLANTED = {
    "the root of the repository": (
        with_metadata("homepage=https://somewhere.org/good/pages/start.html", "homepage=https://somewhere.org/good/"), "is the root"
    ),
    "the root of another repository": (
        with_metadata("homepage=https://somewhere.org/good/pages/start.html", "homepage=https://github.com/some/body"), "is the root"
    ),
    "no changelog": (with_metadata("changelog=Version 1.0.2\n  Better.\n", ""), "changelog is missing"),
    "an old changelog": (with_metadata("changelog=Version 1.0.2", "changelog=Version 1.0.1"), "does not tell of version"),
    "a long about": (with_metadata("about=More of that.", "about=" + "More of that. " * 40), "more than 500"),
    "no license": (without("good/LICENSE"), "LICENSE is missing"),
    "no requirements": (without("good/requirements.txt"), "requirements.txt is missing"),
    "QGIS's own numpy": ({**FILES, "good/requirements.txt": "shapely\nNumPy>=2\n"}, "asks for numpy"),
    "what only tests need": ({**FILES, "good/requirements.txt": "pytest_qgis[x]; python_version > '3'"}, "asks for pytest-qgis"),
    "no metadata": (without("good/metadata.txt"), "metadata.txt is missing"),
    "no init": (without("good/__init__.py"), "__init__.py is missing"),
    "no factory": ({**FILES, "good/__init__.py": ""}, "no function classFactory"),
    "two folders": ({**FILES, "evil/a.py": ""}, "in one folder"),
    "a file beside": ({**FILES, "a.py": ""}, "in one folder"),
    "a dash": (renamed("go-od"), "no Python name"),
    "a digit first": (renamed("2good"), "no Python name"),
    "the word": (renamed("goodplugin"), "word plugin"),
    "bytecode": ({**FILES, "good/__pycache__/a.pyc": ""}, "no plugin may have"),
    "bytecode alone": ({**FILES, "good/a.pyc": ""}, "a program"),
    "git": ({**FILES, "good/.git/HEAD": ""}, "no plugin may have"),
    "mac": ({**FILES, "good/__MACOSX/a": ""}, "no plugin may have"),
    "hidden": ({**FILES, "good/.env": ""}, "is hidden"),
    "a library": ({**FILES, "good/a.so": ""}, "a program"),
    "a program without a suffix": ({**FILES, "good/a": b"\x7fELF\x02\x01"}, "a program"),
    "an archive": ({**FILES, "good/data": b"PK\x03\x04"}, "or an archive"),
    "a way out": ({**FILES, "good/../a.py": ""}, "leads out"),
    "no section": ({**FILES, "good/metadata.txt": "name=Good\n"}, "cannot be read"),
    "no utf-8": ({**FILES, "good/metadata.txt": METADATA.encode() + b"\xff"}, "cannot be read"),
    "a percent sign": (with_metadata("Does good.", "Does 100 % good."), "cannot be read"),
    "no about": (with_metadata("about=More of that.\n", ""), "about is missing"),
    "an empty author": (with_metadata("Somebody", ""), "author is missing"),
    "a slash": (with_metadata("Somebody", "Some/body"), "slash"),
    "a version with letters": (with_metadata("1.0.2", "1.0rc2"), "no number"),
    "a minimum with letters": (with_metadata("3.22", "LTR"), "no version"),
    "a maximum below": (with_metadata("4.99", "3.10"), "below"),
    "not for QGIS 4": (with_metadata("qgisMaximumVersion=4.99\n", ""), "no QGIS 4"),
    "no address": (with_metadata("somebody@somewhere.org", "somebody"), "email is no address"),
    "no tracker": (with_metadata("https://somewhere.org/good/issues", "somewhere"), "tracker is no web"),
    "the Plugin Builder's": (with_metadata("https://somewhere.org/good\n", "http://repo\n"), "repository is no web"),
    "no icon": (without("good/icon.svg"), "icon is not in the zip"),
    "half true": (with_metadata("experimental=False", "experimental=perhaps"), "neither True nor False"),
}  # fmt: skip


@pytest.mark.parametrize("planted", PLANTED)
def test_planted_faults(check_plugin, tmp_path, planted):
    files, words = PLANTED[planted]
    faults, _ = check_plugin.zip_faults(make(tmp_path / "bad.zip", files))
    assert any(words in fault for fault in faults), faults


def test_no_zip_at_all(check_plugin, tmp_path):
    path = tmp_path / "no.zip"
    path.write_text("no zip")
    assert check_plugin.zip_faults(path)[0] == ["the file is no zip"]


def test_damaged(check_plugin, tmp_path):
    path = make(tmp_path / "damaged.zip", FILES)
    path.write_bytes(path.read_bytes().replace(b"Do what you like.", b"Do what I like .."))
    assert "damaged" in check_plugin.zip_faults(path)[0][0]


def test_too_large(check_plugin, tmp_path, monkeypatch):
    monkeypatch.setattr(check_plugin, "LARGEST", 100)
    assert "100" in check_plugin.zip_faults(make(tmp_path / "large.zip", FILES))[0][0]


def test_executable(check_plugin, tmp_path):
    path = make(tmp_path / "good.zip", FILES)
    with zipfile.ZipFile(path, "a") as archive:
        info = zipfile.ZipInfo("good/a.py")
        info.external_attr = 0o100755 << 16
        archive.writestr(info, "")
    assert check_plugin.zip_faults(path)[0] == ["good/a.py is executable"]


@pytest.mark.parametrize("key, value", [
    ("email", "a@example.org"), ("email", "a@users.somewhere.example"),
    ("tracker", "https://localhost/issues"), ("repository", "https://x.invalid/good"),
])  # fmt: skip
def test_placeholders(check_plugin, key, value):
    good = {"email": "a@b.org", "tracker": "https://b.org/i", "repository": "https://b.org"}
    assert check_plugin.placeholders(good) == []
    assert key in check_plugin.placeholders({**good, key: value})[0]


def test_an_address_that_does_not_answer(check_plugin):
    silent = check_plugin.silent_urls({"homepage": "http://127.0.0.1:9/", "tracker": "nothing"})
    assert len(silent) == 1 and "homepage does not answer" in silent[0]


@pytest.mark.parametrize("program, said", [
    (None, "bandit does not start"),
    ("kill -9 $$", "bandit was ended by signal 9"),
    ("echo out of memory >&2; exit 3", "bandit failed with 3: out of memory"),
])  # fmt: skip
def test_a_scanner_that_dies_is_named(tmp_path, program, said):
    """And the zip does not pass for want of findings."""
    (tmp_path / "programs").mkdir()
    if program is not None:
        (tmp_path / "programs" / "bandit").write_text(f"#!/bin/sh\n{program}\n")
        (tmp_path / "programs" / "bandit").chmod(0o755)
    path = make(tmp_path / "good.zip", FILES)
    command = [sys.executable, ROOT / "tools" / "check_plugin.py", path, "--programs", tmp_path / "programs"]
    done = subprocess.run(command, capture_output=True, encoding="utf-8")
    assert done.returncode == 1 and said in done.stdout, done.stdout + done.stderr


@pytest.mark.skipif(not (SCANNERS / "bandit").exists(), reason="./run check has not been run here")
def test_scanners(tmp_path):
    """The whole script: a fault for each scanner, and its exit code."""
    source = (
        "import random\nfrom PyQt5.QtCore import Qt\n\nassert random.random()\n"
        "print(unheard_of, Qt.Horizontal)\nkey = 'AKIA" + "IOSFODNN7EXAMPLE'\n"
    )
    path = make(tmp_path / "good.zip", {**FILES, "good/a.py": source})
    command = [sys.executable, ROOT / "tools" / "check_plugin.py", path, "--programs", SCANNERS]
    done = subprocess.run(command, capture_output=True, encoding="utf-8")
    assert done.returncode == 1, done.stdout + done.stderr
    for words in ("B101", "B311", "AWS", "F821", "QGS4"):
        assert words in done.stdout
    (path.parent / "fine").mkdir()
    fine = make(tmp_path / "fine" / "good.zip", FILES)
    command[2] = fine
    done = subprocess.run(command, capture_output=True, encoding="utf-8")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(": ok") == 4
