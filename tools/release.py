"""Make the plugin's zip from the last commit: ``./run zip``, or ``./run release`` for one to publish.

What git archives is completed by what is made only here: the owner's addresses (owner.ini) and the changes of this
version (CHANGELOG.md) in metadata.txt, the translation that Qt reads, and the reference as HTML for the buttons *Help*.
"""

import argparse
import configparser
import html
import io
import re
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

import translate  # noqa: E402
from check_plugin import placeholders  # noqa: E402

PAGE = """<!DOCTYPE html>
<html lang="{language}"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em }}
table {{ border-collapse: collapse }} td, th {{ border: 1px solid #bbb; padding: .3em .6em; text-align: left }}
td {{ vertical-align: top }} code, pre {{ background: #eee }} pre {{ padding: .6em; overflow: auto }}
</style></head><body>
<p><a href="README.html">Isthmus: {contents}</a></p>
{body}
</body></html>
"""


def git(*arguments):
    """Return what a command of git prints, as bytes."""
    return subprocess.run(["git", "-C", str(ROOT), *arguments], check=True, stdout=subprocess.PIPE).stdout


def show(name):
    """Return a file of the last commit."""
    return git("show", f"HEAD:{name}").decode("utf-8")


def metadata(text, owner, changes):
    """Return metadata.txt with the owner's settings and the changes of its version.

    Parameters
    ----------
    text, owner, changes : str
        Of metadata.txt, owner.ini and CHANGELOG.md.
    """
    settings = configparser.ConfigParser(interpolation=None)
    settings.read_string(owner)
    lines = [
        line
        for line in text.rstrip().splitlines()
        if not line.startswith("#") and line.partition("=")[0] not in settings["owner"]
    ]
    version = re.search(r"^version=(.*)$", text, re.MULTILINE)[1]
    said = changes_of(changes, version)
    # the percent sign has a meaning for those who read this
    said = said.replace(" %", " per cent").replace("%", " per cent").replace("`", "")
    said = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", said).splitlines()
    return "\n".join([
        *lines, *(f"{key}={value}" for key, value in settings["owner"].items()),
        f"changelog=Version {version}", *(f"  {line}" for line in said if line.strip()), "",
    ])  # fmt: skip


def changes_of(text, version):
    """Return the section of a version in CHANGELOG.md."""
    match = re.search(rf"^## {re.escape(version)}\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    if match is None:
        raise SystemExit(f"CHANGELOG.md has no section for version {version} of metadata.txt.")
    return match[1].strip()


def html_page(text, language="en"):
    """Return a page of the reference as HTML; it has the Markdown that tools/reference.py writes."""
    body, rows, code = [], [], None
    for line in [*text.splitlines(), ""]:
        if line.startswith("```"):
            if code is None:
                code = []
            else:
                body.append(f"<pre>{html.escape(chr(10).join(code))}</pre>")
                code = None
        elif code is not None:
            code.append(line)
        elif line.startswith("|"):
            rows.append(line)
        else:
            if rows:
                body.append(_table(rows))
                rows = []
            heading = re.match(r"(#+) (.*)", line)
            if heading:
                body.append(f"<h{len(heading[1])}>{_inline(heading[2])}</h{len(heading[1])}>")
            elif line.strip():
                body.append(f"<p>{_inline(line)}</p>")
    title = re.search(r"^# (.*)$", text, re.MULTILINE)[1]
    contents = {"de": "Referenz"}.get(language, "reference")
    return PAGE.format(language=language, title=html.escape(title), contents=contents, body="\n".join(body))


def _table(rows):
    def cells(row, tag):
        found = re.split(r"(?<!\\)\|", row.strip().strip("|"))
        return "<tr>" + "".join(f"<{tag}>{_inline(cell.strip())}</{tag}>" for cell in found) + "</tr>"

    return "\n".join(["<table>", cells(rows[0], "th"), *(cells(row, "td") for row in rows[2:]), "</table>"])


def _inline(text):
    pieces = re.split(r"`([^`]*)`", text)
    for k, piece in enumerate(pieces):
        piece = html.escape(piece.replace("\\|", "|"), quote=False)
        if k % 2:
            pieces[k] = f"<code>{piece}</code>"
            continue
        piece = re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", piece)
        piece = re.sub(r"\*([^*]+)\*", r"<i>\1</i>", piece)
        pieces[k] = re.sub(r"\[([^]]*)\]\(([\w./]+)\.md\)", r'<a href="\2.html">\1</a>', piece)
    return "".join(pieces)


def make(path):
    """Write the zip; return its metadata."""
    archive = git("archive", "--format=zip", "--prefix=isthmus/", "HEAD")
    data = metadata(show("metadata.txt"), show("owner.ini"), show("CHANGELOG.md"))
    with zipfile.ZipFile(io.BytesIO(archive)) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for info in old.infolist():
            if info.filename != "isthmus/metadata.txt":
                new.writestr(info, old.read(info))
        made = {"metadata.txt": data}
        names = git("ls-tree", "-r", "--name-only", "HEAD", "docs/reference/", "i18n/").decode().splitlines()
        for name in map(Path, names):
            if name.suffix == ".md":
                page = name.relative_to("docs/reference")
                language = page.parent.name or "en"
                made[f"help/{page.with_suffix('.html').as_posix()}"] = html_page(
                    show(name.as_posix()), language
                )
            elif name.suffix == ".ts":
                made[f"i18n/{name.stem}.qm"] = translate.compiled(translate.read(show(name.as_posix())))
        for name, content in made.items():
            info = zipfile.ZipInfo(f"isthmus/{name}", old.infolist()[0].date_time)
            info.external_attr, info.compress_type = 0o100644 << 16, zipfile.ZIP_DEFLATED
            new.writestr(info, content)
    parser = configparser.ConfigParser()
    parser.optionxform = str
    parser.read_string(data)
    return dict(parser["general"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--release", action="store_true", help="with the version in its name, if it may be published"
    )
    options = parser.parse_args()
    build = ROOT / "build"
    build.mkdir(exist_ok=True)
    path = build / "isthmus.zip"
    general = make(path)
    if options.release:
        problems = placeholders(general)
        tags = [tag for tag in git("tag", "--points-at", "HEAD").decode().split() if re.match(r"v?\d", tag)]
        if tags and f"v{general['version']}" not in tags:
            problems.append(
                f"the tag {' '.join(tags)} is not v{general['version']}, the version of metadata.txt"
            )
        if problems:
            path.unlink()
            raise SystemExit("no release: " + "; ".join(problems) + ". The addresses are in owner.ini.")
        path = path.rename(build / f"isthmus-{general['version']}.zip")
    print(
        f"isthmus: made {path.relative_to(ROOT)} from commit {git('rev-parse', '--short', 'HEAD').decode().strip()}",
        file=sys.stderr,
    )


if __name__ == "__main__":
    main()
