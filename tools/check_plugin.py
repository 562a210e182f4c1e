"""Check a plugin's zip by the rules of plugins.qgis.org: ``check_plugin.py ZIP [--online]``.

The rules are those of the site's own code (github.com/qgis/QGIS-Plugins-Website, in qgis-app/plugins:
``validator.py`` for the upload, ``security_scanner.py`` for the scan after it, where any finding of
Bandit or detect-secrets blocks the version), and of its page on publishing. Where the site warns, this
finds a fault. One rule more is ours: what the plugin needs at run time, and no more, is in requirements.txt, which
qpip installs from. Prints what it checked; exits with 1 if there is a fault.
"""

import argparse
import configparser
import io
import json
import re
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request
import zipfile
from pathlib import Path, PurePosixPath
from urllib.parse import urlparse

LARGEST = 25_000_000  # bytes
ONE_BREATH = 500  # characters: what the plugin manager shows without scrolling
REQUIRED = (
    "name", "description", "about", "version", "qgisMinimumVersion", "author", "email", "tracker",
    "repository",
)  # fmt: skip
BOOLEANS = ("experimental", "deprecated", "server", "hasProcessingProvider")
URLS = ("homepage", "tracker", "repository")
FORBIDDEN_FOLDERS = {"__MACOSX", ".git", "__pycache__"}
PROGRAMS = {
    ".exe", ".dll", ".so", ".dylib", ".bat", ".sh", ".ps1", ".cmd", ".pyd", ".pyc", ".pyo", ".o", ".a",
    ".jar", ".class", ".whl", ".egg", ".zip", ".gz", ".xz", ".bz2", ".7z", ".tar", ".deb", ".rpm",
}  # fmt: skip
PROGRAM_STARTS = (b"\x7fELF", b"MZ", b"\xfe\xed\xfa", b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe", b"PK\3\4")
# QGIS was compiled for its own numpy; the others test or build
NO_REQUIREMENTS = {
    "numpy",
    "pip",
    "setuptools",
    "wheel",
    "pytest",
    "pytest-qgis",
    "pytest-xdist",
    "hypothesis",
}
# names and domains that RFC 2606 sets apart: no mail arrives there
PLACEHOLDER = re.compile(r"(^|[@.])(example\.(com|net|org)|example|invalid|test|localhost)$")
# what the site enables of flake8 (management/commands/data/flake8_rules.json)
FLAKE8 = (
    "E101,E711,E712,E713,E714,E721,E722,E731,E741,E742,E743,E901,E902,E999,W605,F402,F403,F404,F405,"
    "F811,F821,F822,F823,F831,F901"
)


# --- the zip and its metadata -------------------------------------------------------------------------


def zip_faults(path):
    """Return what the site would refuse of a zip, or warn of, as sentences; and its metadata."""
    found = []
    size = Path(path).stat().st_size
    if size > LARGEST:
        found.append(f"the zip has {size} bytes; the site takes {LARGEST}")
    try:
        archive = zipfile.ZipFile(path)
    except zipfile.BadZipFile:
        return [*found, "the file is no zip"], {}
    with archive:
        broken = archive.testzip()
        if broken:
            return [*found, f"the zip is damaged at {broken}"], {}
        for info in archive.infolist():
            if not info.is_dir():
                found += file_faults(info, archive.read(info)[:8])
            elif FORBIDDEN_FOLDERS & set(PurePosixPath(info.filename).parts):
                found.append(f"{info.filename} is a folder that no plugin may have")
        files = {name for name in archive.namelist() if not name.endswith("/")}
        tops = sorted({name.split("/")[0] for name in archive.namelist()})
        if len(tops) != 1 or not all("/" in name for name in files):
            return [*found, f"everything must be in one folder; in the zip are {', '.join(tops)}"], {}
        folder = tops[0]
        found += folder_faults(folder)
        for needed in ("__init__.py", "metadata.txt", "LICENSE", "requirements.txt"):
            if f"{folder}/{needed}" not in files:
                found.append(f"{folder}/{needed} is missing")
        metadata = {}
        if f"{folder}/metadata.txt" in files:
            try:
                metadata = read_metadata(archive.read(f"{folder}/metadata.txt"))
            except (configparser.Error, UnicodeDecodeError) as error:
                found.append(f"metadata.txt cannot be read: {error}")
            else:
                found += metadata_faults(metadata, {name[len(folder) + 1 :] for name in files})
        init = f"{folder}/__init__.py"
        if init in files and b"def classFactory(" not in archive.read(init):
            found.append("__init__.py has no function classFactory")
        requirements = f"{folder}/requirements.txt"
        if requirements in files:
            found += requirement_faults(archive.read(requirements).decode("utf-8"))
    return found, metadata


def file_faults(info, start):
    """Return what is wrong with the name, the kind or the rights of a file in the zip."""
    name = PurePosixPath(info.filename)
    found = []
    if name.is_absolute() or ".." in name.parts or "\\" in info.filename:
        found.append(f"{name} is a path that leads out of the folder")
    if FORBIDDEN_FOLDERS & set(name.parts[:-1]):
        found.append(f"{name} is in a folder that no plugin may have")
    if any(part.startswith(".") for part in name.parts):
        found.append(f"{name} is hidden")
    if name.suffix.lower() in PROGRAMS or start.startswith(PROGRAM_STARTS):
        found.append(f"{name} is a program, a library or an archive")
    if info.external_attr >> 16 & 0o111:
        found.append(f"{name} is executable")
    return found


def folder_faults(folder):
    """Return what is wrong with the name of the folder, which is the plugin's id for good."""
    found = []
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]+", folder) or not folder.isidentifier():
        found.append(f"the folder {folder!r} is no Python name of ASCII letters, digits and _")
    if "plugin" in folder.lower():
        found.append(f"the folder {folder!r} has the word plugin in it")
    return found


