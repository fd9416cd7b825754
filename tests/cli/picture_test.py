"""Whose picture `pliant view --png` accepts: a program replaces Chromium and behaves like an
attacker. tests/viewer tests the drawings of Chromium.
"""

import contextlib
import importlib.machinery
import importlib.util
import json
import os
import re
import signal
import stat
import struct
import subprocess
import sys
import time
import unittest
import zlib

import numpy as np

from command import Command, PLIANT, SANITIZED, SCENE, SHIM, SOURCE, main
from view_server import HAS_PAGE

PYTHON = f"#!{sys.executable}\n"
# Started like Chromium. Each test appends its own code; results go to a file.
BROWSER = PYTHON + """
import json, os, re, resource, socket, struct, subprocess, sys, time, urllib.parse, zlib
way = urllib.parse.unquote_to_bytes(sys.argv[-1].removeprefix("file://"))
with open(way, encoding="utf-8") as file:
    address = re.search("url=([^\\"]*)", file.read()).group(1)
port, token = re.fullmatch(r"http://127\\.0\\.0\\.1:(\\d+)/([0-9a-f]{32})/take", address).groups()
own = f"127.0.0.1:{port}"
folder = os.path.dirname(os.path.abspath(__file__))
results = {"arguments": sys.argv[1:], "way": oct(os.stat(os.path.dirname(way)).st_mode), "token": token}

def send(text, body=b""):
    with socket.create_connection(("127.0.0.1", int(port)), timeout=20) as link:
        try:
            link.sendall(text.encode() + body)
            link.shutdown(socket.SHUT_WR)
        except OSError:  # closed while we were sending
            pass
        answer = b""
        try:
            while piece := link.recv(65536):
                answer += piece
        except ConnectionResetError:
            pass
    return answer

def ask(method, place, *lines, body=b"", host=own, secret=token):
    head = "\\r\\n".join([f"{method} /{secret}/{place} HTTP/1.1", f"Host: {host}", *lines, "", ""])
    return [int(word) for word in re.findall(rb"HTTP/1\\.1 (\\d+) ", send(head, body))]

def post(body, *lines, **options):
    return ask("POST", "picture", f"Content-Length: {len(body)}", *lines, body=body, **options)

def chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

def png(width, height, value=0):
    rows = (b"\\0" + bytes([value]) * (4 * width)) * height
    return (b"\\x89PNG\\r\\n\\x1a\\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))

def jobs(method="GET", place="job", body=b""):  # those whose pictures are missing
    head = f"{method} /{token}/{place} HTTP/1.1\\r\\nHost: {own}\\r\\nContent-Length: {len(body)}\\r\\n\\r\\n"
    return json.loads(send(head, body).split(b"\\r\\n\\r\\n")[1])

def parent(pid):
    with open(f"/proc/{pid}/stat") as file:
        return int(file.read().rpartition(") ")[2].split()[1])

def note():  # ahead of the picture, which ends us
    with open(os.path.join(folder, "results.json"), "w", encoding="utf-8") as file:
        json.dump(results, file)

"""

RENDERS = importlib.util.find_spec("PIL") is not None


def size_of(png):
    return struct.unpack(">II", png[16:24])


