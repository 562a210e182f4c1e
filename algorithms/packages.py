"""Packages that QGIS lacks, fetched as wheels into a folder of the user's profile.

QGIS's own Python, numpy above all, stays as it is: the folder stands before it on ``sys.path`` and has
only what is missing. No pip is needed, which QGIS does not have everywhere, and nothing is resolved that
could bring a numpy along: of each package the newest wheel is taken that fits this Python, this system and
the numpy that is there.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import io
import json
import os
import platform
import re
import shutil
import sys
import sysconfig
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, NamedTuple

from .dependencies import engines_with_wheels
from .words import tr

if TYPE_CHECKING:
    from qgis.core import QgsFeedback


INDEX = "https://pypi.org/simple/{}/"
SIMPLE = "application/vnd.pypi.simple.v1+json"
MARKER = "remove-at-start"
LOOK_AT = 30  # releases of a package, the newest first
OLD_LINUX = {"manylinux1": (2, 5), "manylinux2010": (2, 12), "manylinux2014": (2, 17)}
SIZES = {"shapely": "3 MB", "pythoncdt": "0.5 MB", "triangle": "2 MB", "scipy": "40 MB"}
LICENCES = {"shapely": "BSD", "pythoncdt": "MPL-2.0", "scipy": "BSD", "triangle": "not for commercial use"}
PURPOSES = {
    "shapely": "all tools need it",
    "pythoncdt": "faster triangulation, and focus maps",
    "triangle": "triangulation, and focus maps",
    "scipy": "exact aggregation, and focus maps",
}


Get = Callable[[str, Dict[str, str]], bytes]  # what is at a web address, asked for with headers


class PackageError(Exception):
    """A sentence for the user: what could not be fetched, and what to do."""


class Wheel(NamedTuple):
    """A file that fits this Python."""

    name: str
    version: str
    filename: str
    url: str
    sha256: str
    size: int


# --- the folder ---------------------------------------------------------------------------------------


def folder() -> Path:
    """Return the folder of this profile and this Python: after an update of QGIS another one counts."""
    from qgis.core import QgsApplication

    return Path(QgsApplication.qgisSettingsDirPath()) / "isthmus" / sys.implementation.cache_tag


def activate() -> None:
    """Put the folder on ``sys.path``, if there is one. Called when the plugin starts."""
    place = folder()
    if (place / MARKER).exists():
        shutil.rmtree(place, ignore_errors=True)
    if place.is_dir() and str(place) not in sys.path:
        # before the others, where a package may be too old: only what is missing is in there
        sys.path.insert(0, str(place))
        importlib.invalidate_caches()


def installed() -> list[str]:
    """Return what is in the folder, as "name version"."""
    names = sorted(path.name[: -len(".dist-info")] for path in folder().glob("*.dist-info"))
    return [" ".join(name.rsplit("-", 1)) for name in names]


def remove() -> bool:
    """Remove the folder; return whether that is done, or waits for the next start of QGIS.

    Windows deletes no library that is in use.
    """
    place = folder()
    if str(place) in sys.path:
        sys.path.remove(str(place))
    try:
        if place.is_dir():
            shutil.rmtree(place)
        return True
    except OSError:
        (place / MARKER).touch()
        return False


# --- what is missing ----------------------------------------------------------------------------------


def missing() -> list[str]:
    """Return the names of the packages that this QGIS lacks and that can be fetched for it."""
    names = []
    try:
        import shapely

        old = not hasattr(shapely, "get_coordinates")
    except ImportError:
        old = True
    if old:
        names.append("shapely")
    if not any(_importable(name) for name in ("pythoncdt", "triangle")):
        engines = engines_with_wheels()
        # triangle, which not everybody may use, only where nothing else triangulates
        names += [name for name in engines[:1] if name != "triangle" or sys.version_info < (3, 10)]
    if not _importable("scipy"):
        names.append("scipy")
    return names


def _importable(name):
    try:
        importlib.import_module(name)
    except ImportError:
        return False
    return True


# --- which wheel --------------------------------------------------------------------------------------


def find(name: str, numpy_version: str, get: Get) -> Wheel:
    """Return the newest wheel of a package that fits this Python and this numpy.

    Parameters
    ----------
    name, numpy_version : str
    get : callable
        ``(url, headers)`` to bytes; raises `PackageError`.
    """
    page = json.loads(get(INDEX.format(name), {"Accept": SIMPLE}))
    releases = {}
    for file in page["files"]:
        parts = file["filename"][:-4].split("-")
        if not file["filename"].endswith(".whl") or len(parts) < 5 or file.get("yanked"):
            continue
        version = parts[1]
        if re.fullmatch(r"\d+(\.\d+)*", version) and fits_tags(parts[-3], parts[-2], parts[-1]):
            if accepts(file.get("requires-python") or "", platform.python_version()):
                releases[numbers(version)] = Wheel(
                    name,
                    version,
                    file["filename"],
                    file["url"],
                    file["hashes"]["sha256"],
                    int(file.get("size") or 0),
                )
    for _, wheel in sorted(releases.items(), reverse=True)[:LOOK_AT]:
        wants = requirements(wheel, get)
        if set(wants) <= {"numpy"} and accepts(wants.get("numpy", ""), numpy_version):
            return wheel
    raise PackageError(
        tr("There is no wheel of {} for Python {} on {} with numpy {}. A newer QGIS may have one.").format(
            name, platform.python_version(), sysconfig.get_platform(), numpy_version
        )
    )


def fits_tags(python: str, abi: str, platforms: str) -> bool:
    """Return whether a wheel with these tags runs here."""
    own = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    if sys.implementation.name != "cpython":
        return False
    if abi == "abi3":
        right = any(
            re.fullmatch(r"cp3\d+", tag) and int(tag[3:]) <= sys.version_info[1] for tag in python.split(".")
        )
    else:
        right = abi == own and own in python.split(".") or abi == "none" and "py3" in python.split(".")
    return right and any(map(fits_platform, platforms.split(".")))


def fits_platform(
    tag: str, *, system: str | None = None, machine: str | None = None, release: tuple[int, ...] | None = None
) -> bool:
    """Return whether this system takes wheels with a platform tag.

    Parameters
    ----------
    tag : str
        Such as 'manylinux_2_28_x86_64'.
    system, machine : str, optional
        As `sys.platform` and `platform.machine` tell them; by default of this system.
    release : (int, int), optional
        Of glibc or macOS.
    """
    system, machine = system or sys.platform, (machine or platform.machine()).lower()
    if tag == "any":
        return True
    if system == "win32":
        names = {"amd64": "win_amd64", "x86_64": "win_amd64", "arm64": "win_arm64", "x86": "win32"}
        return tag == names.get(machine)
    if system == "darwin":
        match = re.fullmatch(r"macosx_(\d+)_(\d+)_(\w+)", tag)
        release = release or numbers(platform.mac_ver()[0])[:2]
        if match is None:
            return False
        return (int(match[1]), int(match[2])) <= release and match[3] in (machine, "universal2")
    match = re.fullmatch(r"(manylinux\d+|manylinux_(\d+)_(\d+))_(\w+)", tag)
    if not match or match[4] != machine:
        return False
    if release is None:
        try:
            release = numbers((os.confstr("CS_GNU_LIBC_VERSION") or "").split()[-1])[:2]
        except (AttributeError, IndexError, OSError, ValueError):  # no glibc
            return False
    needed = (int(match[2]), int(match[3])) if match[2] else OLD_LINUX.get(match[1])
    return needed is not None and needed <= release


def numbers(version: str) -> tuple[int, ...]:
    """Return a version as a tuple, to be compared; what is no number ends it."""
    found = re.match(r"(?:\d+\.?)*", version)
    return tuple(int(word) for word in found[0].split(".") if word) if found else ()


def accepts(specification: str, version: str) -> bool:
    """Return whether a specification such as '>=1.23,<2.7' accepts a version; one not understood does not."""
    own = numbers(version)
    for part in filter(None, (word.strip() for word in specification.strip("() ").split(","))):
        found = re.fullmatch(r"(~=|[=!<>]=|[<>])\s*([\w.*+]+)", part)
        if found is None:
            return False
        operator, text = found.groups()
        wanted = numbers(text)
        # 1.24 is 1.24.0
        long = max(len(own), len(wanted))
        a, b = (x + (0,) * (long - len(x)) for x in (own, wanted))
        same = own[: len(wanted)] == wanted if text.endswith("*") else a == b
        right = {
            ">=": a >= b,
            "<=": a <= b,
            ">": a > b,
            "<": a < b,
            "==": same,
            "!=": not same,
            "~=": a >= b and own[: len(wanted) - 1] == wanted[:-1],
        }[operator]
        if not right:
            return False
    return True


def requirements(wheel: Wheel, get: Get) -> dict[str, str]:
    """Return which packages a wheel needs, by its METADATA: name to specification."""
    with zipfile.ZipFile(_Remote(wheel, get)) as archive:
        (name,) = [name for name in archive.namelist() if re.fullmatch(r"[^/]+\.dist-info/METADATA", name)]
        text = archive.read(name).decode("utf-8")
    wants = {}
    for line in re.findall(r"^Requires-Dist: *(.*)$", text.split("\n\n")[0], re.MULTILINE):
        requirement, _, marker = line.partition(";")
        if "extra" not in marker:
            found = re.match(r"([\w.-]+)\s*(.*)", requirement.strip())
            if found:
                wants[found[1].lower()] = found[2]
    return wants


class _Remote(io.RawIOBase):
    """A file of the web, of which only what is asked for is fetched."""

    def __init__(self, wheel, get):
        self.wheel, self.get, self.at, self.known = wheel, get, 0, {}

    def seekable(self):
        return True

    def readable(self):
        return True

    def tell(self):
        return self.at

    def seek(self, offset, whence=io.SEEK_SET):
        self.at = offset + {io.SEEK_SET: 0, io.SEEK_CUR: self.at, io.SEEK_END: self.wheel.size}[whence]
        return self.at

    def read(self, count=-1):
        stop = self.wheel.size if count is None or count < 0 else min(self.at + count, self.wheel.size)
        for lo, data in self.known.items():
            if lo <= self.at and stop <= lo + len(data):
                break
        else:  # zipfile asks for small pieces near the end
            lo = max(0, min(self.at, stop - 65_536))
            data = self.get(self.wheel.url, {"Range": f"bytes={lo}-{stop - 1}"})
            if len(data) > stop - lo:  # a server that does not know of ranges sends all
                lo = 0
            self.known[lo] = data
        found = data[self.at - lo : stop - lo]
        self.at += len(found)
        return found


# --- fetching -----------------------------------------------------------------------------------------


def fetch(url: str, headers: dict[str, str] | None = None, *, feedback: QgsFeedback | None = None) -> bytes:
    """Return what is at a web address, by QGIS's own network settings (proxy, certificates)."""
    from qgis.core import QgsBlockingNetworkRequest
    from qgis.PyQt.QtCore import QUrl
    from qgis.PyQt.QtNetwork import QNetworkRequest

    request = QNetworkRequest(QUrl(url))
    for name, value in (headers or {}).items():
        request.setRawHeader(name.encode(), value.encode())
    attribute = QNetworkRequest.Attribute
    request.setAttribute(attribute.CacheSaveControlAttribute, False)
    request.setAttribute(attribute.CacheLoadControlAttribute, QNetworkRequest.CacheLoadControl.AlwaysNetwork)
    blocking = QgsBlockingNetworkRequest()
    error = blocking.get(request, True, feedback)
    if feedback is not None and feedback.isCanceled():
        raise PackageError(tr("Stopped. Nothing was changed."))
    if error != QgsBlockingNetworkRequest.ErrorCode.NoError:
        raise PackageError(
            tr(
                "{} cannot be reached: {}. Nothing was changed. Is there a network, and has QGIS its proxy "
                "(Settings, Options, Network)?"
            ).format(QUrl(url).host(), blocking.errorMessage())
        )
    return bytes(blocking.reply().content())


