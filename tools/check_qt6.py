"""Lint for Qt 6 and QGIS 4: ``./run python tools/check_qt6.py FILE_OR_FOLDER ...``.

Qt 6 has enum members in the scope of their enum only, has moved and dropped classes, and PyQt 6 has
dropped some calls. Names are not looked up in a list: they are resolved in the QGIS and PyQt that run
this, and, with ``--stubs``, in the .pyi files of the Python package PyQt6. What cannot be seen there
(calls of methods on objects) follows QGIS's own scripts/pyqt5_to_pyqt6/pyqt5_to_pyqt6.py.
"""

import argparse
import ast
import enum
import functools
import importlib
import re
import sys
from pathlib import Path

SKIPPED = {".git", ".venv", "build", "__pycache__", ".qgis-settings"}
RENAMED_CALLS = {"exec_": "exec", "print_": "print"}
DATE_TIME = "QDateTime needs a QDate and a QTime in Qt 6: QDateTime(QDate(...), QTime(...))"


class Unknown(Exception):
    """An expression that is no name of QGIS or Qt."""


class Stubs:
    """The classes of PyQt 6, read from its .pyi files.

    Parameters
    ----------
    folder : Path
        The folder of the package PyQt6; none of it is imported.
    """

    def __init__(self, folder):
        self.modules, self.unread = {}, set()
        for path in folder.glob("Qt*.pyi"):
            try:
                source = path.read_text(encoding="utf-8")
                # PyQt 6.12 writes (*args, /), which no Python reads
                self.modules[path.stem] = ast.parse(re.sub(r", /(?=[,)])", "", source))
            except SyntaxError:
                self.unread.add(path.stem)
        if not {"QtCore", "QtGui", "QtWidgets"} <= set(self.modules):
            raise FileNotFoundError(f"no .pyi files of PyQt6 in {folder}")

    def problem(self, module, names):
        """Return what PyQt 6 lacks of ``module.names[0].names[1]...``, or ''."""
        if module in self.unread:
            return ""
        if module not in self.modules:
            return f"Qt 6 has no module {module}"
        node = self.modules[module]
        for k, name in enumerate(names):
            node, container = self._member(node, name), node
            if node is None:
                return f"Qt 6 has no {'.'.join([module, *names[: k + 1]])}{self._hint(container, name)}"
            if not isinstance(node, ast.ClassDef):
                break  # a function, a value: what it has is not in the stubs
        return ""

    def _member(self, container, name):
        for node in container.body:
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name:
                return node
            targets = getattr(node, "targets", None) or [getattr(node, "target", None)]
            if any(isinstance(target, ast.Name) and target.id == name for target in targets):
                return node
        for base in getattr(container, "bases", ()):
            base = ast.unparse(base).strip("'\"").split(".")[-1]
            for module in self.modules.values():
                parent = next(
                    (n for n in module.body if isinstance(n, ast.ClassDef) and n.name == base), None
                )
                found = parent and parent is not container and self._member(parent, name)
                if found:
                    return found
        return None

    def _hint(self, container, name):
        if isinstance(container, ast.Module):
            homes = [m for m, tree in self.modules.items() if self._member(tree, name)]
            return f"; it is in {' and '.join(homes)}" if homes else ""
        homes = [n.name for n in container.body if isinstance(n, ast.ClassDef) and self._member(n, name)]
        return f"; write {container.name}.{homes[0]}.{name}" if homes else ""


