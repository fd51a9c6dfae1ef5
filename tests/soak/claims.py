"""What has to be true when the soak is over; each claim that is not is a sentence."""

import collections
import json
import math
import sqlite3
import time

from line import TOPIC
from station import apart

WRONG_PLACE_MM = 0.5
SETTLES_S = 300  # a started runner's caches


def runs_of(project):
    with sqlite3.connect(f"file:{project}?mode=ro", uri=True, timeout=60) as db:
        return [dict(zip(("number", "part", "status", "finished"), row))
                for row in db.execute("SELECT number, part_id, status, finished_utc FROM runs ORDER BY number")]


def every_part(line, kills):
    """Each call that was accepted is one stored run or one said refusal, and no part is lost."""
    runs = collections.Counter(r["part"] for r in runs_of(line.project))
    started = collections.Counter(e["part"] for e in line.runner.events if e["event"] == "start")
    missed = collections.Counter(e["part"] for e in line.runner.events if e["event"] == "missed")
    for event in line.runner.events:
        if event["event"] == "torn":
            # The one line that a killed program was writing.
            kills -= 1
    unstored = 0
    for part in line.parts:
        name = part.name
        if runs[name] + missed[name] > part.calls:
            yield f"part {name} was called {part.calls} times, but has {runs[name]} runs and {missed[name]} refusals"
        if runs[name] + missed[name] == 0 and part.calls:
            yield f"part {name} was called, and there is neither a run nor a refusal of it"
        if runs[name] < started[name]:
            unstored += started[name] - runs[name]
        elif runs[name] > started[name]:
            kills -= runs[name] - started[name]  # stored, and killed before the log had the line
    # A program that is killed between the line of a start and the run in the file: the robot calls again.
    if unstored > kills or kills < 0:
        yield f"{unstored} runs that were begun are not in the file, {kills} kills are left that could explain lines of the log"
    for name in set(runs) - {p.name for p in line.parts}:
        yield f"there is a run of part {name}, which nobody called"


def right_places(line):
    """(sentences, largest error) of the parts that are ok: where the correction puts a region's points, against the truth."""
    wrong, worst = [], 0.0
    for part in line.parts:
        if part.kind == "reference" or not part.event or part.event["event"] != "run" or part.event["status"] != "ok":
            continue
        seen = line.truth.seen(part.displacement, part.shift_mm)
        for region, _, body in line.stored_regions(part.event["run"]):
            told = json.loads(body)["correction"]["workobject_from_movedworkobject"]["matrix"]
            off = apart(told, seen, line.truth.regions[region])
            worst = max(worst, off)
            if off > WRONG_PLACE_MM:
                wrong.append(f"part {part.name} is ok, but region {region} lies {off:.3f} mm off its true place")
    return wrong, worst


def fleet(database, project, tool):
    """(sentences, rows): every finished run is in the database once."""
    wrong = []
    published = tool("fleet", "publish", project, exits=(0, 1))
    if published.returncode:
        wrong.append(f"the fleet does not take what waits: {published.stderr.strip()[-300:]}")
    told = database.ask("SELECT number, part, status FROM seamwright.run ORDER BY number") or ""
    rows = [line.split("|") for line in told.split()]
    in_fleet = collections.Counter(int(r[0]) for r in rows)
    status = {int(r[0]): (r[1], r[2]) for r in rows}
    for run in runs_of(project):
        count = in_fleet.pop(run["number"], 0)
        if run["status"] == "interrupted" and count == 0:
            continue  # killed while it was measured: it never finished
        if count != 1:
            wrong.append(f"run {run['number']} ({run['part']}, {run['status']}) is {count} times in the database")
        elif status[run["number"]] != (run["part"], run["status"]):
            wrong.append(f"run {run['number']} is {run['part']}, {run['status']} in the file, "
                         f"but {status[run['number']]} in the database")
    for number in in_fleet:
        wrong.append(f"run {number} is in the database, but not in the file")
    return wrong, len(rows)


