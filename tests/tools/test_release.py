"""What is made only for the zip: metadata, help pages, the translation; and what no release may have."""

import configparser
import os
import re
import threading
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def release(tool):
    return tool("release")


@pytest.fixture(scope="module")
def translate(tool):
    return tool("translate")


def general(text):
    parser = configparser.ConfigParser()  # with a meaning for %, as QGIS and the site read it
    parser.optionxform = str
    parser.read_string(text)
    return dict(parser["general"])


def test_metadata_has_the_owners_words_and_the_changes(release):
    text = (ROOT / "metadata.txt").read_text(encoding="utf-8")
    owner = (
        "[owner]\nauthor=Ada\nemail=ada@lovelace.org\nhomepage=https://lovelace.org/isthmus/100%25/start\n"
    )
    version = re.search("version=(.*)", text)[1]
    found = general(
        release.metadata(
            text,
            owner.replace("%25", ""),
            f"# Changes\n\n## {version}\n\n* `TAU` by 3 %, [see](docs/x.md).\n\n## 0.0.1\n\n* Old.\n",
        )
    )
    assert found["author"] == "Ada" and found["email"] == "ada@lovelace.org"
    assert found["name"] == "Isthmus" and found["version"] == version
    assert f"Version {version}" in found["changelog"] and "TAU by 3 per cent, see." in found["changelog"]
    assert "Old" not in found["changelog"]
    with pytest.raises(SystemExit, match="no section for version"):
        release.metadata(text, owner.replace("%25", ""), "# Changes\n\n## 0.0.1\n")


def test_pages_of_the_reference_become_html(release):
    for path in (ROOT / "docs" / "reference").rglob("*.md"):
        german = path.parent.name == "de"
        page = release.html_page(path.read_text(encoding="utf-8"), "de" if german else "en")
        assert f"Isthmus: {'Referenz' if german else 'reference'}</a>" in page
        body = page.partition("<body>")[2]
        assert not re.search(r"\]\(|\*\*|^\||^#|```", body, re.MULTILINE), path.name
        for tag in ("table", "p", "code", "i", "h2", "pre", "tr"):
            assert page.count(f"<{tag}>") == page.count(f"</{tag}>")
        targets = re.findall(r'href="([^"]+)\.html"', page)
        assert all((path.parent / f"{target}.md").exists() for target in targets)
        assert targets or path.name != "README.md"
    page = release.html_page(
        "# A & B\n\nOne *two* `a*b*c` [x](y.md).\n\n| a | b |\n|---|---|\n| `1` | <2 |\n"
    )
    assert "<h1>A &amp; B</h1>" in page and "<code>a*b*c</code>" in page and '<a href="y.html">x</a>' in page
    assert "<td><code>1</code></td><td>&lt;2</td>" in page


def test_translations_are_what_qt_reads(translate, tmp_path, qgis_app):
    """Every text, by Qt's own reader."""
    from qgis.PyQt.QtCore import QCoreApplication, QTranslator

    words = translate.read((ROOT / "i18n" / "isthmus_de.ts").read_text(encoding="utf-8"))
    path = tmp_path / "isthmus_de.qm"
    path.write_bytes(translate.compiled(words))
    translator = QTranslator()
    assert translator.load(str(path)) and len(words) > 200
    QCoreApplication.installTranslator(translator)
    try:
        for source, translation in words.items():
            assert QCoreApplication.translate("isthmus", source) == translation
        assert QCoreApplication.translate("isthmus", "no such text") == "no such text"
        assert QCoreApplication.translate("other", "Parts") == "Parts" != words["Parts"]
    finally:
        QCoreApplication.removeTranslator(translator)
    assert translate.read(translate.write(words)) == words


def test_faults_of_a_translation_are_found(translate):
    wanted = {"Find {name}", "a <i>b</i>", "MIN_LENGTH and tau", "x"}
    good = {
        "Find {name}": "Finde {name}",
        "a <i>b</i>": "ein <i>b</i>",
        "MIN_LENGTH and tau": "MIN_LENGTH und tau",
        "x": "y",
    }
    assert translate.faults(wanted, good) == []
    for change, said in (
        ({"x": ""}, "not translated: x"), ({"z": "z"}, "said nowhere: z"), ({"Find {name}": "Finde {nam}"}, "other fields"),
        ({"a <i>b</i>": "ein b"}, "other tags"), ({"MIN_LENGTH and tau": "MIN_LANG und tau"}, "MIN_LENGTH is missing"),
    ):  # fmt: skip
        assert any(said in one for one in translate.faults(wanted, {**good, **change})), said


def test_a_long_command_shows_that_it_lives(tmp_path):
    """What ./run says while apt-get works, of a log as apt-get writes it."""
    import subprocess

    functions = (ROOT / "run").read_text(encoding="utf-8").partition("\ncase ${1-} in")[0]
    script = (
        functions
        + """
work() {
    echo "0 upgraded, 3 newly installed, 0 to remove."; echo "Get:1 a"; sleep 1.5; echo "Get:2 b"
    echo "Unpacking a ..."; sleep 1.5; echo "Setting up a ..."; sleep 1.5
}
ISTHMUS_TICK=1
: >"$1"; watched "$1" QGIS work && echo done
broken() { return 3; }
watched "$1" QGIS broken || echo failed $?
"""
    )
    (tmp_path / "run").write_text(script)
    done = subprocess.run(
        ["bash", str(tmp_path / "run"), str(tmp_path / "log")],
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    assert done.stdout.split() == ["done", "failed", "3"]
    for said in ("1 of 3 packages fetched", "1 of 3 packages unpacked", "1 of 3 packages set up"):
        assert said in done.stderr, done.stderr


def test_long_tests_show_that_they_live(tmp_path):
    """At once, also into a pipe: the test here ends only when that was read. Those that end soon say nothing."""
    import subprocess
    import sys

    (tmp_path / "test_long.py").write_text(
        "import pathlib, time\n\ndef test():\n"
        "    while not pathlib.Path(__file__).with_name('read').exists(): time.sleep(0.01)\n"
    )
    plugins = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTHONPATH": os.pathsep.join([
        str(ROOT / "tests"), *filter(None, [os.environ.get("PYTHONPATH")]),
    ])}  # fmt: skip
    for tick, more in (("0.4", ["-p", "xdist", "-n", "1"]), ("60", [])):
        run = subprocess.Popen(
            [sys.executable, "-m", "pytest", "-p", "conftest", *more, "-c", os.devnull, "--rootdir", tmp_path, tmp_path],
            env={**os.environ, **plugins, "ISTHMUS_TICK": tick, "PYTHONUNBUFFERED": ""}, stdout=subprocess.PIPE, encoding="utf-8",
        )  # fmt: skip
        killed = threading.Timer(60, run.kill)
        killed.start()
        said = []
        for line in run.stdout:
            said.append(line)
            if "isthmus: 0 tests done, " in line:
                (tmp_path / "read").touch()
        run.wait()
        killed.cancel()
        said = "".join(said)
        assert "1 passed" in said, said
        assert ("isthmus: 0 tests done, " in said) == (tick == "0.4"), said
