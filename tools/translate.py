"""The German words of the plugin: ``./run python tools/translate.py [--check]``.

Collects what the tools and the window say through tr(), by letting them say it, and keeps i18n/isthmus_de.ts, which Qt
Linguist opens, up to date: new texts come in as unfinished, old ones go. With ``--check`` nothing is written, and
what is missing is told, texts of the code that would reach a user in English only among it. `compiled` makes of it what Qt reads, when the zip is made (tools/release.py).
"""

import ast
import importlib.util
import re
import struct
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FILE = ROOT / "i18n" / "isthmus_de.ts"
CONTEXT = "isthmus"
MAGIC = bytes.fromhex("3cb86418caef9c95cd211cbf60a1bddd")
# What raises a sentence for the user, and what shows one
SAID = {"QgsProcessingException", "PackageError", "IsthmusError", "Unsolvable", "MissingEngine"}
TELLING = {
    "pushInfo", "pushWarning", "reportError", "setProgressText", "refuse", "append", "setText", "setToolTip",
    "setWindowTitle", "pushMessage", "say", "appendPlainText", "QLabel", "QPushButton",
}  # fmt: skip


# --- the file -----------------------------------------------------------------------------------------


def read(text):
    """Return the translations of a .ts file: source to translation, '' where it is unfinished."""
    found = {}
    for message in ET.fromstring(text).iter("message"):
        translation = message.find("translation")
        done = translation is not None and translation.get("type") != "unfinished"
        found[message.findtext("source")] = (translation.text or "") if done else ""
    return found


def write(translations):
    """Return the .ts file of translations."""
    root = ET.Element("TS", version="2.1", language="de")
    context = ET.SubElement(root, "context")
    ET.SubElement(context, "name").text = CONTEXT
    for source in sorted(translations):
        message = ET.SubElement(context, "message")
        ET.SubElement(message, "source").text = source
        translation = ET.SubElement(message, "translation")
        translation.text = translations[source]
        if not translations[source]:
            translation.set("type", "unfinished")
    ET.indent(root, " ")
    head = '<?xml version="1.0" encoding="utf-8"?>\n<!DOCTYPE TS>\n'
    return head + ET.tostring(root, encoding="unicode") + "\n"


def compiled(translations):
    """Return a .qm file: a table of hashes, and behind it the messages (Qt: qtranslator.cpp)."""
    messages, table = b"", []
    for source, translation in sorted(translations.items()):
        if not translation:
            continue
        key, text = source.encode("utf-8"), translation.encode("utf-16-be")
        table.append((_hash(key), len(messages)))
        for tag, data in ((3, text), (6, key), (7, CONTEXT.encode())):
            messages += struct.pack(">BI", tag, len(data)) + data
        messages += b"\x01"
    hashes = b"".join(struct.pack(">II", *one) for one in sorted(table))
    return MAGIC + b"".join(
        struct.pack(">BI", tag, len(data)) + data for tag, data in ((0x42, hashes), (0x69, messages))
    )


def _hash(data):
    value = 0
    for byte in data:
        value = (value << 4) + byte
        high = value & 0xF0000000
        value = (value ^ high >> 24) & ~high & 0xFFFFFFFF
    return value or 1


def faults(wanted, translations):
    """Return what is wrong with translations, as sentences."""
    found = [f"not translated: {text}" for text in sorted(wanted) if not translations.get(text)]
    found += [f"translated, but said nowhere: {text}" for text in sorted(set(translations) - wanted)]
    for source, translation in translations.items():
        for what, pattern in (("fields", r"\{\w*(?::[^{}]+)?\}"), ("tags", r"</?\w+>")):
            if translation and sorted(re.findall(pattern, source)) != sorted(
                re.findall(pattern, translation)
            ):
                found.append(f"other {what} than in the source: {translation}")
        # names of parameters and values are the same in all languages
        for name in re.findall(r"\b(?:[A-Z]+_[A-Z]+|Min[A-Z]\w+|tau)\b", source):
            if translation and not re.search(rf"\b{name}\b", translation):
                found.append(f"{name} is missing: {translation}")
    return found


# --- what is said -------------------------------------------------------------------------------------


