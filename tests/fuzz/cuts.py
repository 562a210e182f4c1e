"""Fuzz the tools that cut: `./run fuzz partition [--polygons 20000] [--seed N]`; with a file: that case again.

Works through the real Processing tools; see `frame` for how cases are drawn, run and saved, `cases` for what
is in one, and `holds` for what must be so.
"""

import sys
import tempfile
import traceback
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent)]

import frame  # noqa: E402
import cases  # noqa: E402
import crowd as many  # noqa: E402
import hostile  # noqa: E402
import holds  # noqa: E402
import numpy as np  # noqa: E402
import outside  # noqa: E402

TOOLS = {"partition": cases.cases()}
dump, load = cases.Case.dump, cases.Case.load


def start():
    from qgis.core import QgsApplication

    provider = QgsApplication.processingRegistry().providerById("isthmus")
    cases.watch({type(tool) for tool in provider.algorithms()})


def problem(case, counts):
    """Raise what is wrong with a case."""
    outcome = cases.run(case)
    if outcome is None:
        counts["layers that their format cannot hold"] += 1
        return ""
    try:
        counts.update(holds.check(case, outcome, np.random.default_rng(len(case.features))))
    finally:
        cases.clean(outcome)
    return ""


def smaller(case, shows):
    """As few features, candidate lines, fields, rings and vertices as show the same."""
    for name in ("features", "lines"):
        if getattr(case, name):
            left = frame.fewer(getattr(case, name), lambda x, name=name: shows(case._replace(**{name: x})))
            case = case._replace(**{name: left})
    plain = {"fields": [("name", "String")], "features": [(g, ["x"]) for g, _ in case.features]}
    for change in (plain, {"source": "memory"}, {"sink": "memory"}):
        if shows(case._replace(**change)):
            case = case._replace(**change)
    for k, (text, values) in enumerate(case.features):
        if text is None or text[:2] != "01":
            continue
        data = bytes.fromhex(text)
        polygons = [[ring[:-1] for ring in polygon] for polygon in hostile.read_wkb(data)]
        if any(ring.shape[1] > 2 for polygon in polygons for ring in polygon):
            continue

        def make(polygons, k=k, values=values, multi=data[1] == 6):
            features = list(case.features)
            rings = [[np.array(ring).reshape(-1, 2) for ring in polygon] for polygon in polygons]
            features[k] = (hostile.write_wkb(rings, multi=multi).hex(), values)
            return case._replace(features=features)

        polygons = frame.less(polygons, lambda polygons: shows(make(polygons)), 3)
        if shows(make(polygons)):
            case = make(polygons)
    return case


def after(count, seed, counts):
    """Cases through qgis_process, and a crowd."""
    yield from from_outside(max(5, count // 5000), seed, counts)
    for counted, wrong in crowd(count, seed):
        counts.update(counted)
        if wrong:
            yield "crowd", None, wrong


def crowd(count, seed):
    """One layer of so many small features."""
    try:
        yield many.run(count, seed), ""
    except Exception:
        yield {}, traceback.format_exc()


def from_outside(count, seed, counts):
    """So many cases through qgis_process."""
    drawn = []

    def use(case):
        if not any(isinstance(value, dict) for value in case.parameters.values()):
            drawn.append(case._replace(lines=None))

    frame.draw(cases.cases(largest=25), seed, 4 * count, use)
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
            counts[f"runs of qgis_process, {end}"] += 1
        except Exception:
            yield f"outside-{seed}-{number}", case, traceback.format_exc().splitlines()[-1]


if __name__ == "__main__":
    frame.main(sys.modules[__name__])