def messages(line, listener, broker_kills, runner_kills):
    """Results arrive over the broker; the last will is seen. What a killed broker or runner had in hand may be missing, once
    each."""
    results = collections.defaultdict(list)
    wills = 0
    for topic, message in list(listener.messages):
        if message is None:
            yield f"a message on {topic} is no JSON"
        elif topic == TOPIC.format("NDATA") and message.get("run"):
            results[message["run"]].append(message)
        elif topic == TOPIC.format("STATE") and message.get("online") is False:
            wills += 1
    lost = unannounced = 0
    parts = {p.name: p for p in line.parts}
    for event in line.runner.events:
        if event["event"] != "run":
            continue
        got = results.get(event["run"])
        if not got:
            lost += 1
            continue
        part = parts[event["part"]]
        if any(m["part"] != part.name for m in got):
            yield f"the result of run {event['run']} names part {got[0]['part']} instead of {part.name}"
        if part.announced and part.paint and all(m["paint"] == 0 for m in got):
            unannounced += 1
        elif part.announced and part.calls == 1 and any(m["paint"] != part.paint for m in got):
            yield f"part {part.name} was announced with paint {part.paint}, its result says {got[0]['paint']}"
    if unannounced > broker_kills + runner_kills:
        yield (f"{unannounced} announcements were not taken, with {broker_kills} kills of the broker and {runner_kills} of "
               f"the runner")
    if lost > broker_kills + runner_kills:
        yield f"{lost} results did not arrive, with {broker_kills} kills of the broker and {runner_kills} of the runner"
    if wills < runner_kills:
        yield f"the last will was seen {wills} times, the runner was killed {runner_kills} times"


def page(watcher, runner, within_s=30):
    """The status page answers all the time but between a kill and `within_s` after it."""
    silent = [t for t, took in watcher.answers
              if took is None and not any(-11 < t - change < within_s for change in runner.changes)]
    if silent:
        yield f"the status page did not answer {len(silent)} times outside restarts, first {time.ctime(silent[0])}"
    if sum(took is not None for _, took in watcher.answers) < 3:
        yield "the status page hardly ever answered"


def slope(groups):
    """(per hour, its standard error) of [[(seconds, value)]], one slope and a level for each group."""
    groups = [g for g in groups if len(g) > 1]
    freedom = sum(map(len, groups)) - len(groups) - 1
    if freedom < 1:
        return 0.0, math.inf
    about = []
    for g in groups:
        mt, mv = sum(t for t, _ in g) / len(g), sum(v for _, v in g) / len(g)
        about += [(t - mt, v - mv) for t, v in g]
    tt = sum(t * t for t, _ in about)
    b = sum(t * v for t, v in about) / tt
    left = sum((v - b * t) ** 2 for t, v in about)
    return 3600 * b, 3600 * math.sqrt(left / freedom / tt)


def flat(samples, minutes):
    """(sentences, MiB/h, its error): memory, threads and files of the runner over the last half, each started one for itself.
    Its caches and the rings of the page fill up first: SETTLES_S of each are left out. An hour of at most 2 MiB is flat."""
    half = [s for s in samples if s[0] >= samples[-1][0] / 2] if samples else []
    wrong, runners, begun = [], {}, {}
    for t, process, kib, *_ in samples:
        if t - begun.setdefault(process, t) >= SETTLES_S and t >= samples[-1][0] / 2:
            runners.setdefault(process, []).append((t, kib / 1024))
    rate, error = slope(list(runners.values()))
    if minutes >= 60 and rate - 2 * error > 2:
        wrong.append(f"the runner's memory grows by {rate:.2f} ± {error:.2f} MiB/h over the last half")
    for at, what in ((3, "threads"), (4, "open files")):
        first, last = [s[at] for s in half[:len(half) // 2]], [s[at] for s in half[len(half) // 2:]]
        if first and min(last) > max(first):
            wrong.append(f"the runner's {what} grow: at most {max(first)}, then at least {min(last)}")
    return wrong, rate, error
