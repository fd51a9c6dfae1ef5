"""The line of the soak: calls part after part as a plant's PLC does, knows the truth of each, keeps book of what it was told."""

import json
import sqlite3
import time
from dataclasses import dataclass, field

from station import REFERENCE_SPOT, TYPES, PAINTS, apart

TOPIC = "seamwright/soak/{}/station"
# A frame on the controller and the one of the stored run, read back in the controller's own A, B, C.
SAME_FRAME_MM = 0.01


@dataclass
class Part:
    name: str
    kind: str
    number: int
    paint: int = 0
    displacement: dict = field(default_factory=dict)
    shift_mm: float = 0
    drifting: bool = False
    bumped: bool = False
    calls: int = 0
    called: list = field(default_factory=list)  # when
    announced: bool = False                     # with every call
    event: dict = None                          # the answer: a run or a refusal


class Line:
    def __init__(self, cell, runner, broker, listener, truth, project):
        self.cell, self.runner, self.broker, self.listener = cell, runner, broker, listener
        self.truth, self.project = truth, project
        self.parts, self.faults, self.alarms = [], [], 0
        self.frames = None       # on the controller after the last part
        self.shift_mm = 0.0      # of the robot, along the axis of the drift
        self.kinds = ["left", "right"]
        self.over = False

    def fault(self, sentence):
        self.faults.append(sentence)
        print("FAULT", sentence, flush=True)

    def move_robot(self, shift_mm):
        self.shift_mm = shift_mm
        self.cell.say("shift " + json.dumps(self.truth.shift(shift_mm)))

    def reference(self):
        return self._part(Part(f"REF-{len(self.parts) + 1}", "reference", len(self.parts) + 1))

    def production(self, **marks):
        draw = self.truth.random
        part = Part(f"CAR-{len(self.parts) + 1}", draw.choice(self.kinds), len(self.parts) + 1, draw.choice(list(PAINTS)),
                    self.truth.displacement(), **marks)
        return self._part(part)

    def _part(self, part):
        self.parts.append(part)
        part.shift_mm = self.shift_mm
        self._tell("part " + json.dumps({"displacement": part.displacement} if part.displacement else {}))
        self._tell("type " + part.kind)
        part.announced = True
        if self.frames is None:
            self.frames = self._tell("state")["frames"]
        for _ in range(12):
            if self.over or self._call(part):
                break
        else:
            self.fault(f"part {part.name} was called {part.calls} times and never answered")
        self._compare_frames(part)
        return part

    # Whatever is away comes back: the line waits.
    def _tell(self, line):
        end = time.monotonic() + 300
        while time.monotonic() < end and not self.over:
            state = self.cell.say(line)
            if state is not None:
                return state
            time.sleep(0.3)
        raise RuntimeError("the cell does not come back")

    def _call(self, part):
        since, changes, starts = len(self.runner.events), len(self.runner.changes), self.cell.starts
        # A station that has just started, or whose broker has, may not be there to hear it.
        heard = time.time() - max([self.broker.started, *self.runner.changes]) > 10
        command = {"id": f"{part.name}.{part.calls}", "part_type": TYPES[part.kind], "paint": part.paint,
                   "part_number": part.number, "part_name": part.name}
        said = self.broker.say(TOPIC.format("NCMD"), command)
        # The robot's call must not overtake it: the broker has it when it says so, others when they hear it.
        part.announced &= heard and said and self.listener.heard(TOPIC.format("NCMD"), command["id"], 5)
        time.sleep(0.5)
        if self.cell.say("start " + part.name) is None:
            time.sleep(1)
            return False
        part.calls += 1
        part.called.append(time.time())
        patience = time.monotonic() + 90
        while time.monotonic() < patience and not self.over:
            part.event = self.runner.wait(
                lambda e: e["event"] in ("run", "missed") and e.get("part") == part.name, 1, since)
            if part.event:
                return True
            # Who was to answer is another one by now: once he has had the time to answer an old call, the line calls again.
            if len(self.runner.changes) != changes or self.cell.starts != starts:
                patience = min(patience, time.monotonic() + 20)
                changes, starts = len(self.runner.changes), self.cell.starts
        return False

    # What stands on the controller is what a stored run has released, or what stood there before.
    def _compare_frames(self, part):
        state = self._tell("state")
        before, now, self.frames = self.frames, state["frames"], state["frames"]
        killed = any(t > part.called[0] for t in self.runner.changes) if part.called else False
        ok = part.event is not None and part.event["event"] == "run" and part.event["status"] == "ok"
        wanted = dict(before)
        released = any(c["released"] for c in state["controllers"])
        if ok and part.kind != "reference":
            for region, passed, body in self.stored_regions(part.event["run"]):
                if not passed:
                    self.fault(f"part {part.name} is ok with region {region}, which the gate did not pass")
                wanted[self.frame_of(region)] = json.loads(body)["base_from_frame"]
        elif released and part.kind != "reference":
            self.fault(f"part {part.name} is released, but not ok: {part.event}")
        if part.event is not None and part.event.get("status") == "alarm":
            self.alarms += 1
            return
        if killed and not ok:
            return  # written by who was killed over it; it is not released, and that is what counts
        for name, frame in now.items():
            off = apart(frame["matrix"], wanted[name]["matrix"], [[0, 0, 0], [1000, 0, 0], [0, 1000, 0]])
            if off > SAME_FRAME_MM:
                self.fault(f"after part {part.name} ({part.event and part.event.get('status')}) frame {name} stands "
                           f"{off:.3f} mm off what was released")

    def stored_regions(self, run):
        with sqlite3.connect(f"file:{self.project}?mode=ro", uri=True, timeout=30) as db:
            return db.execute("SELECT region_id, gate_passed, body FROM run_regions WHERE run = ?", (run,)).fetchall()

    def frame_of(self, region):
        if not hasattr(self, "_frame_names"):
            with sqlite3.connect(f"file:{self.project}?mode=ro", uri=True, timeout=30) as db:
                self._frame_names = dict(db.execute("SELECT id, frame_name FROM regions"))
        return self._frame_names[region]