class Lint(ast.NodeVisitor):
    """Collects the faults of one file as (line, sentence) pairs."""

    def __init__(self, stubs=None):
        self.stubs, self.faults = stubs, []
        self.names = {}  # name in the file -> object of QGIS or Qt
        self.qt = {}  # name in the file -> (module of PyQt, [names])
        self.foreign = set()  # names in the file of something else
        self.guarded = False  # whether an import that fails is caught
        self.classes = []  # the names that the classes around the current node define

    def fault(self, node, text):
        if (node.lineno, text) not in self.faults:
            self.faults.append((node.lineno, text))

    # --- imports

    def visit_Import(self, node):
        for alias in node.names:
            self._check_module(node, alias.name)
            if alias.name.split(".")[0] == "qgis":
                importlib.import_module(alias.name)
                self.names[alias.asname or "qgis"] = (
                    sys.modules[alias.name] if alias.asname else sys.modules["qgis"]
                )
            else:
                self.foreign.add(alias.asname or alias.name.split(".")[0])

    def visit_ImportFrom(self, node):
        module = node.module or ""
        if node.level or not self._check_module(node, module) or module.split(".")[0] != "qgis":
            if any(alias.name == "resources_rc" for alias in node.names):
                self.fault(node, "Qt 6 has no compiled resources: load the files by their paths")
            self.foreign |= {alias.asname or alias.name for alias in node.names}
            return
        for alias in node.names:
            if alias.name == "*":
                self.fault(node, f"import the names of {module} one by one, so that they can be checked")
                continue
            try:
                found = self._import(module, alias.name)
            except (ImportError, AttributeError):
                if not self.guarded:
                    self.fault(node, f"{module} has no {alias.name} in this QGIS")
                continue
            name = alias.asname or alias.name
            self.names[name] = found
            if module.startswith("qgis.PyQt"):
                self._remember_qt(node, name, [*module.split(".")[2:], alias.name])

    def visit_Try(self, node):
        caught = " ".join(ast.unparse(handler.type) for handler in node.handlers if handler.type)
        before = self.guarded
        self.guarded = before or "ImportError" in caught
        for part in node.body:
            self.visit(part)
        self.guarded = before
        for part in [*node.handlers, *node.orelse, *node.finalbody]:
            self.visit(part)

    def _import(self, module, name):
        found = importlib.import_module(module)
        return getattr(found, name) if hasattr(found, name) else importlib.import_module(f"{module}.{name}")

    def _remember_qt(self, node, name, path):
        if not path[0].startswith("Qt"):
            return  # qgis.PyQt.sip, qgis.PyQt.uic
        if path[0] == "Qt":
            self.fault(node, "qgis.PyQt.Qt is gone in Qt 6: import from QtCore, QtGui, QtWidgets ...")
            return
        self.qt[name] = (path[0], path[1:])
        problem = self.stubs and self.stubs.problem(path[0], path[1:])
        if problem and self.guarded:
            del self.qt[name]  # what follows is for Qt 5 alone
        elif problem:
            self.fault(node, problem)

    def _check_module(self, node, module):
        if module.split(".")[0] in ("PyQt5", "PyQt6", "PySide2", "PySide6", "sip"):
            self.fault(node, f"import {module} through qgis.PyQt, which goes with QGIS's own Qt")
            return False
        return True

    # --- names

    def visit_Assign(self, node):
        self.generic_visit(node)
        for target in node.targets:
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                for name, value in zip(target.elts, node.value.elts):
                    self._alias(name, value)
            else:
                self._alias(target, node.value)

    def _alias(self, target, value):
        if not isinstance(target, ast.Name):
            return
        self.names.pop(target.id, None)
        self.qt.pop(target.id, None)
        try:
            self.names[target.id] = self._resolve(value)
        except Unknown:
            return
        root, *path = ast.unparse(value).split(".")
        if root in self.qt:
            module, names = self.qt[root]
            self.qt[target.id] = module, names + path

    def visit_ClassDef(self, node):
        self.classes.append({
            getattr(part, "name", getattr(part, "id", getattr(part, "attr", None)))
            for part in ast.walk(node)
            if isinstance(part, ast.FunctionDef | ast.ClassDef)
            or isinstance(getattr(part, "ctx", None), ast.Store)
        })  # fmt: skip
        self.foreign.add(node.name)
        self.generic_visit(node)
        self.classes.pop()

    def visit_FunctionDef(self, node):
        if node.name in RENAMED_CALLS:
            self.fault(node, f"{node.name} is {RENAMED_CALLS[node.name]} in Qt 6")
        self.generic_visit(node)

    def visit_Name(self, node):
        if node.id == "qApp":
            self.fault(node, "qApp is gone in Qt 6: QApplication.instance()")

    def visit_Attribute(self, node):
        self.generic_visit(node)
        if isinstance(node.ctx, ast.Load):
            self._check_member(node, node.value, node.attr)

    def _check_member(self, node, owner, name):
        text = ast.unparse(owner)
        try:
            found = self._resolve(owner)
        except Unknown:
            scoped = name[0].isupper() and enum_members().get(name)
            if scoped and self._may_be_of_qgis(owner, name):
                self.fault(node, f"{text}.{name} is not in the scope of its enum: {scoped}")
            return
        if isinstance(found, type) and not hasattr(found, name):
            self.fault(node, f"{text} has no {name} in this QGIS")
            return
        kind = type(getattr(found, name, None))
        if is_enum(kind) and not is_enum(found):
            self.fault(node, f"{text}.{name} is not in the scope of its enum: {scope(found, name)}")
        elif self.stubs:
            self._check_qt(node)

    def _may_be_of_qgis(self, owner, name):
        """Whether an object may be one of QGIS or Qt, as far as the file tells."""
        if isinstance(owner, ast.Call) and ast.unparse(owner.func) == "super":
            return True
        while isinstance(owner, ast.Attribute | ast.Call):
            owner = getattr(owner, "value", None) or owner.func
        if not isinstance(owner, ast.Name) or owner.id in self.foreign:
            return False
        return not (owner.id in ("self", "cls") and self.classes and name in self.classes[-1])

    def _check_qt(self, node):
        path = ast.unparse(node).split(".")
        if path[0] in self.qt:
            module, names = self.qt[path[0]]
            problem = self.stubs.problem(module, names + path[1:])
            if problem:
                self.fault(node, problem)

    def _resolve(self, node):
        if isinstance(node, ast.Name) and node.id in self.names:
            return self.names[node.id]
        if isinstance(node, ast.Attribute):
            owner = self._resolve(node.value)
            if hasattr(owner, node.attr):
                return getattr(owner, node.attr)
        raise Unknown

    # --- calls

    def visit_Call(self, node):
        self.generic_visit(node)
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if isinstance(node.func, ast.Attribute) and name in RENAMED_CALLS:
            self.fault(node, f"{name} is {RENAMED_CALLS[name]} in Qt 6")
        elif name == "getattr" and len(node.args) > 1 and isinstance(node.args[1], ast.Constant):
            self._check_member(node, node.args[0], node.args[1].value)
        elif name == "addAction" and len(node.args) >= 4:
            self.fault(node, "addAction with so many arguments differs in Qt 6: make the QAction first")
        elif name == "desktop" and isinstance(node.func, ast.Attribute) and not node.args:
            self.fault(node, "QDesktopWidget is gone in Qt 6: QScreen")
        elif name == "width" and "fontMetrics" in ast.unparse(node.func).replace("QF", "f"):
            self.fault(node, "QFontMetrics.width is gone in Qt 6: horizontalAdvance")
        elif name == "QVariant" and (not node.args or ast.unparse(node.args[0]).startswith("QVariant.")):
            self.fault(node, "a null QVariant is qgis.core.NULL in Qt 6")
        elif name == "QDateTime" and (
            len(node.args) == 8 or len(node.args) == 1 and ast.unparse(node.args[0]).startswith("QDate(")
        ):
            self.fault(node, DATE_TIME)

    def visit_Subscript(self, node):
        self.generic_visit(node)
        if getattr(node.value, "attr", "") == "activated" and ast.unparse(node.slice) == "str":
            self.fault(node, "activated[str] is gone in Qt 6: textActivated")


