"""Check the code as it stands, as pyproject.toml says: ``check_code.py FOLDER``.

Lint, the order of imports and the format by ruff, types in core, in the plugin and in the Python package by
mypy, and here that what is public there says the types of all it takes and returns, and takes its options by
name. Prints what it checked; exits with 1 if there is a fault.
"""

import argparse
import ast
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PLUGIN = ("__init__.py", "plugin.py", "algorithms", "core", "gui")
TYPED = ("core/**/*.py", "python/*.py", "algorithms/**/*.py", "gui/**/*.py", "plugin.py", "__init__.py")


def untyped(source):
    """Return the public functions and methods of a module with an argument or a result without a type.

    Parameters
    ----------
    source : str

    Returns
    -------
    list of str
        Lines like ``12: name``.
    """
    return public(source, _is_untyped)


def by_place(source):
    """Return those that take more than one option by its place, which no reader of a call can tell apart."""
    return public(source, lambda node: len(node.args.defaults) > 1)


def _is_untyped(node):
    its = node.args
    arguments = [*its.posonlyargs, *its.args, *its.kwonlyargs, its.vararg, its.kwarg]
    missing = any(a and a.annotation is None and a.arg not in ("self", "cls") for a in arguments)
    return missing or node.returns is None


def public(source, is_fault):
    """Return the public functions and methods of a module that have a fault, in lines like ``12: name``."""
    found = []

    def visit(body):
        for node in body:
            if not isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                continue
            if node.name.startswith("_") and node.name != "__init__":
                continue
            if isinstance(node, ast.ClassDef):
                visit(node.body)
                continue
            if is_fault(node):
                found.append(f"{node.lineno}: {node.name}")

    visit(ast.parse(source).body)
    return found


def annotation_faults(folder):
    """Return what `untyped` finds in the modules that must be typed, as sentences."""
    return _in_modules(folder, TYPED, untyped, "does not say all its types")


def option_faults(folder):
    """Return what `by_place` finds in the same modules, as sentences."""
    return _in_modules(folder, TYPED, by_place, "takes more than one option by its place")


def _in_modules(folder, patterns, find, what):
    return [
        f"{path.relative_to(folder)}:{one} {what}"
        for pattern in patterns
        for path in sorted(folder.glob(pattern))
        for one in find(path.read_text(encoding="utf-8"))
    ]


def output(programs, folder, name, *arguments):
    """Return the lines that a program prints of its findings."""
    try:
        done = subprocess.run(
            [programs / name, *arguments], cwd=folder, capture_output=True, encoding="utf-8"
        )
    except OSError as error:
        return [f"{name} does not start: {error}"]
    if done.returncode not in (0, 1):
        return [f"{name} died with {done.returncode}: {(done.stderr or done.stdout)[-500:]}"]
    return done.stdout.splitlines() if done.returncode else []


def package_faults(programs, folder):
    """Return what mypy finds in the Python package, put together as pip does it."""
    return _mypy_of(programs, folder, (("python", "isthmus"), ("core", "isthmus/core")))


def plugin_faults(programs, folder):
    """Return what mypy finds in the plugin, in a folder of its name as QGIS has it."""
    return _mypy_of(programs, folder, [(name, f"isthmus/{name}") for name in PLUGIN])


def _mypy_of(programs, folder, places):
    with tempfile.TemporaryDirectory() as scratch:
        for name, place in places:
            target = Path(scratch) / place
            target.parent.mkdir(exist_ok=True)
            (shutil.copytree if (folder / name).is_dir() else shutil.copy)(folder / name, target)
        options = ("--no-error-summary", "--config-file", folder / "pyproject.toml", "-p", "isthmus")
        return output(programs, Path(scratch), "mypy", *options)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--programs", type=Path, default=Path(sys.executable).parent)
    options = parser.parse_args()
    folder, programs = options.folder.resolve(), options.programs.absolute()

    checks = {
        "ruff": output(programs, folder, "ruff", "check", "--quiet", "--output-format=concise", "."),
        "format": output(programs, folder, "ruff", "format", "--check", "."),
        "mypy": output(programs, folder, "mypy", "--no-error-summary"),
        "types of what is public": annotation_faults(folder),
        "options by name": option_faults(folder),
    }
    if (folder / "plugin.py").is_file():
        checks["mypy of the plugin"] = plugin_faults(programs, folder)
    if (folder / "python").is_dir():
        checks["mypy of the Python package"] = package_faults(programs, folder)
    for check, lines in checks.items():
        print(f"{check}: {'ok' if not lines else f'{len(lines)} lines'}")
        for line in lines:
            print(f"    {line}")
    return any(checks.values())


if __name__ == "__main__":
    sys.exit(main())