def said():
    """Return all texts that are translated: those of the tools as they say them, others as they are in the code."""
    import reference
    from isthmus.algorithms import packages
    from isthmus.algorithms.partition.cutting import PLACES
    from isthmus.algorithms.provider import IsthmusProvider
    from qgis.PyQt.QtCore import QCoreApplication, QTranslator

    texts = {*packages.PURPOSES.values(), *packages.LICENCES.values(), *PLACES, *reference.KINDS.values()}

    class Listener(QTranslator):
        def isEmpty(self):
            return False

        def translate(self, context, source, disambiguation=None, n=-1):
            if context == CONTEXT:
                texts.add(source)
            return source

    listener = Listener()
    QCoreApplication.installTranslator(listener)
    provider = IsthmusProvider()
    provider.refreshAlgorithms()
    provider.longName()
    for tool in provider.algorithms():
        fresh = tool.create()
        for words in (fresh.displayName, fresh.shortDescription, fresh.group, fresh.shortHelpString):
            words()
    QCoreApplication.removeTranslator(listener)
    for _, tree in _modules():
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call) or not isinstance(node.args and _text_of(node), ast.Constant):
                continue
            word = _text_of(node).value
            if _called(node) in ("tr", "Sentence"):
                texts.add(word)
            elif _called(node) == "counted":
                texts |= {word, f"{word}s"}
    return texts


def _modules():
    """The modules that speak to users, with their trees."""
    paths = [path for folder in ("gui", "algorithms", "core") for path in (ROOT / folder).rglob("*.py")]
    for path in sorted(paths) + [ROOT / "tools" / "reference.py"]:
        yield path.relative_to(ROOT), ast.parse(path.read_text(encoding="utf-8"))


def _called(node):
    return getattr(node.func, "id", getattr(node.func, "attr", "")) if isinstance(node, ast.Call) else ""


def _text_of(node):
    """The text among the arguments of tr(text), Sentence(text, *values) or counted(number, text)."""
    return node.args[0 if _called(node) == "Sentence" else -1]


def untold(modules, texts):
    """Return texts in the code that a user may read, but that nobody would translate, as sentences.

    A text counts where it has two words in a row and is handed to a message, an error or a caller: what is said
    to programmers (ValueError), and what the tools said through tr() (`texts`), does not.
    """
    found = []
    for path, tree in modules:
        for node in ast.walk(tree):
            for part in _messages(node):
                prose = "".join(
                    piece.value if isinstance(piece, ast.Constant) else "{}"
                    for piece in (part.values if isinstance(part, ast.JoinedStr) else [part])
                )
                if (
                    re.search(r"[a-z{}]{2,} [a-z]{2,}", prose)
                    and prose not in texts
                    and not re.search(r"^\s*<|^\w+,\w|font:|pip ", prose)
                ):
                    found.append(f"not to be translated: {path}:{part.lineno}: {prose}")
    return found


def _messages(node):
    """The bare texts that a statement or a call hands on to a user."""
    if isinstance(node, ast.Raise):
        inside = node.exc.args if _called(node.exc) in SAID else []
    elif isinstance(node, (ast.Return, ast.Assign, ast.AugAssign)):
        inside = [node.value]
    elif _called(node) in TELLING:
        inside = node.args
    else:
        return
    waiting = [one for one in inside if one is not None]
    while waiting:
        one = waiting.pop()
        if isinstance(one, ast.JoinedStr) or isinstance(one, ast.Constant) and isinstance(one.value, str):
            yield one
        elif isinstance(one, (ast.IfExp, ast.BoolOp, ast.BinOp, ast.Tuple, ast.List, ast.Dict)):
            fields = ("body", "orelse", "values", "left", "right", "elts")
            for field in fields:
                value = getattr(one, field, [])
                waiting += value if isinstance(value, list) else [value]


def main():
    if "isthmus" not in sys.modules:
        spec = importlib.util.spec_from_file_location(
            "isthmus", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
        )
        sys.modules["isthmus"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules["isthmus"])
    from qgis.core import QgsApplication

    app = QgsApplication([], False)
    app.initQgis()
    wanted = said()
    old = read(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    if "--check" not in sys.argv:
        old = {text: old.get(text, "") for text in wanted}
        FILE.write_text(write(old), encoding="utf-8")
    found = faults(wanted, old) + untold(_modules(), wanted)
    print(f"German: {len(wanted)} texts, {'ok' if not found else f'{len(found)} faults'}")
    for sentence in found:
        print(f"    {sentence}")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
