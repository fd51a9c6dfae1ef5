"""The station of the soak: the demo's taught door as two part types and a fixed reference, on served devices."""

import json
import math
import random
import subprocess

TYPES = {"left": 1, "right": 2, "reference": 9}
PAINTS = {1: 800, 2: 1250}  # number as the line says it: exposure in us
REFERENCE_SPOT = "T1-reference"
LIMIT_MM = 0.1


class Tool:
    """The program's commands; a wrong exit code is an error with what was said."""

    def __init__(self, program, folder):
        self.program, self.folder = str(program), folder

    def __call__(self, *arguments, exits=(0,), seconds=1800):
        got = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, timeout=seconds,
                             stdin=subprocess.DEVNULL)
        with open(self.folder / "commands.log", "a") as log:
            log.write(f"$ seamwright {' '.join(map(str, arguments))}\n{got.stdout[-4000:]}{got.stderr[-4000:]}exit {got.returncode}\n")
        if got.returncode not in exits:
            raise RuntimeError(f"seamwright {' '.join(map(str, arguments))}: exit {got.returncode}: {got.stderr.strip()[-500:]}")
        return got

    def json(self, *arguments, exits=(0,), **more):
        return json.loads(self(*arguments, "--json", "-", exits=exits, **more).stdout)


def make(tool, folder, taught, camera, robot_port, broker_port, fleet_url, every_parts):
    """(project file, settings of the cell). `taught`: a demo.seam, or None: it is made."""
    if taught is None:
        tool("demo", "--in-process", "--no-offline", "--parts", "1", "--seed", "3", "--dir", folder / "demo")
        taught = folder / "demo" / "demo.seam"
    work, project = folder / "taught.seam", folder / "station.seam"
    work.write_bytes(taught.read_bytes())
    tool("type", "add", work, "left", "--number", TYPES["left"])
    for kind in ("right", "reference"):
        tool("type", "clone", work, "left", kind, "--number", TYPES[kind])
    tool("export", work, "--out", folder / "taught.json", "--with-taught")
    document = json.loads((folder / "taught.json").read_text())
    cell = _to_served_devices(document, camera, robot_port)
    (folder / "station.json").write_text(json.dumps(document))
    tool("import", project, "--from", folder / "station.json")
    for paint, exposure_us in PAINTS.items():
        tool("expose", project, "--all", "--set", f"exposure_us={exposure_us}", "--paint", paint)
    tool("drift", project, "set", "--spots", REFERENCE_SPOT, "--every-parts", every_parts, "--limit-mm", LIMIT_MM)
    tool("line", "set", project, "broker", "--protocol", "mqtt", "--settings",
         json.dumps({"port": broker_port, "group": "soak", "node": "station", "reconnect_most_ms": 2000}))
    tool("fleet", "init", "--to", fleet_url)
    tool("fleet", "set", project, "--to", fleet_url, "--station", "soak")
    return project, cell


# The demo's project was taught in the same simulated cell, in-process; what is exchanged is how its devices are reached. The
# clones' references are measured ones: the simulated door is their part too. Left is measured along the top, right along the bottom.
def _to_served_devices(document, camera, robot_port):
    project = document["project"]
    document["runs"], document["events"] = [], []
    settings = project["robots"][0]["settings"]
    cell = {"seed": settings["seed"], "board": settings["board"], "robot": settings["robot"],
            "serve": {"camera": camera, "controllers": [f"kuka-eki:{robot_port}"]}}
    project["regions"] = [r for r in project["regions"]
                          if (r["type_id"], r["frame_name"]) in (("left", "BASE_top"), ("right", "BASE_bottom"))]
    for region in project["regions"]:
        # The standing drift is part of a correction's sigma; here production goes on while it is there.
        region["sigma_limit_mm"], region["sigma_limit_deg"] = 0.8, 0.4
    used = {spot for r in project["regions"] for spot in r["spot_ids"]} | {REFERENCE_SPOT}
    project["spots"] = [s for s in project["spots"] if s["id"] in used]
    for spot in project["spots"]:
        spot["reference_state"] = "measured"
    sensor = {"driver": "genicam", "model": "Simulated stripe camera", "serial": "SIM-1", "vendor": "Seamwright"}
    robot = {"brand": "KUKA", "driver": "kuka-eki", "model": "#KR SIMULATED", "serial": "1"}
    project["sensors"][0].update(driver="genicam", identity=sensor, settings={"address": camera, "hardware_trigger": True})
    project["robots"][0].update(driver="kuka-eki", identity=robot, settings={"port": robot_port})
    for calibration in project["calibrations"]:
        calibration.update(sensor_identity=sensor, robot_identity=robot)
    return cell


