"""Draw the README's picture of the Python package: ``./run docs python_picture``.

Nested parts of countries of QGIS's world map at three values of tau, by ``isthmus.hierarchy`` of the files here,
in docs/pictures/python.png.
"""

import numpy as np
from maps import LAND_PARTS, Panel, classes, fill, frame_of, memory, picture, shapes, start, stop, world

TAUS = (8.0, 3.0, 1.8)
CRS = "EPSG:3035"
FRAME = (-11.0, 50.0, 32.0, 71.5)


def main():
    application = start()
    import conftest

    package = conftest._load("isthmus_package", conftest.ROOT / "python", conftest.ROOT)
    countries = shapes(world())
    found = package.hierarchy(countries, crs="EPSG:4326")
    fields, parts = found.part_fields, np.asarray(found.parts)
    panels = []
    for tau in TAUS:
        there = (fields["from_tau"] <= tau) & (tau < fields["to_tau"])
        source = fields["source"][there]
        # the number of a part at this tau within its country, by size
        place = np.zeros(len(source), dtype=int)
        for country in np.unique(source):
            own = np.flatnonzero(source == country)
            place[own[np.argsort([-one.area for one in parts[there][own]], kind="stable")]] = np.arange(
                len(own)
            )
        layer = memory("MultiPolygon", list(parts[there]), colour=(place % len(LAND_PARTS)).tolist())
        coloured = classes(layer, "colour", dict(enumerate(LAND_PARTS)), "#8a857b", 0.12)
        frame = frame_of(CRS, *FRAME)
        panels.append(
            Panel([coloured, fill(world(), "#e9e5dc")], frame, CRS, f"from_tau <= {tau:g} < to_tau")
        )
    picture("python", panels)
    stop(application)


if __name__ == "__main__":
    main()
