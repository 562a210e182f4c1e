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
        "core/aggregation/greedy.py",
        "core/focus/graph.py",
        "core/partition/parts.py",
        "core/rings.py",
        "python/_focus.py",
    ]
    for name in (*asked, "algorithms/layers.py", "tools/demo.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("def some(values):\n    return values\n")
    assert sorted(check_code.annotation_faults(tmp_path)) == [
        f"{name}:1: some does not say all its types" for name in asked
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


@pytest.mark.skipif(not (SCANNERS / "ruff").exists(), reason="./run check has not been run here")
@pytest.mark.parametrize("fault", [None, *FAULTS])
def test_planted_faults(tmp_path, fault):
    """The whole script, and its exit code."""
    source, words = FAULTS.get(fault, (GOOD, ""))
    (tmp_path / "core").mkdir()
    (tmp_path / "core/__init__.py").write_text("")
    (tmp_path / "core/walk.py").write_text(source)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    command = [sys.executable, ROOT / "tools" / "check_code.py", tmp_path, "--programs", SCANNERS]
    done = subprocess.run(command, capture_output=True, encoding="utf-8")
    assert done.returncode == (fault is not None), done.stdout + done.stderr
    assert words in done.stdout and (fault or done.stdout.count(": ok") == 5)
