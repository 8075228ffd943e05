"""The files that the pages' JSON names, small: surfaces, motions and faces."""
import json
import subprocess

ARM = {"schema_version": "1.0", "time": {"dt": 0.02, "duration": 0.1}, "systems": [{"type": "skeleton", "id": "walk", "joints": [
    {"id": "root", "rotation": ["0", "0", "t"]}, {"id": "hand", "parent": "root", "offset": [0.4, 0, 0], "end": [0.2, 0, 0]}],
    "skin": {"tubes": [{"from": "root", "to": "hand", "radius": 0.05, "rings": 4, "around": 5}]}}]}
CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
FACE = {"schema_version": "1.0", "time": {"dt": 0.02, "duration": 0.1}, "systems": [{"type": "blend_shapes", "id": "face",
    "vertices": CORNERS, "triangles": sum(FACES, []), "targets": [{"name": "smile", "weight": "t", "offset": ["0.5*x", "0", "0"]}]}]}


def write_files(truestep, folder):
    for name, scene in (("walk", ARM), ("face", FACE)):
        (folder / "scene.json").write_text(json.dumps(scene))
        for ending in ("glb", "gltf"):
            out = folder / f"{name}.{ending}"
            subprocess.run([truestep, "motion", folder / "scene.json", "-o", out, "--seconds", "0.1"], check=True, capture_output=True)
    (folder / "smile.glb").write_bytes((folder / "face.glb").read_bytes())
    vertices = "".join("v %g %g %g\n" % tuple(c) for c in CORNERS)
    (folder / "face.obj").write_text(vertices + "".join("f %d %d %d\n" % tuple(c + 1 for c in f) for f in FACES))
    (folder / "smile.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        + "".join("%g %g %g\n" % (2 * x, y, z) for x, y, z in CORNERS))
    facet = "facet normal 0 0 0\nouter loop\n%s\nendloop\nendfacet\n"
    (folder / "part.stl").write_text("solid part\n" + "".join(
        facet % "\n".join("vertex %g %g %g" % tuple(1000 * x for x in CORNERS[c]) for c in f) for f in FACES) + "endsolid part\n")
