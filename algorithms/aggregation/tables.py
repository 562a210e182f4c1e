"""Tables of thresholds and class distances for ``isthmus:aggregate``."""

import math

from qgis.core import QgsFeatureRequest, QgsProcessingException

from . import areas as layer


def thresholds(tool, parameters, context, feedback, classes):
    """Return the smallest size of a region of each class; infinite where it is excluded."""
    import numpy as np

    least = tool.parameterAsDouble(parameters, tool.THRESHOLD, context)
    theta = {one: least for one in classes}
    source = tool.parameterAsSource(parameters, tool.THRESHOLDS, context)
    known = set(classes)
    if source is not None:
        for name, value in _rows(source, "THRESHOLDS", ("class", "threshold")):
            if layer.text(name) in known:
                theta[layer.text(name)] = math.inf if layer.text(value) is None else _number(
                    value, f"the threshold of class {layer.text(name)}"
                )
    text = tool.parameterAsString(parameters, tool.EXCLUDED, context) or ""
    for one in filter(None, (part.strip() for part in text.split(","))):
        if one in known:
            theta[one] = math.inf
        else:
            feedback.pushInfo(f"The excluded class {one} is not on the map.")
    return np.array([theta[one] for one in classes])


def distances(tool, parameters, context, feedback, classes):
    """Return the distance of each class to each other.

    Raises
    ------
    QgsProcessingException
        If the table lacks a pair of classes that are on the map.
    """
    import numpy as np

    from ...core.aggregation.instance import hierarchical_distance

    kind = tool.parameterAsString(parameters, tool.DISTANCE, context)
    if kind == "code":
        return hierarchical_distance(classes) if classes else np.zeros((0, 0))
    if kind == "equal":
        return 1.0 - np.eye(len(classes))
    source = tool.parameterAsSource(parameters, tool.DISTANCES, context)
    if source is None:
        raise QgsProcessingException(tool.invalidSourceError(parameters, tool.DISTANCES))
    number = {one: k for k, one in enumerate(classes)}
    matrix = np.full((len(classes), len(classes)), np.nan)
    np.fill_diagonal(matrix, 0.0)
    for a, b, value in _rows(source, "DISTANCES", ("from", "to", "distance")):
        a, b = layer.text(a), layer.text(b)
        if a in number and b in number:
            matrix[number[a], number[b]] = _number(value, f"the distance from {a} to {b}")
    known = ~np.isnan(matrix)
    np.fill_diagonal(known, False)
    alone = ~(known.any(axis=0) | known.any(axis=1)) & (len(classes) > 1)
    absent = [one for one, is_alone in zip(classes, alone) if is_alone]
    if absent:
        raise QgsProcessingException(
            f"The table of class distances (DISTANCES) knows nothing of class {', '.join(absent)}, "
            "which is on the map. Add rows from this class to the others."
        )
    one_way = np.isnan(matrix) & ~np.isnan(matrix.T)
    matrix[one_way] = matrix.T[one_way]
    missing = np.argwhere(np.isnan(matrix))
    if len(missing):
        some = ", ".join(f"{classes[a]} to {classes[b]}" for a, b in missing[:8].tolist())
        raise QgsProcessingException(
            f"The table of class distances (DISTANCES) lacks {len(missing)} pairs of classes that are "
            f"on the map: {some}{' ...' * (len(missing) > 8)}. Add rows for them."
        )
    if one_way.any():
        feedback.pushInfo(
            f"{int(one_way.sum())} class distances are listed in one direction only; the other way "
            "they are taken as equal."
        )
    return matrix


def _rows(source, parameter, wanted):
    """Values of some fields of a table, whatever their case; complains of a field it lacks."""
    names = [field.name().lower() for field in source.fields()]
    lacking = [name for name in wanted if name not in names]
    if lacking:
        raise QgsProcessingException(
            f"The table {parameter} has no field {', '.join(lacking)}. It has: {', '.join(names)}."
        )
    index = [names.index(name) for name in wanted]
    for feature in source.getFeatures(QgsFeatureRequest()):
        values = feature.attributes()
        yield tuple(values[k] for k in index)


def _number(value, what):
    """Return a number of at least 0, also from a text column."""
    try:
        number = float(layer.text(value) or "nan")
    except ValueError:
        number = math.nan
    if not 0.0 <= number < math.inf:
        what = what[0].upper() + what[1:]
        raise QgsProcessingException(f"{what} is no number of at least 0: {value}.")
    return number
