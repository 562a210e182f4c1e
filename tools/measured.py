"""Take measured numbers into the text: README.md and the pages in docs/ never have them typed by hand.

    ./run docs

Scripts write what they measure to docs/measured/NAME.json. In the text stand

* numbers, each with the place that it comes from in a comment, which readers do not see:
  ``71<!-- demo.cuts -->`` is the entry "cuts" in demo.json. Decimals are kept as they are in the text;
* tables and commands between ``<!-- table: NAME.ENTRY -->`` or ``<!-- command: NAME.ENTRY -->`` and
  ``<!-- end -->``.

Running this file writes the present numbers, tables and commands into all pages; tests/test_docs.py fails
when a page is not as it would be written.
"""

import json
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TAG = re.compile(r"([-+]?\d[\d,]*(?:\.\d+)?)<!-- (\w+(?:\.[\w-]+)+) -->")
BLOCK = re.compile(r"(<!-- (table|command): (\w+(?:\.[\w-]+)+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def pages(root=ROOT):
    """Return the pages with measured numbers."""
    return [root / "README.md", *sorted((root / "docs").glob("*.md"))]


def note(name, entries, root=ROOT):
    """Merge entries into docs/measured/NAME.json; dicts are merged, too."""
    path = root / "docs" / "measured" / f"{name}.json"
    known = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    path.parent.mkdir(parents=True, exist_ok=True)
    known.update(entries)
    text = json.dumps(known, indent=1, ensure_ascii=False, sort_keys=True)
    path.write_text(text + "\n", encoding="utf-8")


def results(root=ROOT):
    """Return all that was measured, by name."""
    return {
        path.stem: json.loads(path.read_text(encoding="utf-8"))
        for path in (root / "docs" / "measured").glob("*.json")
    }


def entry(measured, key):
    """Return the entry "name.one.other"."""
    found = measured
    for word in key.split("."):
        if not isinstance(found, dict) or word not in found:
            raise KeyError(f"docs/measured has no {key!r} (there is no {word!r})")
        found = found[word]
    return found


def filled(text, measured):
    """Return a page with the measured numbers, tables and commands in their places."""

    def number(match):
        shown, key = match.groups()
        decimals = len(shown.partition(".")[2])
        sign = "+" if shown.startswith("+") else ""
        return f"{entry(measured, key):{sign},.{decimals}f}<!-- {key} -->"

    def block(match):
        head, kind, key, _, end = match.groups()
        found = entry(measured, key)
        return head + (_table(found) if kind == "table" else _command(found)) + end

    return BLOCK.sub(block, TAG.sub(number, text))


def _table(found):
    rows = [found["columns"], ["---"] * len(found["columns"]), *found["rows"]]
    return "\n" + "".join(f"| {' | '.join(row)} |\n" for row in rows) + "\n"


def _command(found):
    return f"```\n{found['command']}\n```\n"


def main():
    measured = results()
    for page in pages():
        text = page.read_text(encoding="utf-8")
        new = filled(text, measured)
        if new != text:
            page.write_text(new, encoding="utf-8")
            print(f"{page.relative_to(ROOT)} has new numbers")


if __name__ == "__main__":
    main()