# --- poses: 4x4, row by row

def rotation(a, b, c):
    """KUKA A, B, C in degrees: Rz(A) Ry(B) Rx(C)."""
    (sa, ca), (sb, cb), (sc, cc) = ((math.sin(math.radians(x)), math.cos(math.radians(x))) for x in (a, b, c))
    return [[ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc],
            [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc],
            [-sb, cb * sc, cb * cc]]


def pose(xyz, abc=(0, 0, 0)):
    return [[*row, t] for row, t in zip(rotation(*abc), xyz)] + [[0, 0, 0, 1]]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(a):
    r = [[a[j][i] for j in range(3)] for i in range(3)]
    return [[*r[i], -sum(r[i][k] * a[k][3] for k in range(3))] for i in range(3)] + [[0, 0, 0, 1]]


def apply(a, p):
    return [sum(a[i][k] * p[k] for k in range(3)) + a[i][3] for i in range(3)]


def apart(a, b, points):
    """How far two poses put the same points apart, at most."""
    return max(math.dist(apply(a, p), apply(b, p)) for p in points)


class Truth:
    """What the script does to the cell, and where that puts a region's points as the robot sees them."""

    def __init__(self, project_json, seed):
        self.random = random.Random(seed)
        project = project_json["project"]
        self.base_from_part = project["part"]["base_from_workobject"]["matrix"]
        flange_from_sensor = project["calibrations"][0]["flange_from_sensor"]["matrix"]
        self.spots, self.regions = {}, {}
        for spot in project["spots"]:
            base_from_sensor = times(spot["base_from_flange"]["matrix"], flange_from_sensor)
            at = apply(base_from_sensor, spot["reference_mm"])
            self.spots[spot["id"]] = apply(inverse(self.base_from_part), at)  # in the part's work object
            if spot["id"] == REFERENCE_SPOT:
                self.reference = base_from_sensor
        for region in project["regions"]:
            self.regions[region["id"]] = [self.spots[s] for s in region["spot_ids"]]
        # The robot drifts in a direction that the reference shows in both its directions alike.
        self.drift_axis = [(self.reference[i][0] + self.reference[i][2]) / math.sqrt(2) for i in range(3)]

    def displacement(self):
        """Of the next part: its door hangs up to some millimetres and tenths of a degree off."""
        r = self.random
        return {"xyz": [round(r.uniform(-8, 8), 3), round(r.uniform(-8, 8), 3), round(r.uniform(-5, 5), 3)],
                "abc": [round(r.uniform(-0.4, 0.4), 4), round(r.uniform(-0.4, 0.4), 4), round(r.uniform(-0.4, 0.4), 4)]}

    def shift(self, size_mm):
        return {"xyz": [size_mm * a for a in self.drift_axis], "abc": [0, 0, 0]}

    def seen(self, displacement, shift_mm):
        """workobject_from_movedworkobject as a robot sees it that stands off by shift_mm along the axis of the drift."""
        d = pose(displacement["xyz"], displacement["abc"])
        s = pose([shift_mm * a for a in self.drift_axis])
        return times(inverse(self.base_from_part), times(inverse(s), times(self.base_from_part, d)))
