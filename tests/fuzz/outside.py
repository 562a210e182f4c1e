"""Cases through qgis_process: whether the process lives can only be seen from outside."""

import json
import os
import resource
import shutil
import signal
import subprocess

import cases

QGIS_PROCESS = shutil.which("qgis_process.bin") or shutil.which("qgis_process")


def prepare():
    """Let qgis_process, with the profile that `./run` made, know the plugin."""
    done = subprocess.run(
        [QGIS_PROCESS, "plugins", "enable", "isthmus"],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
    )
    assert "nabled" in done.stdout, done.stdout + done.stderr


def run(case, folder, seconds=300):
    """Run a case by qgis_process, everything in GeoPackages in a folder; see `check`.

    Returns
    -------
    CompletedProcess, or None where the layer cannot be made.
    """
    layer = cases.make_layer("in", case.wkb_type, case.crs, case.fields, case.features)
    layer = cases.as_file(layer, "gpkg", folder)
    if layer is None:
        return None
    values = dict(case.parameters, INPUT=layer.source())
    del layer
    ending = "gpkg" if case.sink in ("memory", "nowhere") else case.sink
    for name in ["OUTPUT"] + ["CUTS"] * (case.tool != "tradeoff"):
        values[name] = f"{folder}/{name}.{ending}"
        if case.sink == "nowhere":
            values[name] = f"/proc/nowhere/{name}.gpkg"
    command = [QGIS_PROCESS, "run", f"isthmus:{case.tool}", "--json"]
    command += [f"--{name}={value}" for name, value in values.items() if not isinstance(value, dict)]

    def small_files():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        if case.room is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (case.room, resource.RLIM_INFINITY))

    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=seconds,
        stdin=subprocess.DEVNULL,
        env=os.environ,
        preexec_fn=small_files,
    )


def check(case, folder, done, refused):
    """The process ended by itself; an error is told in words; a result can be read.

    Parameters
    ----------
    done : CompletedProcess
    refused : str
        The parameter that must be refused, or ''.

    Returns
    -------
    str
        'solved' or 'refused'.
    """
    said = done.stdout + done.stderr
    assert done.returncode >= 0, f"ended by signal {-done.returncode}: {said[-2000:]}"
    assert "Traceback" not in said, said[-2000:]
    if done.returncode == 0:
        assert not refused and case.sink != "nowhere", said[-2000:]
        results = json.loads(done.stdout)["results"]
        if case.tool == "tradeoff":
            return "solved"
        layer = cases.QgsVectorLayer(f"{folder}/OUTPUT.{results['OUTPUT'].rpartition('.')[2]}")
        assert layer.isValid() and layer.featureCount() == results["PART_COUNT"]
        return "solved"
    assert refused or case.room is not None or case.sink in ("nowhere", "shp", "geojson"), said[-2000:]
    assert not refused or refused in said, said[-2000:]
    assert "written" in said or refused or "create" in said, said[-2000:]
    return "refused"
