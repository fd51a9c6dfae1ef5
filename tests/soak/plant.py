"""The programs around a station, each a process of its own: broker, database, cell, `seamwright run --watch`, and who looks on.

Every process dies with this one, however it ends (PR_SET_PDEATHSIG, and stop_all())."""

import ctypes
import json
import os
import pwd
import queue
import re
import shutil
import signal
import socket
import subprocess
import threading
import time
import urllib.request
from pathlib import Path

POSTGRES = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
_libc = ctypes.CDLL(None)
_started = []
_wanted = queue.Queue()
_over = False


def tool(name):
    return shutil.which(name) or shutil.which(name, path="/usr/sbin:/usr/local/sbin:/usr/local/bin")


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def _with_parent():
    _libc.prctl(1, signal.SIGKILL)


# Linux kills with the thread that has started a process, so that is one that lives as long as the script.
def _starter():
    while True:
        command, out, more, answer = _wanted.get()
        try:
            child = subprocess.Popen(command, stderr=out, start_new_session=True, preexec_fn=_with_parent, **more)
            _started.append(child)
            answer.put(child)
        except OSError as error:
            answer.put(error)


threading.Thread(target=_starter, daemon=True).start()


def start(command, log, stdin=subprocess.DEVNULL, stdout=None, **more):
    if _over:
        raise RuntimeError("the soak is over")
    answer = queue.Queue()
    with open(log, "ab") as out:
        _wanted.put(([str(c) for c in command], out, {"stdin": stdin, "stdout": stdout or out, **more}, answer))
        child = answer.get()
    if isinstance(child, OSError):
        raise child
    return child


def descendants(pid):
    """`pid` and all that it started, those first that started others."""
    parents = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parents.setdefault(int((entry / "stat").read_text().rpartition(") ")[2].split()[1]), []).append(int(entry.name))
            except (OSError, IndexError):
                pass
    found, at = [pid], 0
    while at < len(found):
        found += parents.get(found[at], [])
        at += 1
    return found


def kill(child, how=signal.SIGKILL):
    """The process and its children, each by its number; waits until it is gone where it is killed."""
    if child is None or child.poll() is not None:
        return
    for pid in descendants(child.pid):
        try:
            os.kill(pid, how)
        except ProcessLookupError:
            pass
    if how == signal.SIGKILL:
        child.wait()


def stop_all():
    global _over
    _over = True
    for child in reversed(_started):
        kill(child, signal.SIGCONT)
        kill(child)


class Broker:
    """mosquitto, with what it keeps on disk after every change, so that a killed one comes back with it."""

    def __init__(self, folder):
        self.port, self.folder, self.child, self.started = free_port(), Path(folder), None, 0
        (self.folder / "broker").mkdir()
        own = "user root\n" if os.geteuid() == 0 else ""
        (self.folder / "mosquitto.conf").write_text(
            f"{own}listener {self.port} 127.0.0.1\nallow_anonymous true\npersistence true\n"
            f"persistence_location {self.folder}/broker/\nautosave_interval 1\nautosave_on_changes true\n")

    def start(self):
        self.child = start([tool("mosquitto"), "-c", self.folder / "mosquitto.conf"], self.folder / "mosquitto.log")
        until(lambda: answers(self.port), 60, "mosquitto answers")
        self.started = time.time()

    def kill(self):
        kill(self.child)

    def say(self, topic, message):
        return subprocess.run([tool("mosquitto_pub"), "-h", "127.0.0.1", "-p", str(self.port), "-q", "1", "-t", topic, "-m",
                               json.dumps(message)], capture_output=True, timeout=20).returncode == 0

    def kept(self, topic):
        """The retained message of a topic, as somebody sees it who comes new; None: there is none."""
        got = subprocess.run([tool("mosquitto_sub"), "-h", "127.0.0.1", "-p", str(self.port), "-t", topic, "-C", "1", "-W", "20",
                              "-F", "%r %p"], capture_output=True, timeout=40, text=True)
        return json.loads(got.stdout[2:]) if got.stdout.startswith("1 ") else None