def install(
    names: list[str],
    numpy_version: str,
    say: Callable[[str], Any],
    *,
    feedback: QgsFeedback | None = None,
    get: Get | None = None,
) -> None:
    """Fetch packages and unpack them into `folder`; all of them, or none.

    Parameters
    ----------
    names : list of str
    numpy_version : str
        The one of this QGIS.
    say : callable
        Takes each line of what is done.
    feedback : QgsFeedback, optional
        May cancel.
    get : callable, optional
        As in `find`, instead of the web.
    """
    get = get or functools.partial(fetch, feedback=feedback)
    archives = []
    for name in names:
        wheel = find(name, numpy_version, get)
        say(tr("{}, {:.1f} MB, from {}").format(wheel.filename, wheel.size / 1e6, wheel.url.split("/")[2]))
        data = get(wheel.url, {})
        if hashlib.sha256(data).hexdigest() != wheel.sha256:
            raise PackageError(
                tr("{} has come damaged: its checksum is wrong. Nothing was changed. Try again.").format(
                    wheel.filename
                )
            )
        archives.append((wheel, data))
    place = folder()
    place.mkdir(parents=True, exist_ok=True)
    for wheel, data in archives:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            tops = {member.split("/")[0] for member in archive.namelist()}
            if "numpy" in tops or any(".data" in top for top in tops):
                raise PackageError(tr("{} is not as expected, and was not unpacked.").format(wheel.filename))
            archive.extractall(place)  # which leaves no folder out of it
        say(tr("{} {} is in {}").format(wheel.name, wheel.version, place))
    activate()
    importlib.invalidate_caches()
