"""Python packages that QGIS may lack: what is missing, and which command installs it.

Not numpy: Processing itself does not start without it.
"""

from __future__ import annotations

import importlib.util
import platform
import shutil
import sys
import sysconfig
from pathlib import Path

import numpy

from ..core.errors import Sentence
from .words import as_sentence, spoken, tr

# For which CPython and which machines PyPI has wheels. Nobody builds an engine from source.
WHEELS = {
    "pythoncdt": (
        (3, 10),
        (3, 15),
        {
            "linux-x86_64",
            "linux-aarch64",
            "win-amd64",
            "macosx-x86_64",
            "macosx-arm64",
        },
    ),
    "triangle": ((3, 7), (3, 13), {"linux-x86_64", "win-amd64", "macosx-arm64"}),
}


def dependency_problem() -> str:
    """Return what is missing and which command installs it, or '' if the tools can run."""
    try:
        import shapely

        from ..core.partition.triangulation import missing_packages

        problem = missing_packages(shapely)
    except ImportError:
        problem = Sentence("the Python package shapely is missing")
    return problem and f"{as_sentence(spoken(problem))} {install_hint(numpy.__version__)}"


def engines_with_wheels(*, version: tuple[int, int] | None = None, machine: str | None = None) -> list[str]:
    """Return the triangulation engines that pip can install, those that are free for all first.

    Parameters
    ----------
    version : (int, int), optional
        Of CPython. Default: the running one.
    machine : str, optional
        System and processor, such as 'linux-x86_64'. Default: this one.
    """
    if sys.implementation.name != "cpython":
        return []
    version = version or sys.version_info[:2]
    machine = machine or _machine()
    return [
        name
        for name, (first, last, machines) in WHEELS.items()
        if first <= version <= last and machine in machines
    ]


def _machine():
    # on a Mac, the name of Python's own build may stand for two processors
    if sys.platform == "darwin":
        return f"macosx-{platform.machine()}"
    return sysconfig.get_platform()


def install_hint(numpy_version: str, packages: list[str] | None = None) -> str:
    """Return how to install packages without touching QGIS's numpy.

    Parameters
    ----------
    numpy_version : str
    packages : list of str, optional
        As pip takes them. Default: shapely, and an engine that triangulates faster.
    """
    remark = ""
    if packages is None:
        # there is no shapely 2.1 for Python 3.9; with an engine 2.0 will do
        shapely = '"shapely>=2.1"' if sys.version_info >= (3, 10) else '"shapely>=2.0"'
        packages = [shapely, *engines_with_wheels()[:1]]
        if "triangle" in packages:
            remark = tr("triangle's licence does not allow commercial use: leave it out then; ")
    command = f'{" ".join(packages)} "numpy=={numpy_version}"'
    if (Path(sys.prefix) / "conda-meta").is_dir():
        first, user = "", ""
    else:
        first, user = _pip_first(), " --user"
        if Path(sysconfig.get_path("stdlib"), "EXTERNALLY-MANAGED").exists():
            user += " --break-system-packages"
    where = tr("in the OSGeo4W Shell") if sys.platform == "win32" else tr("in a terminal")
    command = f"{first}{_shell_word(python_program())} -m pip install{user} {command}"
    return tr(
        "In the window of QGIS, Plugins > Isthmus > Install packages does it. Or run this {}, then "
        "restart QGIS: {} ({}the last word keeps QGIS's own numpy)"
    ).format(where, command, remark)


def python_program(
    *, executable: str | None = None, prefix: str | None = None, system: str | None = None
) -> str:
    """Return the program of the running Python; QGIS itself may be what ``sys.executable`` names.

    Parameters
    ----------
    executable, prefix, system : str, optional
        Instead of `sys.executable`, `sys.prefix` and `sys.platform`.
    """
    program, system = Path(executable or sys.executable or "python3"), system or sys.platform
    if program.stem.lower().startswith("python"):
        return str(program)
    version = ".".join(map(str, sys.version_info[:2]))
    names = (
        ("python3.exe", "python.exe")
        if system == "win32"
        else (
            f"bin/python{version}",
            "bin/python3",
            f"MacOS/bin/python{version}",
            "MacOS/bin/python3",
        )
    )
    # QGIS.app/Contents/MacOS/QGIS has its Python beside it, or in Contents/Frameworks
    for place in (Path(prefix or sys.prefix), program.parent, *program.parents[1:3]):
        for name in names:
            if (place / name).exists():
                return str(place / name)
    return "python" if system == "win32" else "python3"


def _pip_first():
    """What has to come before a command with pip, where QGIS's Python has none."""
    if importlib.util.find_spec("pip"):
        return ""
    if shutil.which("apt-get"):
        return "sudo apt install python3-pip && "
    return f"{_shell_word(python_program())} -m ensurepip --user && "


def _shell_word(path):
    return f'"{path}"' if " " in path else path