class Listener:
    """mosquitto_sub with a session that outlives broker and connection: everything it is sent, as (topic, message)."""

    def __init__(self, broker, folder):
        self.messages, self.broker, self.folder, self.over = [], broker, Path(folder), False
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        while not self.over and not _over:
            child = start([tool("mosquitto_sub"), "-h", "127.0.0.1", "-p", str(self.broker.port), "-i", "soak-listener", "-c", "-q",
                           "1", "-k", "5", "-t", "seamwright/#", "-F", "%t %p"], self.folder / "mosquitto_sub.log",
                          stdout=subprocess.PIPE)
            for line in child.stdout:
                topic, _, text = line.decode("utf-8", "replace").partition(" ")
                try:
                    self.messages.append((topic, json.loads(text)))
                except ValueError:
                    self.messages.append((topic, None))
            child.wait()
            _started.remove(child)
            time.sleep(0.5)


    def heard(self, topic, number, seconds):
        """Whether the command of that id comes by within so long."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if any(t == topic and m and m.get("id") == number for t, m in self.messages[-50:]):
                return True
            time.sleep(0.05)
        return False


class Database:
    """A PostgreSQL server; as root it runs as the user postgres, since it refuses to run as root."""

    def __init__(self, folder):
        self.folder, self.port, self.child = Path(folder) / "postgres", free_port(), None
        self.folder.mkdir()
        self.bin = POSTGRES[-1].parent
        self.as_user = []
        if os.geteuid() == 0:
            user = pwd.getpwnam("postgres")
            os.chown(self.folder, user.pw_uid, user.pw_gid)
            self.as_user = ["setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups", "--pdeathsig", "KILL"]
        subprocess.run([*self.as_user, self.bin / "initdb", "-D", self.folder / "data", "-U", "seam", "--auth=trust", "-E", "UTF8",
                        "--locale=C", "--no-sync"], check=True, capture_output=True, cwd="/")
        self.url = f"postgresql://seam@127.0.0.1:{self.port}/fleet"

    def start(self):
        for _ in range(60):  # a killed one leaves its shared memory for a moment
            self.child = start([*self.as_user, self.bin / "postgres", "-D", self.folder / "data", "-p", self.port, "-k", self.folder,
                                "-c", "listen_addresses=127.0.0.1", "-c", "fsync=off"], self.folder.parent / "postgres.log", cwd="/")
            for _ in range(100):
                if self.ask("SELECT 1", "postgres") == "1":
                    return
                if self.child.poll() is not None:
                    break
                time.sleep(0.1)
            kill(self.child)
        raise RuntimeError("the database does not start: postgres.log")

    def kill(self):
        kill(self.child)

    def ask(self, sql, database="fleet"):
        got = subprocess.run(["psql", "-X", "-A", "-t", "-q", "-v", "ON_ERROR_STOP=1", "-h", "127.0.0.1", "-p", str(self.port), "-U",
                              "seam", "-d", database, "-c", sql], capture_output=True, text=True, timeout=60)
        return got.stdout.strip() if got.returncode == 0 else None


class Cell:
    """`seamwright sim-cell`: camera and controller. What stands on the controller outlives a killed one, as on a real one."""

    def __init__(self, program, folder, settings, project, time_scale):
        self.folder, self.settings = Path(folder), settings
        self.command = [program, "sim-cell", self.folder / "cell.json", "--project", project, "--time-scale", time_scale]
        self.child, self.lines, self.lock = None, queue.Queue(), threading.RLock()
        self.told = {}  # the lines that a new process is told first
        self.frames = {k: v for k, v in settings["robot"]["frames"].items()}
        self.starts = 0

    def start(self):
        with self.lock:
            self.settings["robot"]["frames"] = self.frames
            (self.folder / "cell.json").write_text(json.dumps(self.settings))
            self.lines = lines = queue.Queue()
            child = start(self.command, self.folder / "sim-cell.log", stdin=subprocess.PIPE, stdout=subprocess.PIPE)

            def read():
                for line in child.stdout:
                    lines.put(line)
                lines.put(None)

            threading.Thread(target=read, daemon=True).start()
            if lines.get(timeout=120) is None:
                raise RuntimeError("sim-cell does not start: sim-cell.log")
            self.child, self.starts = child, self.starts + 1
            for line in self.told.values():
                self.say(line)

    def say(self, line, wait_s=60):
        """The cell's state after it, or None: it is not there."""
        word = line.split()[0]
        with self.lock:
            if word in ("part", "type", "shift"):
                self.told[word] = line
            child = self.child
            if child is None or child.poll() is not None:
                return None
            try:
                child.stdin.write((line + "\n").encode())
                child.stdin.flush()
                answer = self.lines.get(timeout=wait_s)
            except (OSError, queue.Empty):
                return None
            if answer is None:
                return None
            state = json.loads(answer)
            if not state["ok"]:
                raise RuntimeError(f"sim-cell: {line}: {state['error']}")
            self.frames = state["frames"]
            return state

    def kill(self):
        with self.lock:
            self.say("state")
            kill(self.child)

    def hold(self, seconds):
        """Stands still as a whole, as a hung computer does."""
        with self.lock:
            kill(self.child, signal.SIGSTOP)
            time.sleep(seconds)
            kill(self.child, signal.SIGCONT)


