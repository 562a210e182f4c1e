"""The plugin's zip, as a user gets it: it installs into a clean QGIS profile and runs there."""

import json
import os
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
QGIS_PROCESS = shutil.which("qgis_process.bin") or shutil.which("qgis_process")

# two squares of side 10, joined by a corridor of width 1
DUMBBELL = {
    "type": "Polygon",
    "coordinates": [[
        [0, 0], [10, 0], [10, 4], [20, 4], [20, 0], [30, 0], [30, 10], [20, 10], [20, 5], [10, 5],
        [10, 10], [0, 10], [0, 0],
    ]],
}  # fmt: skip


def is_commit():
    """Whether the zip can be made: by git, from a commit."""
    git = shutil.which("git")
    command = [git, "-C", ROOT, "cat-file", "-e", "HEAD:metadata.txt"]
    return bool(git) and subprocess.run(command, stderr=subprocess.DEVNULL).returncode == 0


@pytest.fixture(scope="module")
def archive():
    if not is_commit():
        pytest.skip("this folder is no git checkout")
    subprocess.run(["bash", ROOT / "run", "zip"], check=True)
    with zipfile.ZipFile(ROOT / "build" / "isthmus.zip") as opened:
        yield opened


def test_contents(archive):
    files = {name for name in archive.namelist() if not name.endswith("/")}
    top = {Path(name).parts[1] for name in files}
    assert all(name.startswith("isthmus/") for name in files)
    assert {"LICENSE", "README.md", "__init__.py", "metadata.txt", "plugin.py", "resources"} <= top
    assert not top & {"docs", "run", "tests", "tools", "build"}
    assert not [name for name in top if name.startswith(".")]
    assert {"requirements.txt", "gui"} <= top and "owner.ini" not in top
    assert "isthmus/i18n/isthmus_de.qm" in files and not [name for name in files if name.endswith(".ts")]
    assert "isthmus/resources/example.geojson" in files
    pages = {name.removeprefix("isthmus/help/") for name in files if name.startswith("isthmus/help/")}
    names = {"README.html", "partition.html", "hierarchy.html", "aggregate.html", "focusmap.html"}
    assert names | {f"de/{name}" for name in names} <= pages
    needs = archive.read("isthmus/requirements.txt").decode()
    assert "shapely" in needs and "pytest" not in needs and "numpy" not in needs.replace("numpy stays", "")


def test_rules_of_the_plugin_repository(archive, tool):
    assert tool("check_plugin").zip_faults(archive.filename)[0] == []


@pytest.mark.skipif(not QGIS_PROCESS, reason="no qgis_process on this machine")
def test_runs_in_a_clean_profile(archive, tmp_path):
    config = tmp_path / "config"
    archive.extractall(config / "profiles" / "default" / "python" / "plugins")
    environment = {k: v for k, v in os.environ.items() if k != "QGIS_PLUGINPATH"}
    environment |= {"QGIS_CUSTOM_CONFIG_PATH": str(config), "QT_QPA_PLATFORM": "offscreen"}

    def qgis_process(*arguments):
        done = subprocess.run(
            [QGIS_PROCESS, *arguments],
            env=environment, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8",
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    qgis_process("plugins", "enable", "isthmus")

    polygon, parts = tmp_path / "polygon.geojson", tmp_path / "parts.gpkg"
    polygon.write_text(json.dumps(DUMBBELL))
    answer = qgis_process(
        "run", "--json", "isthmus:partition", "--",
        f"INPUT={polygon}", "TAU=4", f"OUTPUT={parts}", f"CUTS={tmp_path / 'cuts.gpkg'}",
    )  # fmt: skip
    results = json.loads(answer[answer.index("{") :])["results"]
    assert results["PART_COUNT"] == results["CUT_COUNT"] + 1 > 1
    assert parts.exists()
