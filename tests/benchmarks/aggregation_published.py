"""The published instance: the published solution, greedy, and annealing, side by side.

    python tests/benchmarks/aggregation_published.py [--seconds 600 | --steps N] [--out build/aggregation]

Writes a table (published.md) and a picture (published.png). Searched and measured with the distance of
centroids, as the published solution was.
"""

import argparse
from pathlib import Path
from time import perf_counter

import numpy as np
import shapely
from aggregation_data import NOTES, ROOT, buchholz, by_centroids, pieces, published

from isthmus.core.aggregation.annealing import annealing
from isthmus.core.aggregation.greedy import greedy, reach_count
from isthmus.core.aggregation.instance import costs, problems

COUNT = 734
# the four measures weigh otherwise in the published solution: less for length, more for centres
STEERED = {"boundary": 34.0, "centre": 1.8e-4}
COLOURS = {
    2101: "#e8696b", 2112: "#a05a8c", 2114: "#c98f8f", 2201: "#f2a0a0", 2202: "#f2b8a0",
    2213: "#b08a70", 2230: "#c8e08c", 2301: "#8c7f80", 3103: "#555555", 3302: "#9a9aa8",
    4101: "#fbf3c8", 4102: "#d9ecb0", 4103: "#e6dc96", 4104: "#cfa8c8", 4105: "#a4c8b4",
    4107: "#8fbf8a", 4108: "#a8cc8a", 4109: "#ead28c", 4111: "#b0d4cc", 5112: "#8cb8e0",
}  # fmt: skip


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--steps", type=int, default=0, help="instead of seconds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="letters of the rows to run, such as AB")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "aggregation")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)

    shapes, classes, hw_region, hw_class, build = buchholz()
    problem = by_centroids(build(shapes, classes, **NOTES))
    began = perf_counter()
    parts, owner = pieces(shapes)
    split = by_centroids(build(parts, classes[owner], **NOTES))
    splitting = perf_counter() - began
    print(f"{len(shapes)} areas, {len(parts)} pieces at tau = 4 in {splitting:.0f} s", flush=True)

    def cold(some, count, **weights):
        # steered weights only choose; what is reported is measured with those of the notes
        return annealing(
            some._replace(**weights),
            seed=options.seed,
            count=count,
            iterations=options.steps or None,
            seconds=None if options.steps else options.seconds,
        )

    runs = [
        (
            "published (Haunert and Wolff 2010)",
            problem,
            lambda: published(problem, hw_region, hw_class, classes),
        ),
        ("greedy", problem, lambda: greedy(problem)),
        (f"greedy, {COUNT} regions", problem, lambda: reach_count(problem, greedy(problem), COUNT)),
        ("A annealing, cold", problem, lambda: cold(problem, None)),
        (f"B annealing, cold, {COUNT} regions", problem, lambda: cold(problem, COUNT)),
        (
            f"C annealing, cold, {COUNT} regions, steered by {STEERED}",
            problem,
            lambda: cold(problem, COUNT, **STEERED),
        ),
        ("D annealing after partition at tau = 4", split, lambda: cold(split, None)),
        (f"E annealing after partition at tau = 4, {COUNT} regions", split, lambda: cold(split, COUNT)),
    ]
    if options.only:
        runs = [run for run in runs if run[0][1] != " " or run[0][0] in options.only]
    lines = [
        f"Weights {NOTES}; {f'{options.steps:,} steps' if options.steps else f'{options.seconds:.0f} s'} "
        f"of annealing on one core, seed {options.seed}.",
        "",
        "| | total cost | against published | class change | boundary | centre | regions | changed ha "
        "| weighted ha | boundary km (between classes) | mean centre distance m | seconds |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    first, drawn = None, []
    for name, one, run in runs:
        began = perf_counter()
        found = run()
        took = perf_counter() - began
        cost = costs(one, found)
        assert not problems(one, found) or name.startswith("published")
        first = first or cost.total
        lines.append(
            f"| {name} | {cost.total / 1e6:.3f} M | {100 * (cost.total / first - 1):+.2f} % "
            f"| {cost.change / 1e6:.3f} M | {cost.boundary / 1e6:.3f} M | {cost.centre / 1e6:.3f} M "
            f"| {len(found.core)} | {cost.changed_size / 1e4:.1f} | {cost.weighted_change / 1e4:.1f} "
            f"| {cost.region_boundary / 1e3:.1f} ({cost.class_boundary / 1e3:.1f}) "
            f"| {cost.centre_distance:.2f} | {took:.1f} |"
        )
        print(lines[-1], flush=True)
        drawn.append((name, one, found))
        (options.out / "published.md").write_text("\n".join(lines) + "\n")
    draw(options.out / "published.png", shapes, parts, drawn, classes, problem)


def draw(path, shapes, parts, drawn, classes, problem):
    """Draw solutions side by side."""
    try:
        import matplotlib
    except ImportError:
        print("No picture: matplotlib is missing.")
        return
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import PolyCollection

    code = {c: int(v) for c, v in zip(problem.cls.tolist(), classes.tolist())}
    wanted = [d for d in drawn if d[0][:2] != "C "]
    columns = 4
    panels = [("input", None, None), *wanted]
    rows = -(-len(panels) // columns)
    figure, axes = pyplot.subplots(rows, columns, figsize=(6 * columns, 6 * rows), squeeze=False)
    for axis in axes.flat:
        axis.set_axis_off()
        axis.set_aspect("equal")
    for axis, (name, one, found) in zip(axes.flat, panels):
        some = shapes if one is None or len(one.size) == len(shapes) else parts
        if one is None:
            colour = [COLOURS[int(c)] for c in classes]
            outlines, shown = shapes, shapes
        else:
            shown = shapely_regions(some, found.region)
            outlines = shown
            colour = [COLOURS[code[int(one.cls[u])]] for u in found.core]
        order = np.argsort([-shapely.box(*shape.bounds).area for shape in shown])
        # a hole is filled by what lies in it, which is smaller and drawn later
        axis.add_collection(
            PolyCollection(
                [np.array(exterior(shown[k])) for k in order],
                facecolors=[colour[k] for k in order],
                edgecolors="#00000088",
                linewidths=0.15 if one is None else 0.4,
            )
        )
        axis.autoscale_view()
        axis.set_title(f"{name}\n{len(outlines)} {'areas' if one is None else 'regions'}", fontsize=11)
    figure.tight_layout()
    figure.savefig(path, dpi=70, bbox_inches="tight")


def exterior(shape):
    """Coordinates of the largest shell."""
    largest = max(shapely.get_parts(shape), key=lambda part: part.area)
    return largest.exterior.coords


def shapely_regions(shapes, region):
    """Union of the shapes of each region."""
    order = np.argsort(region, kind="stable")
    groups = np.split(order, np.searchsorted(region[order], np.arange(1, region.max() + 1)))
    return [shapely.union_all(shapes[group]) for group in groups]


if __name__ == "__main__":
    main()