class Runner:
    """`seamwright run --watch --push`, started again when it is gone, as systemd does. `events`: its log, line by line."""

    def __init__(self, program, folder, project, more=()):
        self.folder, self.port, self.child, self.wanted = Path(folder), free_port(), None, False
        self.log = self.folder / "watch.jsonl"
        self.command = [program, "run", project, "--watch", "--push", "--log", self.log, "--status", f"127.0.0.1:{self.port}", *more]
        self.events, self.changed, self.changes = [], threading.Condition(), []
        self.unplanned, self.expected = [], False
        for work in (self._keep, self._read):
            threading.Thread(target=work, daemon=True).start()

    def start(self):
        self.child = start(self.command, self.folder / "run.log")
        self.changes.append(time.time())
        self.wanted = True

    def stop(self):
        """The exit code after SIGTERM."""
        self.wanted = False
        self.child.terminate()
        self.changes.append(time.time())
        return self.child.wait(timeout=120)

    def kill(self):
        self.changes.append(time.time())
        self.expected = True
        kill(self.child)

    def _keep(self):
        while not _over:
            time.sleep(0.2)
            child = self.child
            if self.wanted and child is not None and child.poll() is not None:
                if not self.expected:
                    self.unplanned.append(f"ended by itself with {child.returncode}")
                self.expected = False
                time.sleep(1)  # RestartSec of the unit that `seamwright service` writes
                if self.wanted and not _over:
                    self.start()

    def _read(self):
        # Rotated when it is full: the file of that name is then another one.
        file = None
        rest = b""
        while True:
            if file is None:
                try:
                    file = open(self.log, "rb")
                except OSError:
                    time.sleep(0.1)
                    continue
            got = file.read(1 << 20)
            if not got:
                try:
                    if os.stat(self.log).st_ino != os.fstat(file.fileno()).st_ino:
                        file.close()
                        file = None
                        continue
                except OSError:
                    pass
                time.sleep(0.05)
                continue
            *lines, rest = (rest + got).split(b"\n")
            with self.changed:
                for line in lines:
                    try:
                        event = json.loads(line)
                    except ValueError:
                        event = {"event": "torn", "text": line.decode("utf-8", "replace")}
                    if event.get("event") != "spot":
                        self.events.append(event)
                self.changed.notify_all()

    def wait(self, wanted, seconds, since=0):
        """The first event from number `since` on that `wanted` takes, or None."""
        end = time.monotonic() + seconds
        with self.changed:
            at = since
            while True:
                while at < len(self.events):
                    if wanted(self.events[at]):
                        return self.events[at]
                    at += 1
                left = end - time.monotonic()
                if left <= 0:
                    return None
                self.changed.wait(min(left, 0.5))

    def usage(self):
        """(process, its own KiB, threads, files), or None. Its own: what it has allocated and written. Pages of the program
        and its libraries come in when a way through them is gone for the first time, and the system takes them back."""
        try:
            text = Path(f"/proc/{self.child.pid}/status").read_text()
            found = dict(re.findall(r"^(RssAnon|Threads):\s+(\d+)", text, re.M))
            files = len(os.listdir(f"/proc/{self.child.pid}/fd"))
            return self.child.pid, int(found["RssAnon"]), int(found["Threads"]), files
        except (OSError, KeyError):
            return None


class PageWatcher:
    """Asks the status page once a second: [(time, seconds until the answer or None)]."""

    def __init__(self, runner):
        self.answers, self.runner, self.over = [], runner, False
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        while not self.over:
            asked = time.time()
            try:
                with urllib.request.urlopen(f"http://127.0.0.1:{self.runner.port}/api/state", timeout=10) as page:
                    json.loads(page.read())
                self.answers.append((asked, time.time() - asked))
            except (OSError, ValueError):
                self.answers.append((asked, None))
            time.sleep(1)


def answers(port):
    with socket.socket() as s:
        s.settimeout(1)
        return s.connect_ex(("127.0.0.1", port)) == 0


def until(true, seconds, what):
    end = time.monotonic() + seconds
    while not true():
        if time.monotonic() > end:
            raise RuntimeError(f"not within {seconds} s: {what}")
        time.sleep(0.1)
