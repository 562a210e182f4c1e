"""The words of the plugin in the user's language, and where its help is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QCoreApplication, QTranslator, QUrl

from ..core.errors import Sentence

ROOT = Path(__file__).parents[1]
CONTEXT = "isthmus"


def tr(text: str) -> str:
    """Return a text in the user's language, or as it is where there is no translation."""
    return QCoreApplication.translate(CONTEXT, text)


def spoken(sentence: Any) -> Any:
    """Return a sentence of the core in the user's language; what is no `Sentence` (a name, say) as it is."""
    if not isinstance(sentence, Sentence):
        return sentence
    return tr(sentence.template).format(*map(spoken, sentence.values)) if sentence.values else tr(sentence)


def as_sentence(text: str) -> str:
    """Return a text with a capital letter, and with a full stop if it has no end."""
    return f"{text[0].upper()}{text[1:].rstrip('.')}{'' if text.endswith('?') else '.'}"


def load_translation(language: str | None = None) -> QTranslator | None:
    """Install the translation of QGIS's language, if there is one; return it, to be kept.

    The files are compiled when the zip is made (tools/release.py).
    """
    language = language or QgsApplication.locale()
    translator = QTranslator()
    for name in (language, language[:2]):
        path = ROOT / "i18n" / f"isthmus_{name}.qm"
        if path.exists() and translator.load(str(path)):
            QCoreApplication.installTranslator(translator)
            return translator
    return None


def help_url(name: str = "README") -> str:
    """Return the address of a page of the reference: in the zip as HTML, in a checkout as it is written.

    It is in QGIS's language where there is such a page.
    """
    for folder, suffix in ((ROOT / "help", "html"), (ROOT / "docs" / "reference", "md")):
        for language in (QgsApplication.locale()[:2], "."):
            path = folder / language / f"{name}.{suffix}"
            if path.exists():
                return QUrl.fromLocalFile(str(path)).toString()
    return ""
