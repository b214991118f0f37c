"""Reads the meshes that `surefoot mesh` writes by trimesh, and compares what both measure.

    python tests/readers/read.py target/debug/surefoot FOLDER

Writes each mesh in every format to FOLDER. Box and volume agree to 1e-4 with what `surefoot mesh` says of the mesh; pieces and
Euler number are the same. Where a scene has a tolerance in the table below, the volume is that of the field, as
`surefoot measure` says it, to the error of both. Ends with code 1 if something differs.
"""

import json
import pathlib
import re
import subprocess
import sys

import networkx
import numpy
import trimesh

ROOT = pathlib.Path(__file__).resolve().parents[2]
FORMATS = ["stl", "obj", "ply", "glb", "3mf"]
AGREE = 1e-4

# Scenes of a file, and of a line: the resolution, and the tolerance to which the field is measured, where that is soon done.
SCENES = {
    "isometric": (None, 48, None),
    "machine": (None, 64, None),
    "sponge": ("menger_sponge(2, 2)", 54, None),
    "ball": ("sphere(1).material(red)\nmaterial red { color: #ff0000 }", 48, 0.004),
    "torus": ("torus(1, 0.3)", 48, 0.004),
    "two": ("sphere(0.5) | box(0.8).translate(2, 0.3, 0)", 48, 0.004),
    # A ball that is hollow: two shells, one inside the other.
    "hollow": ("sphere(1) - sphere(0.8)", 48, 0.004),
    "plate": ("box((40, 5, 30)) - cylinder(4, 20)\nrender { unit: mm }", 64, 0.02),
}
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{arguments}: {done.stdout}{done.stderr}")
    return done.stdout


def said_of_mesh(out):
    """What `surefoot mesh` says: pieces, Euler number, volume, corners of the box, deviation."""
    pieces = int(re.search(r"(\d+) pieces?,", out)[1])
    euler = int(re.search(r"Euler number (-?\d+)", out)[1])
    volume = float(re.search(f"volume {NUMBER}", out)[1])
    area = float(re.search(f"area {NUMBER}", out)[1])
    low, high = ([float(n) for n in corner.split(",")] for corner in re.search(r"from \((.*?)\) to \((.*?)\)", out).groups())
    deviation = float(re.search(f"farthest triangle found is {NUMBER}", out)[1])
    return pieces, euler, volume, area, numpy.array([low, high]), deviation


def pieces_of(mesh):
    """Surfaces that hang together by an edge or a corner."""
    graph = networkx.Graph()
    graph.add_edges_from(mesh.edges_unique)
    return networkx.number_connected_components(graph)


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    wrong = 0
    print(f"{'scene':12} {'format':6} {'vertices':>8} {'pieces':>6} {'euler':>6} {'box off':>9} {'volume off':>10} {'off the field':>13}")
    for name, (text, resolution, tolerance) in SCENES.items():
        scene = ROOT / "examples" / f"{name}.sdf"
        if text is not None:
            scene = folder / f"{name}.sdf"
            scene.write_text(f"scene = {text}\n")
        field = tolerance and json.loads(run(program, "measure", scene, "--json", "--tolerance", tolerance))["volume"]
        for ending in FORMATS:
            file = folder / f"{name}.{ending}"
            out = run(program, "mesh", scene, "-o", file, "--resolution", resolution)
            pieces, euler, volume, area, box, deviation = said_of_mesh(out)
            mesh = trimesh.load(file, force="mesh", process=False)
            # STL repeats the corners of each triangle, and GLB those where colours meet.
            mesh.merge_vertices(merge_tex=True, merge_norm=True)
            # A GLB is in metres.
            if ending == "glb" and "unit: mm" in (text or ""):
                mesh.apply_scale(1000.0)
            size = numpy.ptp(box, axis=0).max()
            box_off = numpy.abs(mesh.bounds - box).max() / size
            volume_off = abs(mesh.volume - volume) / abs(volume)
            # The mesh encloses what the field does, but for what lies between the two.
            field_off = abs(mesh.volume - field["value"]) if field else 0.0
            allowed = area * deviation + AGREE * abs(volume) + (field["error"] if field else 0.0)
            found = pieces_of(mesh)
            fine = [
                mesh.is_watertight,
                mesh.is_winding_consistent,
                found == pieces,
                mesh.euler_number == euler,
                box_off < AGREE,
                volume_off < AGREE,
                field_off < allowed,
            ]
            words = ["has holes", "is not oriented", "has other pieces", "has another Euler number", "has another box", "has another volume",
                     f"is not the field by {field_off} > {allowed}"]
            faults = ", ".join(word for word, good in zip(words, fine) if not good)
            wrong += bool(faults)
            print(f"{name:12} {ending:6} {len(mesh.vertices):8} {found:6} {mesh.euler_number:6} {box_off:9.1e} {volume_off:10.1e} "
                  + (f"{field_off / abs(volume):13.1e}" if field else f"{'-':>13}") + (f"  WRONG: {faults}" if faults else ""))
    sys.exit(1 if wrong else 0)


main()
