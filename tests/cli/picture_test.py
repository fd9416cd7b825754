"""Whose picture `pliant view --png` accepts: a program replaces Chromium and behaves like an
attacker. tests/viewer tests the drawings of Chromium.
"""

import importlib.machinery
import importlib.util
import json
import os
import re
import stat
import struct
import subprocess
import sys
import unittest
import zlib

import numpy as np

from command import Command, SANITIZED, SCENE, SOURCE, main
from view_server import HAS_PAGE

# Started like Chromium. Each test appends its own code; results go to a file.
BROWSER = """#!/usr/bin/python3
import json, os, re, resource, socket, struct, sys, time, zlib
way = sys.argv[-1].removeprefix("file://")
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

def note():  # ahead of the picture, which ends us
    with open(os.path.join(folder, "results.json"), "w", encoding="utf-8") as file:
        json.dump(results, file)

"""

RENDERS = importlib.util.find_spec("matplotlib") is not None


def size_of(png):
    return struct.unpack(">II", png[16:24])


@unittest.skipUnless(HAS_PAGE, "this build has no page")
class Picture(Command):
    def draw(self, work, *options, code=0, scene=None):
        """The run, and the results of the program that replaces Chromium."""
        scene = scene or self.write("scene.xml", SCENE.format(end=30))
        program = self.write("chromium", BROWSER + work + "\ntime.sleep(60)\n")
        os.chmod(program, stat.S_IRWXU)
        path = self.folder + os.pathsep + os.environ["PATH"]
        result = self.run_pliant("view", scene, "--png", "out.png", "--quiet", *(options if "--size" in options else ("--size", "64x48", *options)),
                                 code=code, env={**os.environ, "PATH": path})
        try:
            with open(self.path("results.json"), encoding="utf-8") as file:
                return result, json.load(file)
        except FileNotFoundError:  # it wrote no results
            return result, None

    def test_a_whole_picture_is_taken_as_it_is(self):
        self.draw('good = png(64, 48, 7)\nopen(os.path.join(folder, "sent.png"), "wb").write(good)\npost(good)')
        self.assertEqual(self.read("out.png"), self.read("sent.png"))

    def test_a_sheet_has_the_size_of_all_its_frames(self):
        self.draw("job = json.loads(send(f'GET /{token}/job HTTP/1.1\\r\\nHost: {own}\\r\\n\\r\\n').split(b'\\r\\n\\r\\n')[1])\n"
                  "rows = -(-len(job['frames']) // job['columns'])\n"
                  "post(png(job['columns'] * job['width'], rows * (job['height'] + job['label']) + job['strip']))", "--contact-sheet")
        self.assertEqual(size_of(self.read("out.png")), (4 * 64, 3 * (48 + 28) + 76))

    def job(self, *options, scene=None):
        """What the page is to draw."""
        _, results = self.draw("results['job'] = json.loads(send(f'GET /{token}/job HTTP/1.1\\r\\nHost: {own}\\r\\n\\r\\n').split(b'\\r\\n\\r\\n')[1])\n"
                               "note()\njob = results['job']\nrows = -(-len(job['frames']) // job['columns'])\n"
                               "post(png(job['columns'] * job['width'], rows * (job['height'] + job['label']) + job['strip']))", *options, scene=scene)
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

    @unittest.skipUnless(RENDERS, "script/render needs matplotlib")
    def test_the_script_that_renders_has_the_same_rule_and_the_peak_of_the_bake(self):
        loader = importlib.machinery.SourceFileLoader("render", os.path.join(SOURCE, "script/render"))
        render = importlib.util.module_from_spec(importlib.util.spec_from_loader("render", loader))
        sys.dont_write_bytecode = True
        loader.exec_module(render)
        for name in ("sheet", "dent", "flag"):
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

    @unittest.skipUnless(RENDERS, "script/render needs matplotlib")
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
    length(10**6), length(2**63), length(2**64 - 1), length("0, 0"), length(-1), length(7, "Expect: 100-continue"),
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

    @unittest.skipIf(SANITIZED, "a sanitizer takes all of the address space")
    def test_too_little_memory_is_answered(self):
        work = """
pid = os.getppid()
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
