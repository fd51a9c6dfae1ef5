#!/usr/bin/env python3
"""Two hours of production in small: `seamwright run --watch --push` before a served cell, with everything going wrong around
it.

usage: tests/soak/production.py build/bin/seamwright [--minutes 120] [--seed 1] [--taught demo.seam] [--folder DIR]

A station is made with the product's own commands: the demo's door as two part types ("left" measured along its top, "right"
along its bottom) in two paints, and a fixed reference that the robot calls as a part type of its own, measured after every
EVERY_PARTS parts. Broker (mosquitto), database (PostgreSQL), cell (`sim-cell`: GigE Vision camera and a KUKA controller over
EthernetKRL) and the runner are processes of their own. The line calls part after part, each displaced by the seed; the robot
drifts from a known part on; later it is knocked once; camera, controller, whole cell, broker, database and the runner itself
go away at times of the seed.

What is claimed:
- Nothing lost: each part that is called ends as one stored run or one said refusal for each call that was answered; every
  run is in PostgreSQL once; results arrive over MQTT but for at most one for each kill of broker or runner; the last will is
  seen at every kill of the runner; what the broker keeps is there when it comes back; `check` and `audit` pass.
- Drift named within 20 parts: the drift grows towards DRIFT_MM with a time constant of DRIFT_POINTS measurements of the
  reference. It reaches its limit when the place where the script has put the robot shows the watch's limit (0.1 mm) in one
  direction of the reference. From the part after that, at most 20 parts are called (the reference's own included) until
  `seamwright drift status` says change "drift" or verdict "recalibrate".
- Bump stopped at once: the robot is knocked by BUMP_MM before a part. The next measurement of the reference stops
  production; no part after it is pushed until a person has acknowledged. Parts between knock and that measurement are
  measured as they stand.
- Never a wrong place: a part that is ok has its region's points within 0.5 mm (claims.py) of where the script has put them,
  as the robot sees them; the frames on the controller after every part are those of the last run that was released, within
  0.01 mm.
- The status page answers but for 30 s after a start of the runner. Memory, threads and open files of the runner are flat
  over the last half.

The simulated surface has one brightness: the paints differ in what the line announces and in the exposure that is set for
them. Exit 0: all claims hold; 1: a sentence for each that does not, and the folder is left."""

import argparse
import collections
import json
import math
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import claims
import plant
import station
from line import TOPIC, Line

EVERY_PARTS = 2
LEARN_POINTS = 24
DRIFT_MM, DRIFT_POINTS = 0.4, 6
BUMP_MM = 1.2
DRIFT_AT, BUMP_AT = 0.25, 0.72  # of the time