def requirement_faults(text):
    """Return which packages no user of the plugin should have to install."""
    names = re.findall(r"^\s*([A-Za-z0-9][\w.-]*)", text, re.MULTILINE)
    names = sorted({name.lower().replace("_", "-") for name in names} & NO_REQUIREMENTS)
    return [f"requirements.txt asks for {name}, which the plugin may not install" for name in names]


def read_metadata(data):
    """Return the section [general] as the site reads it: % has a meaning there."""
    parser = configparser.ConfigParser()
    parser.optionxform = str
    parser.read_file(io.StringIO(data.decode("utf-8")))
    return dict(parser.items("general"))


def metadata_faults(metadata, files):
    """Return what is wrong with the metadata.

    Parameters
    ----------
    metadata : dict of str
    files : set of str
        The files of the plugin, relative to its folder.
    """
    found = [f"metadata: {key} is missing or empty" for key in REQUIRED if not metadata.get(key, "").strip()]

    def rule(key, ok, text):
        if metadata.get(key) and not ok(metadata[key].strip()):
            found.append(f"metadata: {key} {text}: {metadata[key]}")

    def is_version(text):
        return re.fullmatch(r"\d+(\.\d+){0,2}", text)

    def is_file(text):
        return text.removeprefix("./") in files

    rule("version", lambda text: re.fullmatch(r"\d+(\.\d+)+", text), "is no number like 1.0.2")
    rule("name", lambda text: "plugin" not in text.lower(), "has the word plugin in it")
    rule("author", lambda text: "/" not in text, "has a slash in it")
    rule("email", lambda text: re.fullmatch(r"[^@\s,;]+@[^@\s,;]+\.[A-Za-z]\S*", text), "is no address")
    rule("qgisMinimumVersion", is_version, "is no version like 3.22")
    rule("qgisMaximumVersion", is_version, "is no version like 3.99")
    rule("icon", is_file, "is not in the zip")
    rule("screenshot", is_file, "is not in the zip")
    for key in BOOLEANS:
        rule(key, lambda text: text.lower() in ("true", "false", "yes", "no"), "is neither True nor False")
    for key in URLS:
        rule(key, is_url, "is no web address")
    rule(
        "homepage",
        lambda text: not is_root(text, metadata.get("repository", "")),
        "is the root of a repository",
    )
    rule(
        "about",
        lambda text: len(text) <= ONE_BREATH and "\n" not in text,
        f"has more than {ONE_BREATH} characters",
    )
    if not metadata.get("changelog", "").strip():
        found.append("metadata: changelog is missing or empty")
    elif metadata.get("version", "") not in metadata["changelog"]:
        found.append(f"metadata: changelog does not tell of version {metadata.get('version')}")
    low, high = metadata.get("qgisMinimumVersion", ""), metadata.get("qgisMaximumVersion", "")
    if is_version(low) and is_version(high) and numbers(low) > numbers(high):
        found.append(f"metadata: qgisMaximumVersion {high} is below qgisMinimumVersion {low}")
    if is_version(low) and not (is_version(high) and numbers(high) >= (4, 0)):
        found.append("metadata: without qgisMaximumVersion=4.99 no QGIS 4 offers the plugin")
    return found


def numbers(version):
    """Return a version as a tuple, to be compared."""
    return tuple(map(int, version.split(".")))