def is_enum(kind):
    """Return whether a class is an enum of PyQt 5 (sip), of PyQt 6 or of Python."""
    return isinstance(kind, type) and (issubclass(kind, enum.Enum) or type(kind).__name__ == "enumtype")


def scope(owner, name):
    """Return an enum member of a class with its scope, by the names that all versions of QGIS know."""
    kind = type(getattr(owner, name))
    known = [key for key in dir(owner) if getattr(owner, key, None) is kind]
    return f"{owner.__name__}.{known[0]}.{name}" if known else f"{kind.__qualname__}.{name}"


@functools.cache
def enum_members():
    """Return the enum members that a class of QGIS or Qt has out of scope, with their scopes."""
    members = {}
    for module in ("core", "gui", "analysis", "PyQt.QtCore", "PyQt.QtGui", "PyQt.QtWidgets"):
        for owner in vars(importlib.import_module(f"qgis.{module}")).values():
            for name, value in vars(owner).items() if isinstance(owner, type) else ():
                if is_enum(type(value)) and not is_enum(owner):
                    members.setdefault(name, scope(owner, name))
    return members


def faults(source, stubs=None):
    """Return the faults of a Python source as (line, sentence) pairs.

    Parameters
    ----------
    source : str
    stubs : Stubs, optional
    """
    lint = Lint(stubs)
    lint.visit(ast.parse(source))
    return sorted(lint.faults)


def python_files(paths):
    """Return the Python files at or below paths, without what is built or installed."""
    for path in map(Path, paths):
        inside = sorted(path.rglob("*.py")) if path.is_dir() else [path]
        yield from (one for one in inside if not SKIPPED & set(one.relative_to(path).parts))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("paths", nargs="+")
    parser.add_argument("--stubs", type=Path, help="folder of the Python package PyQt6")
    options = parser.parse_args()
    stubs = options.stubs and Stubs(options.stubs)
    files = list(python_files(options.paths))
    found = [
        f"    {path}:{line}: {text}"
        for path in files
        for line, text in faults(path.read_text(encoding="utf-8"), stubs)
    ]
    from qgis.core import Qgis

    against = f"QGIS {Qgis.QGIS_VERSION}" + (" and PyQt 6" if stubs else "")
    verdict = "ok" if not found else "1 fault" if len(found) == 1 else f"{len(found)} faults"
    print(f"Qt 6: {verdict} ({len(files)} files, by the classes of {against})", *found, sep="\n")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
