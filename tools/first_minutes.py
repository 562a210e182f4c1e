"""The first minutes of a new user, by mouse: from *Install from ZIP* to a result on the example.

    ./run first-minutes             on this machine's QGIS
    ./run trixie first-minutes      on QGIS 3.40

QGIS starts with a new profile and a Python in which neither shapely nor scipy nor an engine is found. Every click
is one of the X server's on what the window shows, and before each a picture is taken; the packages come from
PyPI. The pictures are in build/first-minutes; with ``--note`` also those of docs/first_ten_minutes.md.
"""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import window
from measured import note

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "build" / "first-minutes"
ABSENT = ("shapely", "scipy", "pythoncdt", "triangle")
SIZE = "1240x900"
# run by root of a mount namespace of its own: the packages are gone for what runs in it, and for nothing else
HIDE = """\
set -e
scratch=$1 folder=$2
shift 2
mount -t tmpfs tmpfs "$scratch"
mkdir "$scratch/upper" "$scratch/work"
mount -t overlay -o "lowerdir=$folder,upperdir=$scratch/upper,workdir=$scratch/work" overlay "$folder"
while [ "$1" != -- ]; do rm -rf "$folder/$1" "$folder/$1"-*; shift; done
shift
exec "$@"
"""


def main():
    """Start QGIS as a new user has it, with this file inside."""
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    plain = {
        name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "QGIS_PLUGINPATH")
    }
    with tempfile.TemporaryDirectory() as home:
        scratch, start = Path(home, "scratch"), Path(home, "start.py")
        scratch.mkdir()
        start.write_text(f"import sys\nsys.path.append({str(ROOT / 'tools')!r})\n"
                         "import first_minutes\nfirst_minutes.inside()\n")  # fmt: skip
        # what the user would have downloaded
        shutil.copy(ROOT / "build" / "isthmus.zip", home)
        environment = {
            **plain, "HOME": home, "QGIS_CUSTOM_CONFIG_PATH": str(Path(home, "profile")), "ISTHMUS_HOME": home,
        }  # fmt: skip
        command = ["qgis", "--nologo", "--noversioncheck", "--code", str(start)]
        window.on_a_screen(hidden(scratch, plain) + command, OUT, environment, SIZE)
    said = OUT / "said.txt"
    print(said.read_text(encoding="utf-8") if said.exists() else "")
    if not (OUT / "clicks.json").exists():
        sys.exit(f"not finished; see {OUT / 'qgis.log'} and {OUT}/failed.png")
    if "--note" in sys.argv:
        known = json.loads((OUT / "clicks.json").read_text())
        version = "_".join(known["version"].split(".")[:2])
        note("first_minutes", {f"qgis_{version}": known})
        folder = ROOT / "docs" / "pictures" / "first_minutes"
        folder.mkdir(parents=True, exist_ok=True)
        for picture in OUT.glob("*.png"):
            shutil.copy(picture, folder / f"{version}_{picture.name}")


def hidden(scratch, environment):
    """Return what to put before a command, so that it runs where the Python has none of `ABSENT`."""
    find = f"import importlib.util as u; print(*[s.origin for s in map(u.find_spec, {ABSENT}) if s])"
    found = subprocess.run(
        ["/usr/bin/python3", "-c", find], env=environment, capture_output=True, text=True, check=True
    ).stdout.split()
    folders = {str(Path(origin).parents[1]) for origin in found}
    if not folders:
        return []
    if len(folders) > 1:
        sys.exit(f"cannot hide packages in more than one folder: {' '.join(folders)}")
    names = [Path(origin).parent.name for origin in found]
    root = [] if os.geteuid() == 0 else ["--map-root-user"]
    return ["unshare", "--mount", *root, "sh", "-c", HIDE, "sh", str(scratch), *folders, *names, "--"]


# --- Inside -------------------------------------------------------------------------------------------


def inside():
    """Walk from the new window to the result."""
    walk = Walk(OUT)
    walk.run(walk.steps())


