"""The long run: `./run fuzz partition [--polygons 100000] [--seed N]`; with a file: that case again.

Works through the real Processing tools in one QGIS process. A failure is saved under build/fuzz as a case
that can be run again, made as small as possible, and the run goes on.
"""

import argparse
import faulthandler
import sys
import tempfile
import time
import traceback
from pathlib import Path

faulthandler.enable()
ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "fuzz"
sys.path.insert(0, str(ROOT / "tests"))

import conftest  # noqa: E402, F401  makes the package isthmus
import hypothesis  # noqa: E402
import numpy as np  # noqa: E402
from qgis.core import QgsApplication  # noqa: E402

BATCH = 25  # cases between reports


def start():
    """A QGIS with the provider."""
    application = QgsApplication([], False)
    application.initQgis()
    sys.path.append(f"{QgsApplication.pkgDataPath()}/python/plugins")
    from processing.core.Processing import Processing

    Processing.initialize()
    from isthmus.algorithms.provider import IsthmusProvider

    provider = IsthmusProvider()
    QgsApplication.processingRegistry().addProvider(provider)
    return application, provider


def one(case, counts=None):
    """Run a case and check it."""
    import cases
    import holds

    faulthandler.dump_traceback_later(300.0, exit=True)  # a loop that asks nobody
    (BUILD / "running.json").parent.mkdir(parents=True, exist_ok=True)
    case.save(BUILD / "running.json")  # what was running, should the process die
    outcome = cases.run(case)
    if outcome is None:
        if counts is not None:
            counts["layers that their format cannot hold"] += 1
        return
    try:
        found = holds.check(case, outcome, np.random.default_rng(len(case.features)))
    finally:
        cases.clean(outcome)
        faulthandler.cancel_dump_traceback_later()
    if counts is not None:
        counts.update(found)


def problem(case):
    """What is wrong with a case, in one line; '' if nothing."""
    try:
        one(case)
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"{type(error).__name__} in {place.name}: {error}"
    return ""


def kind(text):
    """What makes two problems the same, whatever their numbers."""
    return "".join(c for c in text if not c.isdigit())[:60]