@unittest.skipUnless(HAS_PAGE, "this build has no page")
class Picture(Command):
    def program(self, name, text):
        """Makes a program that replaces one of that name."""
        os.chmod(self.write(name, text), stat.S_IRWXU)

    def words(self, *options, scene=None):
        scene = scene or self.write("scene.xml", SCENE.format(end=30))
        if "--movie" not in options:
            options = ("--png", "out.png", *options)
        if "--size" not in options:
            options = ("--size", "64x48", *options)
        return ("view", scene, "--quiet", *options)

    def variables(self, **more):
        return {**os.environ, "PATH": self.folder + os.pathsep + os.environ["PATH"], **more}

    def draw(self, work, *options, code=0, scene=None, **variables):
        """The run, and the results of the program that replaces Chromium."""
        self.program("chromium", BROWSER + work + "\ntime.sleep(60)\n")
        result = self.run_pliant(*self.words(*options, scene=scene), code=code, env=self.variables(**variables))
        try:
            with open(self.path("results.json"), encoding="utf-8") as file:
                return result, json.load(file)
        except FileNotFoundError:  # it wrote no results
            return result, None

    def test_a_whole_picture_is_taken_as_it_is(self):
        self.draw('good = png(64, 48, 7)\nopen(os.path.join(folder, "sent.png"), "wb").write(good)\npost(good)')
        self.assertEqual(self.read("out.png"), self.read("sent.png"))

    def test_a_sheet_has_the_size_of_all_its_frames(self):
        self.draw("job, = jobs()\n"
                  "rows = -(-len(job['frames']) // job['columns'])\n"
                  "post(png(job['columns'] * job['width'], rows * (job['height'] + job['label']) + job['strip']))", "--contact-sheet")
        self.assertEqual(size_of(self.read("out.png")), (4 * 64, 3 * (48 + 28) + 76))

    def job(self, *options, scene=None):
        """What the page is to draw."""
        _, results = self.draw("job, = jobs()\nresults['job'] = job\nnote()\nrows = -(-len(job['frames']) // job['columns'])\n"
                               "post(png(job['columns'] * job['width'], rows * (job['height'] + job['label']) + job['strip']))",
                               *options, scene=scene)
        return results["job"]

    def test_a_sheet_has_the_frames_that_tell_the_motion(self):
        # It is struck, rings, is held by a damping, and struck again.
        scene = self.write("scene.xml", '''<scene version="1" start="-5" end="90"><surface name="sheet">
            <grid columns="13" rows="11" width="12" depth="10"/><material density="40" damping="20"/><solver region="all"/></surface>
            <point name="poke" center="0 0 0" forceRadius="2.5"><animate attribute="magnitude">
            <key frame="-5" value="0"/><key frame="4" value="9000"/><key frame="5" value="0"/><key frame="50" value="0"/>
            <key frame="60" value="-5000"/><key frame="61" value="0"/></animate></point></scene>''')
        self.run_pliant("bake", scene, "-o", "b.npy", "--quiet")
        baked = np.load(self.path("b.npy"))
        displaced = np.linalg.norm(baked - baked[0], axis=2).max(axis=1)
        steps = np.diff(baked, axis=0)
        turns = np.einsum("fvk,fvk->f", steps[:-1], steps[1:])
        frames = self.job("--contact-sheet", scene=scene)["frames"]
        self.assertEqual(len(frames), 12)
        self.assertEqual(frames, sorted(set(frames)))
        self.assertEqual((frames[0], frames[-1]), (-5, 90))
        self.assertIn(int(displaced.argmax()) - 5, frames)
        marks = {k - 5 for k in range(1, 95) if turns[k - 1] < 0 or displaced[k - 1] < displaced[k] >= displaced[k + 1]}
        self.assertGreater(len(marks), 5)
        self.assertLessEqual(marks, set(frames))
        self.assertEqual(self.job("--contact-sheet", scene=scene)["frames"], frames)
        some = self.job("--contact-sheet", "--frames", "10:20", scene=scene)["frames"]
        self.assertEqual(some, list(range(10, 21)))
        self.assertEqual(self.job("--frame", "7", scene=scene)["frames"], [7])

    @unittest.skipUnless(RENDERS, "script/render needs Pillow")
    def test_the_script_that_renders_has_the_same_rule_and_the_peak_of_the_bake(self):
        loader = importlib.machinery.SourceFileLoader("render", os.path.join(SOURCE, "script/render"))
        render = importlib.util.module_from_spec(importlib.util.spec_from_loader("render", loader))
        sys.dont_write_bytecode = True
        loader.exec_module(render)
        for name in ("dent",) if SANITIZED else ("sheet", "dent", "flag"):
            scene = os.path.join(SOURCE, "examples", f"{name}.xml")
            peak = re.search(r"peak displacement (\S+)", self.run_pliant("bake", scene, "-o", f"{name}.obj").stdout)[1]
            files = render.sequence(self.path(f"{name}.obj"))
            course = render.course(files[number] for number in sorted(files))
            first = min(files)
            shown = [first + k for k in render.telling_frames(*course, 12)]
            self.assertEqual(self.job("--contact-sheet", scene=scene)["frames"], shown, name)
            for frames in ("1", "2,5", None) if name == "dent" else ():
                told = subprocess.run([os.path.join(SOURCE, "script/render"), f"{name}.obj", "-o", "r.png", "--dpi", "20",
                                       *(["--frames", frames] if frames else [])],
                                      cwd=self.folder, check=True, capture_output=True, text=True).stdout
                self.assertIn(f"peak displacement {peak} from frame {first}, in frames {first} to {max(files)}\n", told)

    @unittest.skipUnless(RENDERS, "script/render needs Pillow")
    def test_the_script_that_renders_says_which_files_there_are(self):
        scene = self.write("still.xml", SCENE.format(end=9).replace("3000", "0"))
        self.run_pliant("bake", scene, "-o", "a.obj", "--quiet")
        for number in (2, 5, 9):
            os.remove(self.path(f"a.{number:04}.obj"))
        told = subprocess.run([os.path.join(SOURCE, "script/render"), "a.obj", "-o", "r.png", "--dpi", "20"],
                              cwd=self.folder, check=True, capture_output=True, text=True).stdout
        self.assertTrue(told.endswith("peak displacement 0 from frame 1, in 6 of frames 1 to 8\n"), told)

    def test_no_list_of_processes_shows_the_token(self):
        work = "note()\npost(png(64, 48))"
        _, results = self.draw(work)
        self.assertNotIn(results["token"], " ".join(results["arguments"]))
        self.assertEqual(results["way"][-3:], "700")

    def test_a_program_gets_no_descriptors_but_its_streams(self):
        _, results = self.draw("""
def opened(process): return sorted(os.readlink(f"/proc/{process}/fd/{each}") for each in os.listdir(f"/proc/{process}/fd"))
held = subprocess.run(["/bin/ls", "-l", "/proc/self/fd/"], close_fds=False, stdout=subprocess.PIPE, text=True).stdout
results["own"], results["keeper"] = held, opened(os.getppid())
note()
post(png(64, 48))
""")
        self.assertNotIn("socket:", results["own"])
        self.assertFalse([each for each in results["keeper"] if "socket:" in each], results["keeper"])

    def test_from_elsewhere_nothing_is_taken(self):
        work = """
bad = png(64, 48, 1)
results["answers"] = [
    post(bad, secret="0" * 32), post(bad, secret=token[:-1]), post(bad, secret=""), post(bad, host="evil.example"),
    post(bad, "Origin: http://evil.example"), post(bad, "Origin: null"), post(bad, "Sec-Fetch-Site: cross-site"),
    post(bad, "Sec-Fetch-Site: none"), post(bad, "Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: document"),
    ask("GET", "take", "Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: iframe"),
    ask("GET", "take", "Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: no-cors", "Sec-Fetch-Dest: script"),
]
inner = f"POST /{token}/picture HTTP/1.1\\r\\nHost: {own}\\r\\nContent-Length: {len(bad)}\\r\\n\\r\\n".encode() + bad
results["smuggled"] = [post(inner, host="evil.example"), post(inner, secret="0" * 32),
                       ask("POST", "picture", "Transfer-Encoding: chunked", body=b"0\\r\\n\\r\\n" + inner)]
results["own"] = [ask("GET", "take", "Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: document"),
                  ask("GET", "job", "Sec-Fetch-Site: same-origin"), ask("PUT", "picture"), ask("GET", "picture")]
note()
post(png(64, 48, 9), f"Origin: http://{own}", "Sec-Fetch-Site: same-origin")
"""
        _, results = self.draw(work)
        self.assertEqual(results["answers"], [[403]] * 11)
        self.assertEqual(results["smuggled"], [[403], [403], [501]])
        self.assertEqual(results["own"], [[200], [200], [405], [405]])
        self.assertIn(zlib.compress((b"\0" + b"\x09" * 256) * 48, 1), self.read("out.png"))

    def test_a_body_has_a_length_and_a_bound(self):
        work = """
length = lambda value, *lines: ask("POST", "picture", f"Content-Length: {value}", *lines, body=b"x" * 1000)
results["answers"] = [
    length(10**6), length(2**63), length(2**64 - 1), length("0, 0"), length(-1), length(7, "Expect: 200-ok"),
    ask("POST", "picture", "Content-Length: 7", "Content-Length: 7", body=b"1234567"),
    ask("POST", "picture", "Transfer-Encoding: chunked", body=b"ffffffffffffffff\\r\\n" + b"x" * 1000),
    ask("POST", "picture", "Transfer-Encoding: chunked", "Content-Length: 7", body=b"1234567")]
half = ask("POST", "picture", "Content-Length: 5000", body=b"x" * 100)  # and gone
results["answers"].append(half)
note()
post(png(64, 48))
"""
        _, results = self.draw(work)
        self.assertEqual(results["answers"], [[413]] * 3 + [[400]] * 2 + [[417], [400], [501], [400], []])

    def test_only_one_body_is_received_at_a_time(self):
        work = """
slow = socket.create_connection(("127.0.0.1", int(port)))
slow.sendall(f"POST /{token}/picture HTTP/1.1\\r\\nHost: {own}\\r\\nContent-Length: 5000\\r\\n\\r\\nx".encode())
time.sleep(0.3)
results["second"] = post(png(64, 48))
slow.close()
time.sleep(0.3)
note()
post(png(64, 48))
"""
        _, results = self.draw(work)
        self.assertEqual(results["second"], [503])

    def test_what_is_no_such_picture_ends_the_run(self):
        for work, words in (("b'<html>'", "it is not a PNG"), ("b''", "it is not a PNG"),
                            ("png(64, 48)[:-1]", "it is truncated"), ("png(64, 48) + b'x'", "data after its end"),
                            ("png(48, 64)", "it has 48 x 64 pixels, not 64 x 48"),
                            ("b'GIF89a' + png(64, 48)", "it is not a PNG"),
                            ("png(64, 48).replace(b'IDAT', b'IDAU')", "checksum")):
            with self.subTest(work):
                result, _ = self.draw(f"post({work})", code=1)
                self.assertIn("an unusable picture: ", result.stderr)
                self.assertIn(words, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertNotIn("out.png", self.files())

    def test_a_second_picture_is_refused(self):
        # Both at the same time, so that the command cannot end between them.
        work = """
good = png(64, 48, 3)
one = f"POST /{token}/picture HTTP/1.1\\r\\nHost: {own}\\r\\nContent-Length: {len(good)}\\r\\n\\r\\n".encode() + good
other = png(64, 48, 4)
two = f"POST /{token}/picture HTTP/1.1\\r\\nHost: {own}\\r\\nContent-Length: {len(other)}\\r\\n\\r\\n".encode() + other
answer = send("", one + two)
"""
        self.draw(work)
        self.assertIn(zlib.compress((b"\0" + b"\x03" * 256) * 48, 1), self.read("out.png"))

    def test_the_folder_for_temporary_files_may_have_any_name(self):
        os.mkdir(self.path("behind"))
        os.symlink(self.path("behind"), self.path("link"))
        for place in ("link", self.path("link"), "behind/", "./behind//", self.path("behind") + "/.", "link/../behind"):
            with self.subTest(place):
                self.draw("note()\npost(png(64, 48, 5))", TMPDIR=place)
                self.assertEqual(os.listdir(self.path("behind")), [])
                os.remove(self.path("out.png"))
        deep = os.path.join(self.folder, *["x" * 200] * 4)
        os.makedirs(deep)
        self.draw("note()\npost(png(64, 48, 5))", TMPDIR=deep)
        self.assertEqual(os.listdir(deep), [])
        os.remove(self.path("out.png"))
        self.draw("results['place'] = os.path.dirname(os.path.dirname(way)).decode()\nnote()\npost(png(64, 48, 5))", TMPDIR="")
        self.assertEqual(json.loads(self.read("results.json"))["place"], "/tmp")
        os.remove(self.path("out.png"))
        for name in (b"a b", b"a#b", b"a?b", b"a%41b", b"%", b"a%%d", b"a'\"\\b", b"\xff\xc3\xa9", b"a\nb", b"-a", b"a;b&c", b"x" * 240):
            for place in (os.path.join(os.fsencode(self.folder), name), name):  # absolute, and relative
                with self.subTest(place):
                    os.makedirs(os.path.join(os.fsencode(self.folder), name), exist_ok=True)
                    self.draw("note()\npost(png(64, 48, 5))", TMPDIR=os.fsdecode(place))
                    self.assertEqual(os.listdir(os.path.join(os.fsencode(self.folder), name)), [])
                    os.remove(self.path("out.png"))

    def test_a_folder_for_temporary_files_that_cannot_be_is_refused_ahead_of_the_run(self):
        self.write("file", "")
        closed = self.path("closed")
        os.mkdir(closed, 0o500)
        places = [(self.path("none"), "No such file"), (self.path("file"), "Not a directory"), ("none", "No such file")]
        if os.geteuid() != 0:
            places.append((closed, "Permission denied"))
        self.program("chromium", "#!/bin/sh\n")
        self.program("ffmpeg", "#!/bin/sh\n")
        for place, reason in places:
            for options in ((), ("--contact-sheet",), ("--movie", "out.mp4"), ("--movie", "out.gif")):
                with self.subTest(place, options=options):
                    result = self.run_pliant(*self.words(*options), code=1, env=self.variables(TMPDIR=place))
                    self.assertRegex(result.stderr, r"\Apliant: error: cannot make a folder for temporary files in .*, which TMPDIR names: .*\n\Z")
                    self.assertIn(place, result.stderr)
                    self.assertIn(reason, result.stderr)
                    self.assertFalse({"out.png", "out.mp4", "out.gif"} & set(self.files()))

    # Programs that a browser starts, in sessions and groups of their own, which ignore what can be
    # ignored; each writes its number into a file.
    FAMILY = """
child = (f"import os, signal, time\\n"
         f"for number in (1, 2, 15): signal.signal(number, signal.SIG_IGN)\\n"
         f"open(os.path.join({folder!r}, f'child-{{os.getpid()}}'), 'w').close()\\ntime.sleep(600)")
for options in ({}, {"start_new_session": True}, {"process_group": 0} if sys.version_info >= (3, 11) else {"start_new_session": True}):
    subprocess.Popen([sys.executable, "-c", child], **options)
# One whose parent ends at once.
subprocess.run([sys.executable, "-c", f"import subprocess, sys; subprocess.Popen([sys.executable, '-c', {child!r}], start_new_session=True)"])
open(os.path.join(folder, f"child-{os.getpid()}"), "w").close()
"""

    def family(self):
        return [int(name.removeprefix("child-")) for name in self.files() if name.startswith("child-")]

    def await_family(self, process, count):
        deadline = time.monotonic() + 60
        while len(self.family()) < count and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.02)
        self.assertEqual(len(self.family()), count)
        return self.family()

    def await_end_of(self, processes):
        deadline = time.monotonic() + 120
        def runs(each):
            try:
                with open(f"/proc/{each}/stat", encoding="utf-8") as file:
                    return file.read().rpartition(") ")[2][0] not in "ZX"
            except (FileNotFoundError, ProcessLookupError):  # it ended before it was opened, or read
                return False
        while any(map(runs, processes)) and time.monotonic() < deadline:
            time.sleep(0.02)
        self.assertEqual([each for each in processes if runs(each)], [])

    def test_whatever_ends_the_command_ends_its_programs_and_removes_their_files(self):
        self.program("chromium", BROWSER + self.FAMILY + "time.sleep(600)\n")
        self.program("ffmpeg", BROWSER.partition("way =")[0] + "folder = os.path.dirname(os.path.abspath(__file__))\n" + self.FAMILY + "time.sleep(600)\n")
        for options, count in (((), 5), (("--movie", "out.mp4"), 10)):
            for numbers in ((signal.SIGKILL,), (signal.SIGINT,), (signal.SIGTERM,), (signal.SIGHUP,), (signal.SIGINT, signal.SIGINT), (signal.SIGABRT,)):
                with self.subTest(options, numbers=numbers):
                    os.mkdir(self.path("scratch"))
                    with subprocess.Popen([PLIANT, *self.words(*options)], cwd=self.folder, stderr=subprocess.DEVNULL,
                                          env=self.variables(TMPDIR=self.path("scratch"))) as process:
                        family = self.await_family(process, count)
                        for number in numbers:
                            process.send_signal(number)
                        process.wait(timeout=60)
                    self.await_end_of(family)
                    deadline = time.monotonic() + 20
                    while os.listdir(self.path("scratch")) and time.monotonic() < deadline:
                        time.sleep(0.02)
                    os.rmdir(self.path("scratch"))  # only if it is empty
                    parts = [name for name in self.files() if name.endswith(".part")]
                    if numbers in ((signal.SIGINT,), (signal.SIGTERM,), (signal.SIGHUP,)):
                        self.assertEqual(parts, [])
                    for part in parts:
                        os.remove(self.path(part))
                    self.assertEqual([name for name in self.files() if name.startswith("out")], [])
                    for each in family:
                        os.remove(self.path(f"child-{each}"))

    # Programs that write their numbers, and wait.
    WAITS = "open(os.path.join(folder, f'child-{os.getpid()}'), 'w').close()\ntime.sleep(600)\n"

    def start_both(self, *options, begins="", variables={}, **more):
        """A movie or picture whose programs do nothing, with its temporary files in `scratch`."""
        self.program("chromium", BROWSER + begins + self.WAITS)
        self.program("ffmpeg", BROWSER.partition("way =")[0] + "folder = os.path.dirname(os.path.abspath(__file__))\n" + begins + self.WAITS)
        os.makedirs(self.path("scratch"), exist_ok=True)
        return subprocess.Popen([PLIANT, *self.words(*options)], cwd=self.folder, stderr=subprocess.PIPE, text=True,
                                env=self.variables(TMPDIR=self.path("scratch"), **variables), **more)

    def descendants(self, process):
        found = [process]
        for each in found:  # grows meanwhile
            for task in os.listdir(f"/proc/{each}/task"):
                with open(f"/proc/{each}/task/{task}/children", encoding="ascii") as file:
                    found += map(int, file.read().split())
        return found[1:]

    def await_empty(self, folder):
        # The thread sanitizer's own file, which it removes at once, is left by a kill in that moment.
        def left_in():
            return [name for name in os.listdir(folder) if not name.startswith("tsan.rodata.")]

        deadline = time.monotonic() + 120
        while left_in() and time.monotonic() < deadline:
            time.sleep(0.02)
        if left := left_in():
            self.fail(f"{left}\n" + subprocess.run(["sh", "-c", "cd /proc; for p in [1-9]*; do tr '\\0' ' ' < $p/cmdline && echo; done"],
                                                   check=False, capture_output=True, text=True).stdout)

    def test_at_whatever_moment_the_command_ends_nothing_is_left(self):
        for options, numbers in ((("--movie", "out.mp4"), (signal.SIGKILL,)), (("--movie", "out.gif"), (signal.SIGINT,)),
                                 (("--movie", "out.webm"), (signal.SIGTERM, signal.SIGINT)), ((), (signal.SIGKILL,)), ((), (signal.SIGINT, signal.SIGINT))):
            for k in range(10):
                with self.subTest(options, numbers=numbers, moment=k), self.start_both(*options) as process:
                    time.sleep(0.02 * k)
                    for number in numbers:
                        process.send_signal(number)
                    errors = process.communicate(timeout=60)[1]
                    if numbers == (signal.SIGINT,) and errors:
                        self.assertRegex(errors, r"\Apliant: error: interrupted[^\n]*\n\Z")
                self.await_empty(self.path("scratch"))
                self.await_end_of(self.family())
                self.assertEqual([name for name in self.files() if name.startswith("out")], [])

    def test_a_kill_of_its_group_or_of_all_its_keepers_ends_the_programs(self):
        for kind in ("group", "keepers", "keepers by a request"):
            with self.subTest(kind), self.start_both("--movie", "out.mp4", begins=self.FAMILY, start_new_session=True) as process:
                family = self.await_family(process, 10)
                keepers = [each for each in self.descendants(process.pid) if each not in family]
                self.assertEqual(len(keepers), 4)
                if kind == "group":
                    os.killpg(process.pid, signal.SIGKILL)
                for keeper in keepers if kind != "group" else []:
                    os.kill(keeper, signal.SIGKILL if kind == "keepers" else signal.SIGTERM)
                if kind == "keepers by a request":  # which they pass over
                    process.send_signal(signal.SIGTERM)
                process.communicate(timeout=60)
                self.assertEqual(process.returncode, -signal.SIGKILL if kind == "group" else 1)
                self.await_end_of([*family, *keepers])
                self.await_empty(self.path("scratch"))
                for each in family:
                    os.remove(self.path(f"child-{each}"))

    def test_a_process_that_ends_while_its_keeper_looks_at_it_keeps_it_from_nothing(self):
        if not SHIM:
            self.skipTest("the shim does not go with a sanitizer")
        with self.start_both(begins=self.FAMILY, variables={"LD_PRELOAD": SHIM, "PLIANT_SHIM_FAIL": "process 3"}) as process:
            family = self.await_family(process, 5)
            process.kill()
            process.communicate(timeout=60)
        self.await_end_of(family)
        self.await_empty(self.path("scratch"))

    def test_what_is_left_when_all_are_killed_at_once_is_removed_by_the_next(self):
        scratch = self.path("scratch")
        with self.start_both("--movie", "out.mp4") as process:
            family = self.await_family(process, 2)
            everyone = (process.pid, *self.descendants(process.pid))
            for each in everyone:
                os.kill(each, signal.SIGSTOP)
            for each in everyone:
                with contextlib.suppress(ProcessLookupError):  # the system ends some with another
                    os.kill(each, signal.SIGKILL)
            process.communicate(timeout=60)
        self.await_end_of(family)
        for each in family:
            os.remove(self.path(f"child-{each}"))
        left = os.listdir(scratch)
        self.assertEqual(len(left), 2)
        # What is not ours, or in use, stays.
        others = ["pliant-view-photos", "pliant-view-abcdef", "other"]
        for name in others:
            os.mkdir(os.path.join(scratch, name))
            open(os.path.join(scratch, name, "kept" if name == "other" else "mine"), "w", encoding="utf-8").close()
        os.symlink(self.folder, os.path.join(scratch, "pliant-view-linked"))
        with self.start_both("--movie", "out.mp4") as process:
            self.await_family(process, 2)
            used = set(os.listdir(scratch)) - {*left, *others, "pliant-view-linked"}
            self.assertEqual(len(used), 2)
            self.draw("note()\npost(png(64, 48, 5))", TMPDIR=scratch)
            self.assertEqual(set(os.listdir(scratch)), {*used, *others, "pliant-view-linked"})
            process.send_signal(signal.SIGKILL)
            process.communicate(timeout=60)
        deadline = time.monotonic() + 20
        while set(os.listdir(scratch)) & used and time.monotonic() < deadline:
            time.sleep(0.02)
        self.assertEqual(set(os.listdir(scratch)), {*others, "pliant-view-linked"})
        self.assertIn("scratch", self.files())

    def test_a_kill_while_no_program_runs_leaves_nothing(self):
        # ffmpeg has ended, and its movie, which has no end, is copied.
        self.program("ffmpeg", PYTHON + """
import os, shutil, sys
shutil.copyfileobj(sys.stdin.buffer, open(os.devnull, "wb"))
open(sys.argv[-1], "w").truncate(20_000_000_000)
open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "written"), "w").close()
""")
        self.program("chromium", BROWSER + "for _ in range(2): post(bytes(64 * 48 * 4))\ntime.sleep(600)\n")
        for number in (signal.SIGKILL, signal.SIGINT):
            os.mkdir(self.path("scratch"))
            with subprocess.Popen([PLIANT, *self.words("--movie", "out.mp4", "--frames", "1:2")], cwd=self.folder, stderr=subprocess.DEVNULL,
                                  env=self.variables(TMPDIR=self.path("scratch"))) as process:
                deadline = time.monotonic() + 60
                while "written" not in self.files() and time.monotonic() < deadline:
                    time.sleep(0.01)
                time.sleep(0.2)
                process.send_signal(number)
                process.wait(timeout=60)
            self.await_empty(self.path("scratch"))
            os.rmdir(self.path("scratch"))
            os.remove(self.path("written"))
            self.assertNotIn("out.mp4", self.files())

    def test_a_program_with_a_strange_name_ends_too(self):
        self.draw("""
name = "libc.so.6"
work = ("import ctypes, os, time\\nctypes.CDLL('libc.so.6').prctl(15, b') Z 1\\\\n) ', 0, 0, 0)\\n"
        f"open(os.path.join({folder!r}, f'child-{{os.getpid()}}'), 'w').close()\\ntime.sleep(600)")
subprocess.Popen([sys.executable, "-c", work])
while not [each for each in os.listdir(folder) if each.startswith("child-")]: time.sleep(0.02)
note()
post(png(64, 48))
""")
        self.assertEqual(len(self.family()), 1)
        self.await_end_of(self.family())

    def test_programs_are_found_on_a_path_of_relative_folders(self):
        self.program("chromium", BROWSER + "post(png(64, 48))\ntime.sleep(60)\n")
        for folder in (".", "./.", "../" + os.path.basename(self.folder)):
            with self.subTest(folder):
                self.run_pliant(*self.words(), env={**os.environ, "PATH": folder})
                os.remove(self.path("out.png"))

    def test_what_the_programs_print_is_short_and_harmless(self):
        noise = "\x1b]0;owned\x07\x1b[2J\0" + "x" * 5_000_000
        self.program("ffmpeg", PYTHON + f"import sys\nsys.stdout.write({noise!r})\nsys.stderr.write({noise!r})\nsys.exit(1)\n")
        shout = f"sys.stdout.write({noise!r})\nsys.stderr.write({noise!r})\n"
        result, _ = self.draw(shout + "post(bytes(64 * 48 * 4))", "--movie", "out.mp4", code=1)
        self.assertTrue(result.stderr.isprintable() or result.stderr.count("\n") == 1, result.stderr[:100])
        self.assertNotIn("\x1b", result.stderr)
        self.assertLess(len(result.stderr), 2000)
        self.assertEqual(result.stdout, "")
        result, _ = self.draw(shout + "post(png(64, 48))")
        self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_an_end_of_ffmpeg_is_noticed_before_the_next_picture(self):
        self.program("ffmpeg", PYTHON + f"import sys\nsys.stdin.buffer.read({64 * 48 * 4})\nsys.exit('no room')\n")
        result, _ = self.draw("post(bytes(64 * 48 * 4))", "--movie", "out.mp4", code=1)  # and no second one
        self.assertIn("ffmpeg could not write the movie: no room", result.stderr)

    def test_what_a_browser_leaves_ends_with_the_command(self):
        self.draw(self.FAMILY + "while len([name for name in os.listdir(folder) if name.startswith('child-')]) < 5: time.sleep(0.02)\n"
                  "note()\npost(png(64, 48))")
        family = self.family()
        self.assertEqual(len(family), 5)
        self.await_end_of(family)

    # Stores its input; its output is one byte.
    FFMPEG = PYTHON + """
import os, shutil, sys
with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "frames"), "wb") as file:
    shutil.copyfileobj(sys.stdin.buffer, file)
open(sys.argv[-1], "w").write("m")
"""

    def test_a_movie_has_the_frames_in_their_order_and_few_are_ordered_ahead(self):
        self.program("ffmpeg", self.FFMPEG)
        _, results = self.draw("""
results["ahead"], results["frames"] = [], []
waiting = jobs()
while len(results["frames"]) < 30:
    while not waiting:
        time.sleep(0.002)
        waiting = jobs()
    results["ahead"].append(len(waiting))
    frame, = waiting[0]["frames"]
    results["frames"].append(frame)
    if len(results["frames"]) == 30: note()
    waiting = jobs("POST", "picture", bytes([frame, 0, 0, 255]) * (64 * 48))
""", "--movie", "out.mp4")
        self.assertEqual(results["frames"], list(range(1, 31)))
        self.assertLessEqual(max(results["ahead"]), 4)
        self.assertEqual(self.read("frames"), b"".join(bytes([frame, 0, 0, 255]) * (64 * 48) for frame in range(1, 31)))
        self.assertEqual(self.read("out.mp4"), b"m")

    def test_a_frame_of_another_size_ends_the_movie(self):
        self.program("ffmpeg", self.FFMPEG)
        for size in (0, 64 * 48 * 4 - 1, 64 * 48 * 3):
            with self.subTest(size):
                result, _ = self.draw(f"post(bytes({size}))", "--movie", "out.mp4", code=1)
                self.assertRegex(result.stderr, rf"\Apliant: error: Chromium sent an unusable picture: it has {size} bytes, not those of 64 x 48 pixels\n\Z")
                self.assertNotIn("out.mp4", self.files())
        _, results = self.draw("results['longer'] = post(bytes(64 * 48 * 4 + 1))\nnote()\npost(b'')", "--movie", "out.mp4", code=1)
        self.assertEqual(results["longer"], [413])

    @unittest.skipIf(SANITIZED, "a sanitizer takes all of the address space")
    def test_too_little_memory_is_answered(self):
        work = """
pid = parent(os.getppid())  # a keeper is between us and the command
pages = int(open(f"/proc/{pid}/statm").read().split()[0]) * resource.getpagesize()
whole = resource.prlimit(pid, resource.RLIMIT_AS)
resource.prlimit(pid, resource.RLIMIT_AS, (pages + 20_000_000, whole[1]))
results["scarce"] = post(b"x" * 200_000_000)
results["after"] = ask("GET", "job")
resource.prlimit(pid, resource.RLIMIT_AS, whole)
note()
post(b"no picture")
"""
        _, results = self.draw(work, "--size", "8192x8192", code=1)
        self.assertEqual((results["scarce"], results["after"]), ([503], [200]))


if __name__ == "__main__":
    main()
