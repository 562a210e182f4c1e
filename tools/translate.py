"""The German words of the plugin: ``./run python tools/translate.py [--check]``.

Collects what the tools and the window say through tr(), by letting them say it, and keeps i18n/isthmus_de.ts, which Qt
Linguist opens, up to date: new texts come in as unfinished, old ones go. With ``--check`` nothing is written, and
what is missing is told. `compiled` makes of it what Qt reads, when the zip is made (tools/release.py).
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
    """Return all texts that go through tr(): those of the tools as they say them, those of the window by the code."""
    from isthmus.algorithms import packages
    from isthmus.algorithms.partition.cutting import PLACES
    from isthmus.algorithms.provider import IsthmusProvider
    from qgis.PyQt.QtCore import QCoreApplication, QTranslator

    texts = {*packages.PURPOSES.values(), *packages.LICENCES.values(), *PLACES}

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
    for folder in ("gui", "algorithms"):
        for path in (ROOT / folder).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.Call) or not isinstance(
                    node.args and node.args[-1], ast.Constant
                ):
                    continue
                word = node.args[-1].value
                if getattr(node.func, "id", "") == "tr":
                    texts.add(word)
                elif getattr(node.func, "id", "") == "counted":
                    texts |= {word, f"{word}s"}
    return texts


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
    found = faults(wanted, old)
    print(f"German: {len(wanted)} texts, {'ok' if not found else f'{len(found)} faults'}")
    for sentence in found:
        print(f"    {sentence}")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
