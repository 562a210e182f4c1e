"""The frame of all fuzzing here: draws cases, runs them in a worker process, and makes what fails smaller.

A fuzzer is a module, such as `cuts` and `maps`, with

    TOOLS                   strategies of cases by name
    start()                 what has to be done once there is a QGIS with the provider
    problem(case, counts)   what is wrong, in words or by an exception, or ''; adds to ``counts``, "polygons" among them
    smaller(case, shows)    the case with as little in it as still ``shows`` the same
    dump(case), load(data)  to and from what JSON can hold
    crowd(count, seed)      one case of very many polygons: what was counted, and what is wrong
    after(count, seed, counts)   more that belongs to a long run: (name, case or None, what is wrong) of each failure

The seed decides everything. A crash or a hang of the worker is a failure as well.
"""

import argparse
import contextlib
import faulthandler
import json
import os
import signal
import subprocess
import sys
import time
import traceback
import zlib
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SAVED = ROOT / "build" / "fuzz"
sys.path[:0] = [str(ROOT / "tests"), str(Path(__file__).resolve().parent), str(ROOT / "tests" / "core")]

import conftest  # noqa: E402, F401  makes the package isthmus
import hypothesis  # noqa: E402

BATCH = 25  # cases of one seed
HANG = 300  # seconds that one case may take
DEATHS = 20  # of workers, before it is given up


def start():
    """A QGIS with the provider; both live as long as what is returned."""
    from qgis.core import QgsApplication

    application = QgsApplication([], False)
    application.initQgis()
    sys.path.append(f"{QgsApplication.pkgDataPath()}/python/plugins")
    from processing.core.Processing import Processing

    Processing.initialize()
    from isthmus.algorithms.provider import IsthmusProvider

    provider = IsthmusProvider()
    QgsApplication.processingRegistry().addProvider(provider)
    return application, provider


def draw(strategy, seed, count, use):
    """Call ``use`` with so many cases."""

    @hypothesis.seed(seed)
    @hypothesis.settings(
        max_examples=count, deadline=None, database=None, phases=[hypothesis.Phase.generate],
        suppress_health_check=list(hypothesis.HealthCheck),
    )  # fmt: skip
    @hypothesis.given(strategy)
    def each(case):
        use(case)

    each()


def kind(wrong):
    """What makes two problems the same, whatever their numbers."""
    return "".join(c for c in wrong.split("\n")[0] if c.isalpha())[:50]


def wrong_with(fuzzer, case, counts=None):
    """What is wrong with a case, in words; an exception of a check is, too."""
    try:
        return fuzzer.problem(case, Counter() if counts is None else counts)
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"{type(error).__name__} in {place.name}: {error}\n{traceback.format_exc()}"