def smaller(case, seconds=60.0):
    """The case with as few features, candidate lines and vertices as show the same problem."""
    import hostile

    wanted, end = kind(problem(case)), time.monotonic() + seconds
    if not wanted:
        return case

    def shows(candidate):
        return time.monotonic() < end and kind(problem(candidate)) == wanted

    def fewer(items, make):
        """Leave out ever smaller runs of items."""
        items, size = list(items), max(1, len(items) // 2)
        while True:
            place, before = 0, len(items)
            while place < len(items):
                rest = items[:place] + items[place + size:]
                if shows(make(rest)):
                    items = rest
                else:
                    place += size
            if size == 1 and len(items) == before:
                return items
            size = max(1, size // 2)

    case = case._replace(features=fewer(case.features, lambda f: case._replace(features=f)))
    if case.lines:
        case = case._replace(lines=fewer(case.lines, lambda x: case._replace(lines=x)))
    plain = case._replace(fields=[("name", "String")], features=[(g, ["x"]) for g, _ in case.features])
    if shows(plain):
        case = plain
    for name in ("source", "sink"):
        if shows(case._replace(**{name: "memory"})):
            case = case._replace(**{name: "memory"})
    for k, (text, values) in enumerate(case.features):
        if text is None or text[:2] != "01" or time.monotonic() > end:
            continue
        data = bytes.fromhex(text)
        polygons = [[ring[:-1] for ring in polygon] for polygon in hostile.read_wkb(data)]
        if any(ring.shape[1] > 2 for polygon in polygons for ring in polygon):
            continue

        def make(polygons, k=k, values=values, multi=data[1] == 6):
            features = list(case.features)
            features[k] = (hostile.write_wkb(polygons, multi=multi).hex(), values)
            return case._replace(features=features)

        polygons = fewer(polygons, make)
        for p in range(len(polygons)):
            polygons[p] = fewer(polygons[p], lambda x, p=p: make([*polygons[:p], x, *polygons[p + 1:]]))
            for r in range(len(polygons[p])):
                rows = fewer(
                    polygons[p][r],
                    lambda x, p=p, r=r: make([
                        [np.array(x).reshape(-1, 2) if (i, j) == (p, r) else polygons[i][j]
                         for j in range(len(polygons[i]))] for i in range(len(polygons))
                    ]),
                )
                polygons[p][r] = np.array(rows).reshape(-1, 2)
        if shows(make(polygons)):
            case = make(polygons)
    return case


def batch(strategy, seed, examples, counts, stop):
    """Draw and run cases; return those that fail, with what was said."""
    failed = []

    @hypothesis.seed(seed)
    @hypothesis.settings(
        max_examples=examples, deadline=None, database=None, report_multiple_bugs=False,
        phases=[hypothesis.Phase.generate], suppress_health_check=list(hypothesis.HealthCheck),
    )
    @hypothesis.given(strategy)
    def draw(case):
        if stop():
            return
        try:
            one(case, counts)
        except Exception:
            failed.append((case, traceback.format_exc()))

    draw()
    return failed


def from_outside(count, seed, counts):
    """So many cases through qgis_process; returns (path, text) of failures."""
    import cases
    import holds
    import outside

    drawn, failures = [], []

    @hypothesis.seed(seed)
    @hypothesis.settings(
        max_examples=4 * count, deadline=None, database=None, phases=[hypothesis.Phase.generate],
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    @hypothesis.given(cases.cases(largest=25))
    def draw(case):
        if not any(isinstance(value, dict) for value in case.parameters.values()):
            drawn.append(case._replace(lines=None))

    draw()
    outside.prepare()
    for number, case in enumerate(drawn[:count]):
        sink = ["gpkg", "shp", "geojson", "gpkg", "nowhere"][number % 5]
        case = case._replace(sink=sink, room=(None, 20_000, 150_000)[number % 3])
        try:
            with tempfile.TemporaryDirectory(prefix="isthmus-fuzz-") as folder:
                done = outside.run(case, folder)
                if done is None:
                    continue
                end = outside.check(case, folder, done, holds.refusal(case))
            counts["runs of qgis_process"] += 1
            counts[f"runs of qgis_process, {end}"] += 1
        except Exception as error:
            path = BUILD / f"outside-{seed}-{number}.json"
            case.save(path, trace=traceback.format_exc())
            failures.append((path.relative_to(ROOT), f"{type(error).__name__}: {error}"[:2000]))
            print(f"failure {path}: {failures[-1][1]}", flush=True)
    return failures


def report(counts, failures, seconds, seed, polygons):
    """What was done, as printed."""
    first = ["polygons", "features", "runs", "features solved", "polygons solved",
             "features passed through", "polygons passed through", "parts", "cuts",
             "polygons whose dilations were checked", "dilations checked", "brute-force comparisons"]
    print(f"\nisthmus fuzz: seed {seed}, {seconds:.0f} s")
    for name in first + sorted(set(counts) - set(first)):
        print(f"  {counts[name]:>10,}  {name}")
    print(f"  {len(failures):>10,}  failures")
    for path, text in failures:
        print(f"    {path}: {text}")
    sys.stdout.flush()


def replay(path):
    import cases

    case = cases.Case.load(path)
    print(f"{len(case.features)} features, {case.tool}, {case.parameters}")
    try:
        one(case)
    except Exception:
        traceback.print_exc()
        return 1
    print("nothing wrong")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", nargs="?", help="a saved case to run again")
    parser.add_argument("--polygons", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--batch", type=int, default=0, help="the batch to begin with")
    parser.add_argument("--smaller", type=float, default=60.0, help="seconds to make a failure smaller")
    arguments = parser.parse_args()
    application, provider = start()
    import cases
    import holds

    cases.watch({type(tool) for tool in provider.algorithms()})
    if arguments.case:
        return replay(arguments.case)

    counts, failures, seen = holds.Counts(), [], {}
    begin, number, told = time.monotonic(), arguments.batch, time.monotonic()
    while counts["polygons"] < arguments.polygons:
        seed = arguments.seed * 1_000_003 + number
        failed = batch(cases.cases(), seed, BATCH, counts,
                       lambda: counts["polygons"] >= arguments.polygons)
        number += 1
        for case, text in failed:
            line = text.strip().splitlines()[-1]
            what = kind(problem(case))
            seen[what] = seen.get(what, 0) + 1
            if seen[what] <= 3:
                small = smaller(case, arguments.smaller)
                path = BUILD / f"failure-{seed}-{len(failures)}.json"
                small.save(path, problem=problem(small), trace=text, seed=seed)
                failures.append((path.relative_to(ROOT), line[:300]))
                print(f"failure {path}: {line[:300]}", flush=True)
            else:
                failures.append((f"batch {seed}", line[:300]))
        if time.monotonic() - told > 30.0:
            told = time.monotonic()
            print(f"{counts['polygons']:,} polygons, {len(failures)} failures, {told - begin:.0f} s",
                  flush=True)
    print(f"{counts['polygons']:,} polygons done; from outside, and a crowd", flush=True)
    failures += from_outside(max(5, arguments.polygons // 5000), arguments.seed, counts)
    try:
        import crowd

        counts.update(crowd.run(arguments.polygons, arguments.seed))
    except Exception as error:
        failures.append(("crowd", f"{type(error).__name__}: {error}"))
    report(counts, failures, time.monotonic() - begin, arguments.seed, counts["polygons"])
    return 1 if failures else 0


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    import os

    os._exit(code)  # QGIS takes its time to leave, or crashes on the way