def is_root(text, repository):
    """Return whether a web address is a repository's root, where there is no page for a user."""
    parsed = urlparse(text)
    parts = [part for part in parsed.path.split("/") if part]
    forge = re.search(r"(^|\.)(github|gitlab|codeberg|bitbucket)\.(com|org)$", parsed.hostname or "")
    return (
        text.rstrip("/") == repository.rstrip("/") or bool(forge) and len(parts) <= 2 and not parsed.fragment
    )


def is_url(text):
    """Return whether a text is a web address, and none of the Plugin Builder's."""
    parsed = urlparse(text)
    builders = ("http://bugs", "http://repo", "http://homepage")
    return parsed.scheme in ("http", "https") and bool(parsed.netloc) and text not in builders


# --- what only a network or the owner can tell ----------------------------------------------------------


def placeholders(metadata):
    """Return which keys still are placeholders, as sentences."""
    hosts = {key: urlparse(metadata.get(key, "")).hostname or "" for key in URLS}
    hosts["email"] = metadata.get("email", "")
    return [
        f"{key} is a placeholder, set it before you publish: {metadata[key]}"
        for key, host in hosts.items()
        if PLACEHOLDER.search(host)
    ]


def silent_urls(metadata):
    """Return which addresses do not answer within ten seconds, as sentences."""
    found = []
    for key in URLS:
        if not is_url(metadata.get(key, "")):
            continue
        request = urllib.request.Request(metadata[key], method="HEAD", headers={"User-Agent": "Mozilla/5.0"})
        try:
            with urllib.request.urlopen(request, timeout=10):
                pass
        except (urllib.error.URLError, OSError) as error:
            found.append(f"metadata: {key} does not answer ({error}): {metadata[key]}")
    return found


class Died(Exception):
    """A scanner that has not come to its end, by name."""


# --- the scan after the upload ----------------------------------------------------------------------------


def scan(folder, programs):
    """Return the findings of the site's scanners in an unpacked zip, per scanner.

    Parameters
    ----------
    folder : Path
    programs : Path
        The folder of bandit, detect-secrets and flake8.
    """

    def output(name, *arguments, codes=(0, 1)):
        try:
            done = subprocess.run(
                [programs / name, *arguments], cwd=folder, capture_output=True, encoding="utf-8"
            )
        except OSError as error:
            raise Died(f"{name} does not start: {error}") from error
        if done.returncode < 0:
            raise Died(f"{name} was ended by signal {-done.returncode}: {done.stderr[-500:]}")
        if done.returncode not in codes:
            raise Died(f"{name} failed with {done.returncode}: {(done.stderr or done.stdout)[-500:]}")
        return done.stdout

    report = json.loads(output("bandit", "-r", ".", "-f", "json", "--quiet"))
    bandit = [f"{error['filename']}: {error['reason']}" for error in report["errors"]] + [
        f"{one['filename']}:{one['line_number']}: {one['test_id']} {one['issue_text']}"
        for one in report["results"]
    ]
    results = json.loads(
        output("detect-secrets", "scan", "--all-files", "--exclude-files", r"metadata\.txt", ".")
    )["results"]
    secrets = [f"{name}:{one['line_number']}: {one['type']}" for name in results for one in results[name]]
    # QGS4 are the rules for Qt 6 of flake8-qgis
    style = output(
        "flake8", "--isolated", "--max-line-length=120", f"--select={FLAKE8},QGS4", "."
    ).splitlines()
    return {"Bandit, all severities": bandit, "detect-secrets": secrets, "flake8": style}


def count(sentences):
    """Return how many faults there are, in words."""
    return "ok" if not sentences else "1 fault" if len(sentences) == 1 else f"{len(sentences)} faults"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("zip", type=Path)
    parser.add_argument("--online", action="store_true", help="ask whether the web addresses answer")
    parser.add_argument("--programs", type=Path, default=Path(sys.executable).parent)
    options = parser.parse_args()

    found, metadata = zip_faults(options.zip)
    checks = {"zip and metadata": found}
    notes = placeholders(metadata)
    if options.online:
        checks["web addresses"] = silent_urls(metadata) + notes
        notes = []
    else:
        notes.append(f"{', '.join(URLS)}: answer not checked (no network; --online does)")
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(options.zip) as archive:
        archive.extractall(folder)
        try:
            checks |= scan(folder, options.programs)
        except Died as problem:
            checks["scanners"] = [str(problem)]

    for check, sentences in checks.items():
        print(f"{check}: {count(sentences)}")
        for sentence in sentences:
            print(f"    {sentence}")
    for note in notes:
        print(f"note: {note}")
    return any(checks.values())


if __name__ == "__main__":
    sys.exit(main())