def fewer(items, shows):
    """Leave out ever smaller runs of items, as long as the rest still shows the same."""
    items, size = list(items), max(1, len(items) // 2)
    while True:
        place, before = 0, len(items)
        while place < len(items):
            rest = items[:place] + items[place + size :]
            if shows(rest):
                items = rest
            else:
                place += size
        if size == 1 and len(items) == before:
            return items
        size = max(1, size // 2)


def less(items, shows, depth):
    """Fewer items, and fewer items in each, so many levels deep."""
    items = fewer(items, shows)
    for k in range(len(items) if depth > 1 else 0):
        items[k] = less(items[k], lambda one, k=k: shows([*items[:k], one, *items[k + 1 :]]), depth - 1)
    return items


def attack(fuzzer, tool, seed, count, counts, failures, before=lambda case: None, seconds=60.0):
    """Draw cases of one tool; count, and save the first of each kind that fails, made smaller.

    Parameters
    ----------
    failures : dict
        (file, what is wrong) by kind; added to.
    before : callable
        Told of each case that is run.
    seconds : float
        For making a case smaller.
    """

    def use(case):
        before(case)
        wrong = wrong_with(fuzzer, case, counts)
        name = f"{tool}-{zlib.crc32(kind(wrong).encode()):08x}"
        if not wrong or name in failures:
            counts["failures of a kind known"] += bool(wrong)
            return
        end = time.monotonic() + seconds

        def shows(candidate):
            before(candidate)
            return time.monotonic() < end and kind(wrong_with(fuzzer, candidate)) == kind(wrong)

        small = fuzzer.smaller(case, shows) if shows(case) else case
        failures[name] = save(fuzzer, small, wrong, name)

    draw(fuzzer.TOOLS[tool], seed, count, use)


def save(fuzzer, case, wrong, name):
    """Keep a failure; return where it is, and its first line."""
    SAVED.mkdir(parents=True, exist_ok=True)
    path = SAVED / f"{name}.json"
    path.write_text(json.dumps({"wrong": wrong, "case": fuzzer.dump(case)}, indent=1), encoding="utf-8")
    return str(path.relative_to(ROOT)), wrong.split("\n")[0][:300]


def work(fuzzer, tools, polygons, seed, batch, running, state):
    """The worker: batches, with the case that runs and the counts in files."""
    faulthandler.enable()
    counts, failures = Counter(), {}

    def before(case):
        running.write_text(json.dumps(fuzzer.dump(case)))

    def tell(batch):
        made = json.dumps({"counts": counts, "failures": failures, "batch": batch})
        state.with_suffix(".new").write_text(made)
        state.with_suffix(".new").replace(state)  # never half written

    while counts["polygons"] < polygons:
        attack(fuzzer, tools[batch % len(tools)], seed * 1_000_003 + batch, BATCH, counts, failures, before)
        batch += 1
        tell(batch)
    running.unlink(missing_ok=True)  # what follows may take its time
    for name, case, wrong in fuzzer.after(polygons, seed, counts):
        failures[name] = save(fuzzer, case, wrong, name) if case else (name, wrong)
    tell(batch)


def run(fuzzer, tools, polygons, seed, batch):
    """Fuzz until so many polygons were worked on; print the counts; return the number of failures."""
    counts, failures, deaths = Counter(), {}, 0
    begun = told = time.monotonic()
    SAVED.mkdir(parents=True, exist_ok=True)
    running, state = SAVED / f"running-{os.getpid()}.json", SAVED / f"state-{os.getpid()}.json"
    print(f"seed {seed}, {polygons:,} polygons", flush=True)
    ended = False
    while not ended and deaths <= DEATHS:
        worker = subprocess.Popen([
            sys.executable, fuzzer.__file__, "--worker", str(running), str(state), "--seed", str(seed), "--batch",
            str(batch), "--polygons", str(polygons - counts["polygons"]), "--tool", *tools,
        ])  # fmt: skip
        while worker.poll() is None:
            time.sleep(0.5)
            if time.monotonic() - told > 30.0 and state.exists():
                told = time.monotonic()
                done = counts["polygons"] + json.loads(state.read_text())["counts"].get("polygons", 0)
                print(f"  {done:,} polygons, {told - begun:.0f} s", flush=True)
            with contextlib.suppress(FileNotFoundError):
                if time.time() - running.stat().st_mtime > HANG:
                    worker.send_signal(signal.SIGKILL)
        if state.exists():
            made = json.loads(state.read_text())
            counts.update(made["counts"])
            failures.update(made["failures"])
            batch = made["batch"]
            state.unlink()
        ended = worker.returncode == 0
        if not ended:
            deaths, batch = deaths + 1, batch + 1
            how = "took too long" if worker.returncode == -signal.SIGKILL else f"died ({worker.returncode})"
            name = f"died-{seed}-{batch}"
            failures[name] = (name, how)
            if running.exists():
                failures[name] = save(fuzzer, fuzzer.load(json.loads(running.read_text())), how, name)
                running.unlink()
            ended = counts["polygons"] >= polygons
    for name in sorted(counts):
        print(f"{counts[name]:10,} {name}")
    print(f"{time.monotonic() - begun:.0f} s, seed {seed}, {len(failures)} failures")
    for path, wrong in failures.values():
        print(f"FAILED {path}: {wrong}", flush=True)
    return len(failures)


def replay(fuzzer, path):
    """Run a saved case again; return whether something is wrong."""
    case = fuzzer.load(json.loads(Path(path).read_text(encoding="utf-8"))["case"])
    wrong = wrong_with(fuzzer, case)
    print(wrong or "nothing wrong", flush=True)
    return bool(wrong)


def main(fuzzer):
    """What a fuzzer does when it is started by itself."""
    parser = argparse.ArgumentParser(description=fuzzer.__doc__.splitlines()[0])
    parser.add_argument("case", nargs="?", help="a saved case to run again")
    parser.add_argument("--polygons", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tool", nargs="+", default=list(fuzzer.TOOLS), choices=list(fuzzer.TOOLS))
    parser.add_argument("--batch", type=int, default=0, help="the batch to begin with")
    parser.add_argument(
        "--crowd", type=int, default=0, help="only one case of so many polygons, for each tool"
    )
    parser.add_argument("--worker", nargs=2, type=Path, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if not (chosen.worker or chosen.case or chosen.crowd):
        sys.exit(bool(run(fuzzer, chosen.tool, chosen.polygons, chosen.seed, chosen.batch)))
    lives = start()
    fuzzer.start()
    wrong = False
    if chosen.worker:
        work(fuzzer, chosen.tool, chosen.polygons, chosen.seed, chosen.batch, *chosen.worker)
    elif chosen.case:
        wrong = replay(fuzzer, chosen.case)
    else:
        for counted, said in fuzzer.crowd(chosen.crowd, chosen.seed):
            print(counted, said or "nothing wrong", flush=True)
            wrong |= bool(said)
    sys.stdout.flush()
    os._exit(wrong and bool(lives))  # QGIS takes its time to leave, or crashes on the way