class Walk(window.Stage):
    """A user with a mouse, and a camera."""

    patience = 120.0
    clicks = 0

    def steps(self):
        """What is clicked, one after the other."""
        from qgis.core import Qgis, QgsProject
        from qgis.PyQt.QtWidgets import QApplication, QLineEdit
        from qgis.utils import iface

        self.window, project = iface.mainWindow(), QgsProject.instance()
        self.window.showMaximized()
        yield 4
        there = [name for name in ABSENT if importlib.util.find_spec(name)]
        if there or project.mapLayers():
            raise RuntimeError(f"not what a new user has: {there}")
        self.say(
            f"QGIS {Qgis.QGIS_VERSION.split('-')[0]}, Python {sys.version.split()[0]}, none of: {', '.join(ABSENT)}"
        )
        began = time.monotonic()
        yield from self.click("Plugins")
        yield from self.click("Manage and Install Plugins")
        yield from self.click("Install from ZIP")
        yield from self.click("ZIP file", QLineEdit)
        self.key("type", os.environ["ISTHMUS_HOME"] + "/isthmus.zip")
        yield 1.5
        yield from self.click("Install Plugin")
        yield from self.click("Yes")
        yield from self.click("Close")
        yield from self.click("Plugins")
        yield from self.click("Isthmus")
        yield from self.click("Try it on an example")
        yield from self.click("Fetch and install")
        # three countries, their parts and cuts
        yield lambda: len(project.mapLayers()) == 3
        seconds = time.monotonic() - began
        yield 3
        self.picture("result", self.window)
        parts = [layer for layer in project.mapLayers().values() if layer.fields().indexOf("parts") >= 0]
        if [top for top in QApplication.topLevelWidgets() if top.isModal() and top.isVisible()] or not parts:
            raise RuntimeError("no result, or a dialog is in the way")
        self.say(f"{self.clicks} clicks, {seconds:.0f} s, {parts[0].featureCount()} parts")
        (self.out / "clicks.json").write_text(json.dumps({
            "version": Qgis.QGIS_VERSION.split("-")[0], "clicks": self.clicks, "seconds": round(seconds),
            "parts": parts[0].featureCount(),
        }))  # fmt: skip

    def click(self, text, kind=None):
        """Wait until exactly one thing in the window shows a text, take a picture, and click there."""
        yield lambda: len(self.found(text, kind)) == 1
        yield 0.7  # drawn, and where it stays
        ((point, top),) = self.found(text, kind)
        self.clicks += 1
        self.say(f"{self.clicks} {text}")
        self.picture(f"{self.clicks:02}", top, point)
        self.key("mousemove", str(point.x()), str(point.y()), "click", "1")
        yield 0.7

    def key(self, *words):
        """Let the X server do it: a modal window does not stop what waits outside of it."""
        subprocess.Popen(["xdotool", *words])

    def found(self, text, kind=None):
        """Return where the things that show a text are on the screen, with their windows."""
        from qgis.PyQt.QtWidgets import QAbstractButton, QApplication, QListWidget, QMenu, QMenuBar

        def same(shown):
            return shown.replace("&", "").rstrip("….:").strip() == text

        places = []
        modal, menu = QApplication.activeModalWidget(), QApplication.activePopupWidget()
        for widget in QApplication.allWidgets():
            top = widget.window()
            if not widget.isVisible() or not widget.isEnabled():
                continue
            if (
                menu is not None
                and not isinstance(widget, QMenu)
                or modal not in (None, top)
                and menu is None
            ):
                continue
            areas = []
            if kind is not None:
                if isinstance(widget, kind) and widget.parent().inherits("QgsFileWidget"):
                    areas = [widget.rect()]
            elif isinstance(widget, (QMenu, QMenuBar)):
                areas = [
                    widget.actionGeometry(one)
                    for one in widget.actions()
                    if same(one.text()) and one.isEnabled()
                ]
            elif isinstance(widget, QListWidget):
                items = (widget.item(row) for row in range(widget.count()))
                areas = [
                    widget.visualItemRect(one) for one in items if same(one.text()) and not one.isHidden()
                ]
                widget = widget.viewport()
            elif isinstance(widget, QAbstractButton) and same(widget.text() or widget.toolTip()):
                areas = [widget.rect()]
            places += [(widget.mapToGlobal(area.center()), top) for area in areas if not area.isEmpty()]
        return places

    def picture(self, name, top, point=None):
        """Save what the screen shows of a window, with a ring where the click goes."""
        from qgis.PyQt.QtCore import QSize, Qt
        from qgis.PyQt.QtGui import QColor, QImage, QPainter, QPen
        from qgis.PyQt.QtWidgets import QMenu

        screen = self.window.windowHandle().screen()
        top = self.window if isinstance(top, QMenu) else top
        frame = top.frameGeometry()
        if top is self.window and point is not None:
            frame.setSize(QSize(900, 350))  # the menus
        image = screen.grabWindow(0, frame.x(), frame.y(), frame.width(), frame.height())
        if point is not None:
            painter = QPainter(image)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(QPen(QColor("#d01c8b"), 4))
            painter.drawEllipse(point - frame.topLeft(), 22, 22)
            painter.end()
        # 256 colours: a fifth of the size
        small = image.toImage().convertToFormat(
            QImage.Format.Format_Indexed8, Qt.ImageConversionFlag.ThresholdDither
        )
        small.save(str(self.out / f"{name}.png"))


if __name__ == "__main__":
    main()
