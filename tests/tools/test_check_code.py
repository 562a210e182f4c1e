"""The check of the code finds faults that are planted, and none in good code."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCANNERS = ROOT / "build" / "check" / "bin"
GOOD = '''"""A module."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Walk(NamedTuple):
    """A walk."""

    place: np.ndarray

    def turned(self) -> Walk:
        """The other way."""
        return Walk(self.place[::-1])


class Walker:
    """Walks."""

    def __init__(self, pace: float = 1.0) -> None:
        self.pace = pace

    def __repr__(self):
        return f"{self.pace}"


def steps(walk: Walk, *, twice: bool = False) -> int:
    """How many."""

    def inside(k):
        return 2 * k

    return inside(len(walk.place)) if twice else _count(walk)


def _count(walk):
    return len(walk.place)
'''


@pytest.fixture(scope="module")
def check_code(tool):
    return tool("check_code")


def planted(old, new):
    assert old in GOOD
    return GOOD.replace(old, new)


def test_good_code(check_code):
    assert check_code.untyped(GOOD) == []


UNTYPED = {
    "an argument": (planted("walk: Walk, *", "walk, *"), "steps"),
    "an option": (planted("twice: bool = False", "twice=False"), "steps"),
    "a result": (planted(" -> int", ""), "steps"),
    "a method": (planted("self) -> Walk", "self)"), "turned"),
    "a constructor": (planted("pace: float = 1.0", "pace=1.0"), "__init__"),
    "a constructor's result": (planted("1.0) -> None", "1.0)"), "__init__"),
    "more arguments": (planted("*, twice: bool = False", "*more, twice: bool = False"), "steps"),
    "more options": (planted("twice: bool = False", "twice: bool = False, **more"), "steps"),
}


@pytest.mark.parametrize("fault", UNTYPED)
def test_missing_types(check_code, fault):
    source, name = UNTYPED[fault]
    (found,) = check_code.untyped(source)
    assert found.endswith(f": {name}")


def test_where_types_are_asked_for(check_code, tmp_path):
    asked = [
        "__init__.py",
        "algorithms/base.py",
        "algorithms/layers/wkb.py",
        "core/aggregation/greedy.py",
        "core/focus/graph.py",
        "core/partition/parts.py",
        "core/rings.py",
        "gui/panel.py",
        "plugin.py",
        "python/_focus.py",
    ]
    for name in (*asked, "tests/core/test_rings.py", "tools/demo.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("def some(values, more=1, most=2):\n    return values\n")
    assert sorted(check_code.annotation_faults(tmp_path)) == [
        f"{name}:1: some does not say all its types" for name in asked
    ]
    assert sorted(check_code.option_faults(tmp_path)) == [
        f"{name}:1: some takes more than one option by its place" for name in asked
    ]


def test_options_by_place(check_code):
    assert check_code.by_place(GOOD) == []
    one, two = (
        planted("*, twice: bool = False", f"twice: bool = False{more}") for more in ("", ", k: int = 1")
    )
    assert check_code.by_place(one) == [], "what else is there to take it for"
    (found,) = check_code.by_place(two)
    assert found.endswith(": steps")


def test_this_code(check_code):
    assert check_code.annotation_faults(ROOT) == check_code.option_faults(ROOT) == []


FAULTS = {
    "a name that is not there": (planted("return 2 * k", "return 2 * K"), "F821"),
    "an import that is not used": (planted("import numpy", "import json\n\nimport numpy"), "F401"),
    "imports in disorder": (planted("from typing", "import numpy as np\nfrom typing"), "I001"),
    "another format": (planted("return 2 * k", "return 2*k"), "walk.py"),
    "a long line": (planted("A module.", "A module" + " of words" * 12), "E501"),
    "a mutable default": (planted("twice: bool = False", "twice: list = []"), "B006"),
    "a wrong result": (planted("return Walk(self.place[::-1])", "return 1"), "[return-value]"),
    "a wrong argument": (planted("_count(walk)\n\n", "steps(1)\n\n"), "[arg-type]"),
    "a missing type": (planted(" -> int", ""), "does not say all its types"),
    "options by place": (
        planted("*, twice: bool = False", "twice: bool = False, most: int = 1"),
        "takes more than one option by its place",
    ),
}


TOOL = '''"""A tool of the plugin."""

from __future__ import annotations

from qgis.core import QgsProcessingAlgorithm

from ..core.walk import Walk, steps


class Tool(QgsProcessingAlgorithm):
    """Counts."""

    def name(self) -> str:
        return "count"


def count(walk: Walk) -> int:
    """How many."""
    return steps(walk)
'''
TOOL_FAULTS = {
    "missing": (("self) -> str", "self)"), "missing.py:13: name does not say all its types"),
    "result": (("-> int", "-> str"), "result.py:19: error: Incompatible return value"),
    "argument": (("steps(walk)", "steps(1)"), 'argument.py:19: error: Argument 1 to "steps"'),
}
scanned = pytest.mark.skipif(not (SCANNERS / "ruff").exists(), reason="./run check has not been run here")


def checked(folder, files):
    """What the whole script says of some files."""
    for name, source in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(source)
    shutil.copy(ROOT / "pyproject.toml", folder)
    command = [sys.executable, ROOT / "tools" / "check_code.py", folder, "--programs", SCANNERS]
    return subprocess.run(command, capture_output=True, encoding="utf-8")


@scanned
def test_planted_faults_of_the_plugin(tmp_path):
    """QGIS's classes are anything at all, but not what the plugin says itself."""
    packages = {f"{name}/__init__.py": "" for name in ("core", "algorithms", "gui")}
    faults = {f"algorithms/{name}.py": TOOL.replace(*fault) for name, (fault, _) in TOOL_FAULTS.items()}
    whole = {"__init__.py": "", "plugin.py": "", "core/walk.py": GOOD, "algorithms/good.py": TOOL}
    done = checked(tmp_path, {**whole, **packages, **faults})
    assert done.returncode == 1, done.stdout + done.stderr
    assert all(words in done.stdout for _, words in TOOL_FAULTS.values()), done.stdout
    assert done.stdout.count(".py:") == len(TOOL_FAULTS), done.stdout


@scanned
@pytest.mark.parametrize("fault", [None, *FAULTS])
def test_planted_faults(tmp_path, fault):
    """The whole script, and its exit code."""
    source, words = FAULTS.get(fault, (GOOD, ""))
    done = checked(tmp_path, {"core/__init__.py": "", "core/walk.py": source})
    assert done.returncode == (fault is not None), done.stdout + done.stderr
    assert words in done.stdout and (fault or done.stdout.count(": ok") == 5)