class Trouble(threading.Thread):
    """What goes away, and comes back. Those that stop production wait while `calm` is wanted: drift and bump are to be seen alone."""

    def __init__(self, minutes, seed, soak):
        super().__init__(daemon=True)
        draw = random.Random(seed + 1)
        times = max(1, round(minutes / 20))
        plan = []
        for kind, first, last in (("camera", 0.02, 0.95), ("robot disconnects", 0.02, 0.95), ("robot silent", 0.02, 0.95),
                                  ("cell killed", 0.02, 0.95), ("cell stands still", 0.02, 0.95), ("broker killed", 0.05, 0.9),
                                  ("database killed", 0.05, 0.9), ("runner killed", 0.04, 0.45)):
            for k in range(times):  # one in each part of its time
                at = first + (last - first) * (k + draw.random()) / times
                plan.append((60 * minutes * at, kind))
        self.plan, self.soak, self.calm, self.over = sorted(plan), soak, False, False
        self.done, self.now, self.length = collections.Counter(), "", draw

    def run(self):
        begun = time.monotonic()
        waiting = list(self.plan)
        while waiting and not self.over:
            elapsed = time.monotonic() - begun
            due = [e for e in waiting if e[0] <= elapsed and
                   not (self.calm and e[1] not in ("broker killed", "database killed"))]
            if not due:
                time.sleep(0.3)
                continue
            waiting.remove(due[0])
            self.now = due[0][1]
            try:
                self._cause(due[0][1])
                self.done[due[0][1]] += 1
            except Exception as error:  # of the script's tools: the soak is worth nothing then
                self.soak.line.fault(f"{due[0][1]}: {error!r}")
            self.now = ""
            self._rest(6)
        self.over = True

    def _rest(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end and not self.over:
            time.sleep(0.1)

    def _cause(self, kind):
        s, away = self.soak, self.length.uniform(4, 12)
        if kind == "camera":
            s.cell.say("camera off")
            self._rest(away)
            s.cell.say("camera on")
        elif kind.startswith("robot"):
            s.cell.say("fault " + ("silent" if kind.endswith("silent") else "disconnect"))
            self._rest(away)
            s.cell.say("fault none")
        elif kind == "cell killed":
            s.cell.kill()
            self._rest(away)
            s.cell.start()
        elif kind == "cell stands still":
            s.cell.hold(away)
        elif kind == "broker killed":
            s.broker.kill()
            self._rest(away)
            s.broker.start()
            plant.until(lambda: (s.broker.kept(TOPIC.format("STATE")) or {}).get("online") in (True, False), 60,
                        "the broker keeps the station's state")
        elif kind == "database killed":
            s.database.kill()
            self._rest(away)
            s.database.start()
        elif kind == "runner killed":
            s.runner.kill()


class Soak:
    def __init__(self, a, folder):
        self.a, self.folder, self.faults = a, folder, []
        self.tool = station.Tool(a.program, folder)
        self.samples, self.begun = [], 0
        self.figures = {}

    def fault(self, sentence):
        self.faults.append(sentence)

    def build_up(self):
        a, folder = self.a, self.folder
        self.broker, self.database = plant.Broker(folder), plant.Database(folder)
        self.broker.start()
        self.database.start()
        self.database.ask("CREATE DATABASE fleet", "postgres")
        draw = random.Random()  # a place on the loopback that no other test has
        camera = f"127.{draw.randint(64, 250)}.{draw.randint(1, 250)}.{draw.randint(1, 250)}"
        self.project, cell = station.make(self.tool, folder, a.taught, camera, plant.free_port(), self.broker.port,
                                          self.database.url, EVERY_PARTS)
        self.truth = station.Truth(json.loads((folder / "station.json").read_text()), a.seed)
        self.listener = plant.Listener(self.broker, folder)
        known = self.project
        if a.cell_project:
            known = folder / "cell.seam"
            shutil.copy(a.cell_project, known)
        self.cell = plant.Cell(a.cell_program or a.program, folder, cell, known, a.time_scale)
        self.cell.start()
        self.runner = plant.Runner(a.program, folder, self.project, ["--fleet"])
        self.line = Line(self.cell, self.runner, self.broker, self.listener, self.truth, self.project)
        self.runner.start()
        if not self.runner.wait(lambda e: e["event"] == "connected", 180):
            raise RuntimeError("the runner does not connect: run.log")
        print(f"learning the reference, {LEARN_POINTS} times", flush=True)
        for _ in range(LEARN_POINTS):
            self.line.reference()
        if (code := self.runner.stop()) != 0:
            self.fault(f"the runner ended with {code} after SIGTERM")
        self.tool("drift", self.project, "learn")
        self.runner.start()
        self.watcher = plant.PageWatcher(self.runner)

    # --- production

    def point(self):
        """The reference is measured; the watch's standing after it as the file has it."""
        part = self.line.reference()
        if not part.event or part.event.get("status") != "ok":
            return part, None
        return part, self.tool.json("drift", self.project, "status", exits=(0, 1))

    def shown_mm(self, shift_mm):
        return abs(shift_mm) / math.sqrt(2)  # in each direction of the reference

    def produce(self):
        self.trouble = trouble = Trouble(self.a.minutes, self.a.seed, self)
        self.begun = time.monotonic()
        self.minute = 0
        trouble.start()
        state = "before"
        points = grown = reached = 0
        threading.Thread(target=self._minutes, daemon=True).start()
        while True:
            share = (time.monotonic() - self.begun) / 60 / self.a.minutes
            if share >= 1 and trouble.over and state == "after":
                break
            if share > 1.5 + 5 / self.a.minutes:
                self.fault(f"the soak does not come to its end: {state}, {trouble.now}")
                break
            for _ in range(EVERY_PARTS):
                self.line.production(drifting=state in ("rising", "falling"))
                self._pause()
            part, standing = self.point()
            self._pause()
            if state == "before" and share >= DRIFT_AT and standing and not trouble.now:
                trouble.calm, state, points, first = True, "rising", 0, len(self.line.parts)
                print(f"the robot begins to drift after part {part.name}", flush=True)
            elif state == "rising" and standing:
                named = standing["change"] == "drift" or standing["status"] == "recalibrate"
                if named and "drift" not in self.figures:
                    after = len(self.line.parts) - (reached or len(self.line.parts))
                    self.figures["drift"] = (f"named {after} parts after it reached its limit, "
                                             f"{len(self.line.parts) - first} after it began, at "
                                             f"{self.shown_mm(self.line.shift_mm):.3f} mm: {standing['text']}")
                    print("the drift is", self.figures["drift"], flush=True)
                if reached and "drift" not in self.figures and len(self.line.parts) - reached >= 20:
                    self.fault(f"the drift is not named 20 parts after it reached its limit: {standing['text']}")
                    self.figures["drift"] = "not named in time"
                if "drift" in self.figures and points > 1.5 * DRIFT_POINTS:
                    trouble.calm, state, grown, points = False, "stays", self.line.shift_mm, 0
                if standing["stopped"]:
                    self.fault(f"the drift was taken for a step: {standing['text']}")
                    self._acknowledge("none")
            elif state == "stays" and standing:
                points += 1
                if points > DRIFT_POINTS / 2:
                    state, points = "falling", 0
            elif state == "falling" and standing and points > 2.5 * DRIFT_POINTS and share >= BUMP_AT and not trouble.now:
                trouble.calm = True
                self._bump()
                trouble.calm, state = False, "after"
            elif standing and standing["stopped"]:
                self.fault(f"production stands without a bump: {standing['text']}")
                self._acknowledge("none")
            if standing and state in ("rising", "falling"):
                points += 1
                cold = math.exp(-points / DRIFT_POINTS)
                self.line.move_robot(DRIFT_MM * (1 - cold) if state == "rising" else grown * cold)
                if state == "rising" and not reached and self.shown_mm(self.line.shift_mm) >= station.LIMIT_MM:
                    reached = len(self.line.parts)
        trouble.over = True
        trouble.join(timeout=60)

    def _bump(self):
        stands = self.line.shift_mm
        self.line.move_robot(stands - BUMP_MM)
        for _ in range(EVERY_PARTS):
            self.line.production(bumped=True)
        part, standing = self.point()
        if not (standing and standing["stopped"] and part.event["drift"]["stopped"]):
            self.fault(f"the bump did not stop production at the next measurement: {standing and standing['text']}")
        else:
            self.figures["bump"] = f"stopped at the next measurement: {standing['text']}"
        for _ in range(2):
            after = self.line.production(bumped=True)
            if after.event and after.event.get("status") == "ok":
                self.fault(f"part {after.name} was pushed although production was stopped")
        self.line.move_robot(stands)
        again = self.line.production()
        if again.event and again.event.get("status") == "ok":
            self.fault(f"part {again.name} was pushed before anybody acknowledged")
        self._acknowledge("robot foot tightened")
        self.point()
        on = self.line.production()
        if not (on.event and on.event.get("status") == "ok"):
            self.fault(f"production does not go on after the acknowledgement: {on.event and on.event.get('text')}")

    def _acknowledge(self, found):
        self.tool("drift", self.project, "acknowledge", "--by", "Ada", "--text", found)

    def _pause(self):
        time.sleep(self.a.pause)

    def _minutes(self):
        while True:
            usage = self.runner.usage()
            elapsed = time.monotonic() - self.begun
            if usage:
                self.samples.append((elapsed, *usage))
            ends = [p.event or {"event": "open"} for p in self.line.parts]
            counts = collections.Counter(e.get("status", e["event"]) for e in ends)
            _, kib, threads, files = usage or (0, 0, 0, 0)
            print(f"{elapsed / 60:5.1f} min  parts {len(ends)}  {dict(counts)}  shift {self.line.shift_mm:.2f} mm  "
                  f"own {kib / 1024:.1f} MiB  threads {threads}  files {files}  "
                  f"trouble {sum(self.trouble.done.values())}/{len(self.trouble.plan)} {self.trouble.now}", flush=True)
            for _ in range(600 if self.a.minutes > 20 else 100):
                time.sleep(0.1)
                if self.line.over:
                    return

    # --- the end

    def judge(self):
        self.line.over = True
        kept = self.broker.kept(TOPIC.format("STATE"))
        if not kept or kept.get("online") is not True:
            self.fault(f"the broker does not keep the state of a running station: {kept}")
        time.sleep(3)
        self.watcher.over = True
        changes = list(self.runner.changes)
        if (code := self.runner.stop()) != 0:
            self.fault(f"the runner ended with {code} after SIGTERM")
        self.runner.changes = changes
        time.sleep(2)
        self.listener.over = True
        for sentence in self.runner.unplanned:
            self.fault(f"the runner {sentence}")
        broker_kills, runner_kills = self.trouble.done["broker killed"], self.trouble.done["runner killed"]
        wrong, worst = claims.right_places(self.line)
        in_fleet, rows = claims.fleet(self.database, self.project, self.tool)
        not_flat, rate, error = claims.flat(self.samples, self.a.minutes)
        for sentences in (wrong, in_fleet, not_flat, claims.every_part(self.line, runner_kills),
                          claims.messages(self.line, self.listener, broker_kills, runner_kills),
                          claims.page(self.watcher, self.runner)):
            self.faults += sentences
        check = self.tool("check", self.project, exits=(0, 1, 3))
        if check.returncode:
            self.fault(f"check: exit {check.returncode}: {check.stdout[:600]}")
        audit = self.tool("audit", self.project, "--csv", self.folder / "audit.csv", exits=(0, 1, 3))
        if audit.returncode:
            self.fault(f"audit: exit {audit.returncode}: {audit.stderr[-300:]}")
        calm = [p for p in self.line.parts if p.kind != "reference"]
        ok = sum((p.event or {}).get("status") == "ok" for p in calm)
        if ok < 0.6 * len(calm):
            self.fault(f"only {ok} of {len(calm)} parts were corrected")
        self.faults += self.line.faults
        runs = collections.Counter(r["status"] for r in claims.runs_of(self.project))
        kinds = collections.Counter((p.kind, p.paint) for p in calm)
        told = [took for _, took in self.watcher.answers if took is not None]
        self.figures.update({
            "parts": f"{len(self.line.parts)} called, {len(calm)} of production, {ok} corrected; {self.line.alarms} alarms",
            "types and paints": ", ".join(f"{k} in {p}: {n}" for (k, p), n in sorted(kinds.items())),
            "runs": ", ".join(f"{k} {n}" for k, n in sorted(runs.items())),
            "refused calls": sum(e["event"] == "missed" for e in self.runner.events),
            "outages": ", ".join(f"{k} {n}" for k, n in sorted(self.trouble.done.items())),
            "largest error of an ok part": f"{worst:.3f} mm",
            "rows in the fleet": rows, "messages": len(self.listener.messages),
            "memory": f"{rate:.2f} ± {error:.2f} MiB/h over the last half, "
                      f"{self.samples[-1][2] / 1024 if self.samples else 0:.1f} MiB at the end",
            "status page": f"{len(told)} answers, slowest {max(told, default=0):.2f} s",
        })


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the seamwright to soak")
    parser.add_argument("--minutes", type=float, default=120, help="of production, after the station is made; 8 is a short one")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--taught", type=Path, help="a demo.seam made in-process, instead of making one")
    parser.add_argument("--folder", type=Path, help="where to work; kept. Else a temporary one, kept where a claim fails")
    parser.add_argument("--pause", type=float, default=1.0, help="seconds between two parts")
    parser.add_argument("--time-scale", type=float, default=4, help="of the robot, so that a part takes seconds")
    parser.add_argument("--cell-program", help=argparse.SUPPRESS)
    parser.add_argument("--cell-project", help=argparse.SUPPRESS)
    a = parser.parse_args()
    a.program = Path(a.program).resolve()
    missing = [t for t in ("mosquitto", "mosquitto_sub", "mosquitto_pub", "psql", "setpriv") if not plant.tool(t)]
    if missing or not plant.POSTGRES:
        print(f"skipped: not installed: {', '.join(missing) or 'a PostgreSQL server'}")
        return 0
    folder = a.folder.resolve() if a.folder else Path(tempfile.mkdtemp(prefix="seamwright-soak-"))
    folder.mkdir(parents=True, exist_ok=True)
    folder.chmod(0o755)
    soak = Soak(a, folder)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt()))
    code = 1
    try:
        soak.build_up()
        soak.produce()
        soak.judge()
        code = 1 if soak.faults else 0
    except KeyboardInterrupt:
        print("interrupted", flush=True)
    except (RuntimeError, OSError, subprocess.SubprocessError) as error:
        soak.fault(f"the soak broke off: {error}")
        print(f"broke off: {error!r}", flush=True)
    finally:
        plant.stop_all()
    print()
    for what, figure in soak.figures.items():
        print(f"{what:28} {figure}")
    for sentence in soak.faults:
        print("NOT TRUE:", sentence)
    if code or a.folder:
        print(f"left in {folder}")
    else:
        shutil.rmtree(folder, ignore_errors=True)
    return code


if __name__ == "__main__":
    sys.exit(main())
