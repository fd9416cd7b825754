"""What `pliant edit` answers over HTTP: docs/editor.md. The page has tests of its own in a browser."""

import base64
import http.client
import json
import os
import random
import re
import resource
import select
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import time
import unittest
import zlib

from command import Command, PLIANT, SANITIZED, SCENE, SOURCE, main
from view_server import HAS_PAGE

PATIENCE = 120 if SANITIZED else 60  # seconds for what takes a moment
KEYED = SCENE.replace('magnitude="3000"/>', '><animate attribute="magnitude"><key frame="1" value="0"/>'
                      '<key frame="5" value="3000"/></animate></point>').replace('2.5" ><', '2.5"><')
# What takes a while.
SLOW = SCENE.replace('columns="13" rows="11"', f'columns="{61 if SANITIZED else 121}" rows="121"')


class Editor:
    """The command, and requests to it."""

    def __init__(self, folder, *arguments):
        self.errors = tempfile.TemporaryFile("w+", encoding="utf-8")
        environment = {**os.environ, "XDG_STATE_HOME": os.path.join(folder, "state")}
        self.process = subprocess.Popen([PLIANT, "edit", "--no-open", *arguments], stdout=subprocess.PIPE,
                                        stderr=self.errors, text=True, cwd=folder, env=environment)
        self.address = self.process.stdout.readline().rstrip("\n")
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)(/[0-9a-f]{32}/)", self.address)
        if not found:
            raise AssertionError(f"no address: {self.address!r}, {self.end()}")
        self.port, self.base = int(found[1]), found[2]
        self.link = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        self.used = time.monotonic()  # when the link last was

    def send(self, method, route, body=None, headers=None, base=None):
        if time.monotonic() - self.used > 10:  # the server closes one that is idle for 15 s
            self.link.close()
        try:
            self.link.request(method, (self.base if base is None else base) + route, body, headers or {})
            answer = self.link.getresponse()
            body = answer.read()
            self.used = time.monotonic()
            return answer.status, body
        except (http.client.HTTPException, ConnectionError):
            self.link.close()
            raise

    def get(self, route):
        status, body = self.send("GET", route)
        return status, json.loads(body) if body else None

    def post(self, route, body):
        status, answer = self.send("POST", route, json.dumps(body), {"Content-Type": "application/json"})
        return status, json.loads(answer) if answer else None

    def done(self, route, **body):
        status, answer = self.post(route, body)
        if status != 200:
            raise AssertionError(f"{route} {body}: {status} {answer}")
        return answer

    def operate(self, *operations, **more):
        return self.done("operations", operations=list(operations), **more)

    def set(self, path, value, **more):
        return self.operate({"op": "set", "path": path, "value": value}, **more)

    @property
    def document(self):
        return self.get("document")[1]

    @property
    def text(self):
        return self.document["text"]

    def frame(self, number, revision=None, take=None):
        """The numbers of each surface; `take`: of that one."""
        revision = self.document["revision"] if revision is None else revision
        of = f"revision={revision}" if take is None else f"take={take}"
        status, body = self.send("GET", f"frame?{of}&frame={number}")
        if status != 200:
            return status, json.loads(body)
        surfaces, at = [], 0
        while at < len(body):
            count, = struct.unpack_from("<I", body, at)
            surfaces.append(body[at + 4:at + 4 + 12 * count])
            at += 4 + 12 * count
        return status, surfaces

    def events(self):
        """Yields (name, data) for ever."""
        link = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        link.request("GET", self.base + "events")
        stream = link.getresponse()
        name = None
        while True:
            line = stream.readline().decode().rstrip("\n")
            if line.startswith("event: "):
                name = line[7:]
            elif line.startswith("data: "):
                yield name, json.loads(line[6:])

    def wait_for(self, name, accepts=lambda data: True):
        limit = time.monotonic() + PATIENCE
        for told, data in self.events():
            if told == name and accepts(data):
                return data
            if time.monotonic() > limit:
                raise AssertionError(f"no event {name}")

    def until(self, holds):
        limit = time.monotonic() + PATIENCE
        while not holds(self.document):
            if time.monotonic() > limit:
                raise AssertionError(f"it stays {self.document}")
            time.sleep(0.02)

    def end(self, how=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(how)
        self.process.stdout.read()
        self.process.stdout.close()
        code = self.process.wait(timeout=PATIENCE)
        with self.errors:
            self.errors.seek(0)
            return code, self.errors.read()


@unittest.skipUnless(HAS_PAGE, "this build has no page")
class Editing(Command):
    def edit(self, *arguments):
        editor = Editor(self.folder, *arguments)
        self.addCleanup(lambda: editor.process.poll() is None and editor.end(signal.SIGKILL))
        return editor

    def begin(self, text=SCENE, end=8):
        self.write("scene.xml", text.format(end=end))
        return self.edit("scene.xml")

    def refused(self, status, answer, *words):
        """Checks a refusal, and that its message has the words."""
        self.assertEqual(answer[0], status, answer)
        message = "\n".join(error["message"] for error in answer[1]["errors"])
        for word in words:
            self.assertIn(word, message)

    def baked(self, frame, file="scene.xml"):
        """The positions of a bake of a file, as float32."""
        self.run_pliant("bake", file, "-o", "out.npy")
        return self.single(self.read("out.npy"), frame)

    @staticmethod
    def single(bytes_, frame):
        """A frame of a file of NumPy, as float32."""
        length, = struct.unpack_from("<H", bytes_, 8)
        shape = [int(word) for word in re.search(rb"\(([^)]*)\)", bytes_[10:10 + length])[1].split(b",") if word.strip()]
        count = 3 * shape[-2]
        doubles = struct.unpack_from(f"<{count}d", bytes_, 10 + length + 8 * count * (frame - 1))
        return struct.pack(f"<{count}f", *doubles)


class CommandLine(Editing):
    def test_ends_with_0_if_all_is_saved(self):
        editor = self.begin()
        self.assertEqual(editor.end(), (0, ""))

    def test_ends_with_1_and_says_so_if_a_change_is_not_saved(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        code, errors = editor.end()
        self.assertEqual(code, 1)
        self.assertIn("scene.xml", errors)
        self.assertIn("not saved", errors)

    def test_a_scene_that_cannot_be_read_is_told_as_validate_does(self):
        for text in (SCENE.format(end=8).replace("12", "x"), "<scene>", SCENE.format(end=8) + "<a/>"):
            self.write("scene.xml", text)
            told = self.run_pliant("validate", "scene.xml", code=2).stderr
            self.assertEqual(self.run_pliant("edit", "scene.xml", "--no-open", code=2).stderr, told)

    def test_bad_arguments_are_refused(self):
        self.assertIn("standard input", self.run_pliant("edit", "-", "--no-open", code=2).stderr)
        self.assertIn("folder", self.run_pliant("edit", "no/such.xml", "--no-open", code=2).stderr)
        self.assertIn("--root", self.run_pliant("edit", "--root", "none", "--no-open", code=2).stderr)
        self.assertIn(".xml", self.run_pliant("edit", "new.txt", "--no-open", code=2).stderr)
        self.scene()
        os.mkdir(self.path("other"))
        self.assertIn("--root", self.run_pliant("edit", "scene.xml", "--root", "other", "--no-open", code=2).stderr)

    def test_a_link_that_leads_to_itself_is_refused(self):
        os.symlink("scene.xml", self.path("scene.xml"))
        os.symlink("b.xml", self.path("a.xml"))
        os.symlink("a.xml", self.path("b.xml"))
        for name in ("scene.xml", "a.xml"):
            self.assertEqual(self.run_pliant("edit", name, "--no-open", code=2).stderr,
                             f"{name}: error: cannot read the file: Too many levels of symbolic links\n")
        editor = self.edit()
        self.refused(422, editor.post("open", {"file": "a.xml"}))

    def test_a_folder_that_is_gone_ends_nothing(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        shutil.rmtree(self.folder)
        editor.until(lambda document: not document["saved"])
        for route in ("document", "objects", "starters", "frame?revision=2&frame=3"):
            self.assertEqual(editor.send("GET", route)[0], 200, route)
        editor.set("poke.magnitude", "1000")
        for route in ("save", "load"):
            self.refused(422, editor.post(route, {}))
        self.refused(422, editor.post("export", {"file": "a.npy"}))
        self.assertEqual(editor.end()[0], 1)

    def test_files_lie_in_the_folder_of_the_scene_unless_root_says_otherwise(self):
        os.mkdir(self.path("scenes"))
        self.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 4/4 3/3\n")
        text = '<scene version="1" start="1" end="3"><surface name="s"><mesh file="../mesh.obj"/></surface></scene>'
        self.write("scenes/scene.xml", text)
        refused = self.run_pliant("edit", "scenes/scene.xml", "--no-open", code=2).stderr
        self.assertIn("--root", refused)
        editor = self.edit("scenes/scene.xml", "--root", ".")
        self.assertEqual(editor.document["file"], "scenes/scene.xml")
        os.symlink(self.path("mesh.obj"), self.path("scenes/link.obj"))
        self.write("scenes/scene.xml", text.replace("../mesh", "link"))
        self.assertIn("--root", self.run_pliant("edit", "scenes/scene.xml", "--no-open", code=2).stderr)


class Requests(Editing):
    def test_each_is_of_its_form(self):
        editor = self.begin()
        json_type = {"Content-Type": "application/json"}

        def status(*request, **more):
            try:
                return editor.send(*request, **more)[0]
            finally:
                editor.link.close()
        self.assertEqual(status("GET", "document", base="/"), 403)
        self.assertEqual(status("GET", "document", base="/" + 32 * "0" + "/"), 403)
        self.assertEqual(status("GET", "document", headers={"Origin": "http://example.org"}), 403)
        self.assertEqual(status("GET", "document", headers={"Sec-Fetch-Site": "cross-site"}), 403)
        self.assertEqual(status("GET", "nothing"), 404)
        self.assertEqual(status("GET", "document?x=1"), 404)
        self.assertEqual(status("GET", "operations"), 405)
        self.assertEqual(status("POST", "document", "{}", json_type), 405)
        self.assertEqual(status("POST", "undo", "{}"), 415)
        self.assertEqual(status("POST", "undo", "{}", {"Content-Type": "text/plain"}), 415)
        self.assertEqual(status("POST", "undo", b"", {**json_type, "Content-Length": "16000001"}), 413)
        self.assertEqual(status("POST", "undo", b" " * 16000001, json_type), 413)
        for body in ("", "[]", "{", '{"operations":[]', '{"operations":[],"operations":[]}', '{"operations":' + 300 * "["):
            self.assertEqual(status("POST", "operations", body, json_type), 400, body)
        for route, body in (("operations", {"operations": [], "else": 1}), ("operations", {"operations": [], "name": 1}),
                            ("operations", {"operations": [], "revision": "1"}), ("undo", {"x": 1}), ("save", {"files": "a"}),
                            ("operations", {"operations": [{"op": "sett"}]}), ("operations", {}), ("save", {"overwrite": 1}),
                            ("operations", {"operations": [], "cancel": True}), ("export", {"stop": 1}), ("export", {"x": ""}),
                            ("export", {}), ("export", {"frames": [1, 2]}), ("add", {}), ("material", {"surface": "sheet"}),
                            ("new", {}), ("motion", {"peak": "1"}), ("keep", {"picture": 1}), ("keep", {"text": ""}), ("take", {}),
                            ("take", {"id": "1"}), ("take", {"id": 1, "ghost": True}), ("take", {"id": 1, "delete": False}),
                            ("take", {"id": 1, "name": "a", "file": "a.xml"}), ("take", {"id": 1, "overwrite": True})):
            answer = editor.post(route, body)
            self.refused(400, answer)
        for route in ("frame?revision=1", "frame?frame=1", "frame?revision=x&frame=1", "frame?revision=1&frame=1&frame=2",
                      "scene", "objects?revision=x", "shape?k=1", "frame?revision=1&take=1&frame=1", "frame?take=1",
                      "objects?take=1", "motion?take=1", "picture?starter=dent&take=1"):
            self.assertEqual(editor.send("GET", route)[0], 400, route)
        self.assertEqual(editor.document["revision"], 1)

    def test_the_type_of_a_body_is_read_as_http_has_it(self):
        editor = self.begin()
        for name in ("application/json", "Application/JSON", "application/json;charset=utf-8",
                     "application/json ; charset=utf-8", "APPLICATION/JSON\t;x=y"):
            status, answer = editor.send("POST", "discard", "{}", {"Content-Type": name})
            self.assertEqual(status, 200, (name, answer))
        for name in ("", "json", "application/jsonp", "application/json/x", "application/json x", "text/json", ";application/json"):
            status, _ = editor.send("POST", "discard", "{}", {"Content-Type": name})
            self.assertEqual(status, 415, name)

    @unittest.skipIf(SANITIZED, "a sanitizer takes all addresses")
    def test_a_request_without_memory_is_refused_and_the_command_goes_on(self):
        # Where it ends: as the text is read, or as what it says is taken.
        for limit in (40_000_000, 210_000_000):
            editor = self.begin()
            editor.frame(8)
            with open(f"/proc/{editor.process.pid}/statm", encoding="ascii") as file:
                used = int(file.read().split()[0]) * resource.getpagesize()
            resource.prlimit(editor.process.pid, resource.RLIMIT_AS, (used + limit, resource.RLIM_INFINITY))
            body = '{"operations":[' + 3_000_000 * "[]," + "[]]}"
            self.assertEqual(editor.send("POST", "operations", body, {"Content-Type": "application/json"}), (503, b""))
            self.assertEqual(editor.document["revision"], 1)
            self.assertEqual(editor.frame(5)[0], 200)
            self.assertEqual(editor.end(), (0, ""))

    def test_a_connection_has_many_requests(self):
        editor = self.begin()
        editor.get("document")
        link = editor.link.sock
        for _ in range(1000):
            self.assertEqual(editor.get("document")[0], 200)
        self.refused(409, editor.post("undo", {}))
        self.assertIs(editor.link.sock, link)

    def test_several_pages_ask_at_once(self):
        editor = self.begin(end=60)
        others = [http.client.HTTPConnection("127.0.0.1", editor.port, timeout=PATIENCE) for _ in range(8)]
        for k, other in enumerate(others):
            other.request("POST", editor.base + "operations",
                          json.dumps({"operations": [{"op": "set", "path": "poke.magnitude", "value": str(k + 1)}]}),
                          {"Content-Type": "application/json"})
        revisions = sorted(json.loads(other.getresponse().read())["revision"] for other in others)
        self.assertEqual(revisions, list(range(2, 10)))
        for _ in range(8):
            editor.done("undo")
        self.assertEqual(editor.text.encode(), self.read("scene.xml"))


class Documents(Editing):
    def test_tells_the_document(self):
        editor = self.begin()
        self.assertEqual(editor.document, {"revision": 1, "file": "scene.xml", "text": SCENE.format(end=8), "saved": True,
                                           "changedOnDisk": False, "undo": "", "redo": "", "start": 1, "end": 8, "fps": 24.0,
                                           "journal": None, "journalFault": ""})

    def test_an_answer_has_the_changes_of_the_text(self):
        editor = self.begin(KEYED)
        before = editor.text.encode()
        answer = editor.operate({"op": "setKey", "channel": "poke.magnitude", "frame": 3, "value": "10"},
                                {"op": "set", "path": "sheet.density", "value": "2"}, name="two")
        self.assertEqual((answer["name"], answer["revision"]), ("two", 2))
        self.assertEqual(answer["parts"], ["poke.magnitude", "sheet.density"])
        for edit in answer["edits"]:
            at, removed = edit["at"], edit["removed"].encode()
            self.assertEqual(before[at:at + len(removed)], removed)
            before = before[:at] + edit["inserted"].encode() + before[at + len(removed):]
        self.assertEqual(editor.text.encode(), before)
        self.assertEqual((editor.document["undo"], editor.document["saved"]), ("two", False))

    def test_what_is_refused_changes_nothing(self):
        editor = self.begin()
        before = editor.document
        text = SCENE.format(end=8).replace('radius="-1"', "")
        self.write("scene2.xml", text.replace('forceRadius="2.5"', 'forceRadius="-1"'))
        told = self.run_pliant("validate", "scene2.xml", code=2).stderr
        answer = editor.post("operations", {"operations": [{"op": "set", "path": "poke.magnitude", "value": "5"},
                                                          {"op": "set", "path": "poke.forceRadius", "value": "-1"}]})
        self.refused(422, answer)
        error = answer[1]["errors"][0]
        self.assertIn(error["message"], told)
        self.assertEqual(error["line"], 4)
        self.assertEqual(editor.document, before)
        self.refused(409, editor.post("operations", {"operations": [], "revision": 2}), "revision")
        self.assertEqual(editor.document, before)

    def test_a_gesture_is_one_step(self):
        editor = self.begin()
        first = editor.text
        editor.set("sheet.density", "3")
        editor.done("undo")
        for value in ("10", "20", "30"):
            answer = editor.set("poke.magnitude", value, gesture="a")
        self.assertEqual(answer["revision"], editor.document["revision"])
        self.assertIn('magnitude="30"', editor.text)
        editor.operate(gesture="a", cancel=True)
        self.assertEqual(editor.text, first)
        self.assertEqual(editor.document["redo"], "set sheet.density", "it is as if it had never been")
        editor.done("redo")
        editor.done("undo")
        # Back to where it began, and on.
        for value in ("10", "3000", "40"):
            editor.set("poke.magnitude", value, gesture="b")
        self.assertEqual(editor.document["undo"], "set poke.magnitude")
        editor.done("undo")
        self.assertEqual(editor.text, first)
        # The gesture of an earlier step is a step of its own.
        editor.set("poke.magnitude", "1", gesture="c")
        editor.set("sheet.density", "2")
        editor.set("poke.magnitude", "2", gesture="c")
        for _ in range(3):
            editor.done("undo")
        self.assertEqual(editor.text, first)
        editor.operate(gesture="c", cancel=True)
        self.assertEqual(editor.text, first)

    def test_what_changes_nothing_ends_no_gesture(self):
        editor = self.begin()
        name = editor.get("starters")[1]["materials"][0]["name"]
        while editor.done("material", surface="sheet", material=name)["edits"]:
            pass
        editor.done("save")
        first = editor.text
        for k, nothing in enumerate((lambda: editor.operate(gesture="h"), lambda: editor.operate(),
                                     lambda: editor.set("poke.forceRadius", "2.5"),
                                     lambda: editor.set("poke.forceRadius", "2.5", gesture="h"),
                                     lambda: editor.operate(gesture="h", cancel=True),
                                     lambda: editor.done("material", surface="sheet", material=name),
                                     lambda: editor.done("save"))):
            editor.set("scene.seed", f"50{k}", gesture="g")
            revision = editor.document["revision"]
            nothing()
            self.assertEqual(editor.document["revision"], revision, k)
            editor.set("scene.seed", f"60{k}", gesture="g")
            editor.operate(gesture="g", cancel=True)
            self.assertEqual(editor.text, first, k)
            editor.done("save")
        self.assertEqual(editor.document["undo"], f"sheet as {name}")

    def test_steps_are_undone_to_the_first_bytes_and_made_again(self):
        editor = self.begin(KEYED.replace("<scene", "<!-- ü -->\r\n<scene"))
        first = editor.text
        self.assertEqual(first.encode(), self.read("scene.xml"))
        dice = random.Random(1)
        names = ["poke"]
        steps = 0
        for k in range(200):
            name = dice.choice(names)
            operation = dice.choice([
                {"op": "set", "path": f"{name}.forceRadius", "value": str(dice.randint(1, 9))},
                {"op": "setKey", "channel": f"{name}.magnitude", "frame": dice.randint(1, 9), "value": str(dice.randint(0, 99))},
                {"op": "setKey", "channel": f"{name}.center", "frame": dice.randint(1, 9), "value": f"{k} 0 0"},
                {"op": "freeze", "channels": [f"{name}.magnitude"], "frame": 2},
                {"op": "duplicate", "object": name, "name": f"n{k}"},
                {"op": "rename", "object": name, "name": f"r{k}"},
                {"op": "reset", "path": f"{name}.direction"},
                {"op": "delete", "objects": [name]} if len(names) > 1 else {"op": "set", "path": "scene.fps", "value": "30"}])
            before = editor.document["revision"]
            status, answer = editor.post("operations", {"operations": [operation]})
            self.assertIn(status, (200, 422), answer)
            if status != 200:
                self.assertEqual(editor.document["revision"], before)
                continue
            steps += answer["revision"] > before
            if operation["op"] == "duplicate":
                names.append(operation["name"])
            if operation["op"] == "rename":
                names[names.index(name)] = operation["name"]
            if operation["op"] == "delete":
                names.remove(name)
        last = editor.text
        self.assertGreater(steps, 100)
        for _ in range(steps):
            editor.done("undo")
        self.assertEqual(editor.text, first)
        self.refused(409, editor.post("undo", {}))
        for _ in range(steps):
            editor.done("redo")
        self.assertEqual(editor.text, last)
        self.refused(409, editor.post("redo", {}))
        editor.done("save")
        self.assertEqual(self.read("scene.xml").decode(), last)
        self.run_pliant("validate", "scene.xml")

    def test_keys_change_in_any_order_and_all_is_undone_and_made_again(self):
        editor = self.begin(KEYED)
        first, texts, dice = editor.text, [editor.text], random.Random(2)

        def keys():
            frames = [float(frame) for frame in re.findall(r'<key frame="([^"]*)"', texts[-1])]
            return {"keys": [{"channel": "poke.magnitude", "frames": dice.sample(frames, dice.randint(1, len(frames)))}]} if frames else {}

        def operation():
            frame, value = dice.randint(1, 24), dice.randint(-9, 9) * 100
            curve = f'<animate attribute="magnitude"><key frame="{frame}" value="{value}" interpolation="linear"/><key frame="{frame + 2}" value="0"/></animate>'
            word = dice.choice(["auto", "flat", "linear", "spline", "3"])
            channels = {"channels": ["poke.magnitude"]}
            return dice.choice([
                {"op": "setKey", "channel": "poke.magnitude", "frame": frame, "value": str(value)},
                {"op": "setKey", "channel": "poke.magnitude", "frame": frame + 0.5},
                {"op": "deleteKeys", **keys()},
                {"op": "moveKeys", **keys(), "frames": dice.randint(-3, 3), "rise": [dice.randint(-50, 50)]},
                {"op": "scaleKeys", **keys(), "frame": frame, "timeFactor": dice.choice([0.5, 1, 2]), "value": [value], "valueFactor": [dice.choice([-1, 0.5, 2])], "step": dice.choice([0, 1])},
                {"op": "setTangent", **keys(), "side": dice.choice(["in", "out", "both"]), "tangent": word},
                {"op": "setHandle", "channel": "poke.magnitude", "frame": frame, "side": "out", "handle": f"1 {value}"},
                {"op": "setInterpolation", **keys(), "interpolation": dice.choice(["linear", "bezier", "step", "bounceOut"])},
                {"op": "setExtrapolation", **channels, "before": "linear", "after": dice.choice(["hold", "repeat 2"])},
                {"op": "simplifyKeys", **channels, "tolerance": dice.choice([0, 10])},
                {"op": "bakeKeys", **channels, "first": frame, "last": frame + 6, "step": 2},
                {"op": "splice", "channel": "poke.magnitude", "first": frame, "last": frame + 2, "curve": curve}])

        for _ in range(250 if SANITIZED else 1000):
            one = operation()
            status, answer = editor.post("operations", {"operations": [one]})
            self.assertIn(status, (200, 400, 422), (one, answer))
            text = editor.text
            if status == 200 and text != texts[-1]:
                texts.append(text)
            self.assertEqual(text, texts[-1], one)
        self.assertGreater(len(texts), 100)
        for text in reversed(texts[:-1]):
            editor.done("undo")
            self.assertEqual(editor.text, text)
        self.assertEqual(editor.text, first)
        for text in texts[1:]:
            editor.done("redo")
            self.assertEqual(editor.text, text)
        editor.done("save")
        self.run_pliant("validate", "scene.xml")

    def test_objects_have_what_the_scene_says(self):
        self.write("part.xml", '<fragment><point name="far" center="1 0 0" magnitude="5"/></fragment>')
        editor = self.begin(KEYED.replace("</scene>", '<include file="part.xml"/></scene>'))
        status, answer = editor.get("objects?revision=1")
        self.assertEqual(status, 200)
        by_name = {each["name"]: each for each in answer["objects"]}
        self.assertEqual(list(by_name)[:3], ["scene", "sheet", "poke"])
        attributes = {each["name"]: each for each in by_name["poke"]["attributes"]}
        self.assertTrue(attributes["magnitude"]["animated"])
        self.assertEqual(attributes["center"]["value"], "0 0 0")
        self.assertEqual(by_name["far"]["file"], "part.xml")
        self.refused(422, editor.post("operations", {"operations": [{"op": "set", "path": "far.magnitude", "value": "1"}]}), "part.xml")
        self.refused(409, editor.get("objects?revision=7"))

    def test_the_format_is_there(self):
        editor = self.begin()
        elements = editor.get("format")[1]["elements"]
        self.assertEqual(elements[0]["name"], "scene")


class Frames(Editing):
    def test_positions_are_those_of_a_bake(self):
        editor = self.begin(KEYED.replace("</surface>", '<transform translate="1 2 3" rotate="0 20 10"/></surface>'), end=30)
        for value in ("2000", "5000"):
            editor.operate({"op": "setKey", "channel": "poke.magnitude", "frame": 5, "value": value})
            editor.done("save")
            for frame in (30, 1, 12, 29):
                self.assertEqual(editor.frame(frame), (200, [self.baked(frame)]), frame)

    def test_a_question_about_another_revision_is_refused(self):
        editor = self.begin(end=40)
        editor.set("poke.magnitude", "2000")
        self.refused(409, editor.frame(3, 1))
        self.refused(409, editor.frame(3, 3))
        self.refused(422, editor.frame(41), "40")
        self.refused(422, editor.frame(0))
        for route in ("scene?revision=1", "details?revision=1&frame=2"):
            self.refused(409, editor.get(route))

    def test_a_run_that_fails_is_told(self):
        editor = self.begin(SCENE.replace("<grid", "<grid").replace("</surface>", '<material density="0" b="1"/></surface>'), end=5)
        editor.set("poke.magnitude", "1e200")
        status, answer = editor.frame(5)
        if status == 200:
            self.skipTest("it does not fail")
        self.assertEqual(status, 422)
        failed = editor.wait_for("failed")
        self.assertEqual(failed["errors"], answer["errors"])
        editor.done("undo")
        self.assertEqual(editor.frame(5)[0], 200)

    def test_little_memory_is_enough_for_what_bake_needs(self):
        self.write("scene.xml", SCENE.format(end=40).replace('columns="13" rows="11"', 'columns="49" rows="49"'))
        self.run_pliant("bake", "scene.xml", "-o", "out.npy", "--max-memory", "0.03")
        editor = self.edit("scene.xml", "--max-memory", "0.05")
        self.assertEqual(editor.frame(40)[0], 200)

    def test_all_frames_become_ready_by_themselves(self):
        editor = self.begin(end=30)
        editor.wait_for("frames", lambda data: data == {"revision": 1, "ready": [[1, 30]]})
        editor.set("poke.magnitude", "2000")
        editor.wait_for("revision", lambda revision: revision == 2)
        editor.wait_for("frames", lambda data: data == {"revision": 2, "ready": [[1, 30]]})

    def test_a_scene_has_shapes_by_keys(self):
        editor = self.begin(SCENE.replace("</scene>", '<collider name="ball"><sphere radius="1"/><transform translate="0 5 0"/></collider></scene>'))
        status, scene = editor.get("scene?revision=1")
        self.assertEqual(status, 200)
        self.assertEqual([each["name"] for each in scene["surfaces"] + scene["colliders"]], ["sheet", "ball"])
        for each in scene["surfaces"] + scene["colliders"]:
            status, body = editor.send("GET", "shape?key=" + each["shape"])
            self.assertEqual(status, 200)
            length, = struct.unpack_from("<I", body)
            self.assertEqual(json.loads(body[4:4 + length])["version"], 1)
        editor.set("poke.magnitude", "2000")
        after = editor.get("scene?revision=2")[1]
        self.assertEqual(after["surfaces"], scene["surfaces"])
        self.assertEqual(after["colliders"], scene["colliders"])
        self.assertEqual(editor.send("GET", "shape?key=none")[0], 404)
        editor.link.close()


class Files(Editing):
    def test_save_writes_the_text_and_nothing_else(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        editor.done("save")
        self.assertEqual(self.read("scene.xml").decode(), SCENE.format(end=8).replace('"3000"', '"2000"'))
        self.assertTrue(editor.document["saved"])
        self.assertEqual(sorted(os.listdir(self.folder)), ["scene.xml", "state"])
        self.assertEqual(editor.end(), (0, ""))

    def test_other_files_are_replaced_only_if_that_is_asked_for(self):
        editor = self.begin()
        self.write("other.xml", "mine")
        self.refused(409, editor.post("save", {"file": "other.xml"}), "other.xml")
        self.assertEqual(self.read("other.xml"), b"mine")
        editor.done("save", file="other.xml", overwrite=True)
        self.assertEqual(self.read("other.xml").decode(), editor.text)
        self.assertEqual(editor.document["file"], "other.xml")
        editor.set("poke.magnitude", "2000")
        editor.done("save")
        self.assertIn(b'"2000"', self.read("other.xml"))
        self.assertIn(b'"3000"', self.read("scene.xml"))

    def test_a_link_is_saved_to_the_file_that_it_leads_to(self):
        os.mkdir(self.path("real"))
        os.mkdir(self.path("shots"))
        self.write("shots/part.xml", '<fragment><point name="far" center="1 0 0" magnitude="5"/></fragment>')
        text = SCENE.format(end=8).replace("</scene>", '<include file="part.xml"/></scene>')
        self.write("real/scene.xml", text)
        os.symlink("../real/scene.xml", self.path("shots/link.xml"))

        def check(editor):
            for k, more in enumerate(({}, {"file": "shots/link.xml"}, {"file": "real/scene.xml"}, {"overwrite": True},
                                      {"file": "real/scene.xml", "overwrite": True})):
                editor.set("poke.magnitude", f"200{k}")
                editor.done("save", **more)
                self.assertEqual(self.read("real/scene.xml").decode(), text.replace('"3000"', f'"200{k}"'))
                self.assertTrue(os.path.islink(self.path("shots/link.xml")))
                self.assertEqual((editor.document["saved"], editor.document["file"]), (True, "real/scene.xml"))
                self.assertEqual(editor.frame(8)[0], 200)
            editor.set("sheet.density", "7")
            self.write("real/scene.xml", text.replace("3000", "1234"))
            editor.until(lambda document: document["changedOnDisk"])
            self.refused(409, editor.post("save", {}), "changed")
            editor.done("load")
            self.assertIn("1234", editor.text)
            self.write("real/scene.xml", text)
            editor.until(lambda document: "3000" in document["text"])
            return editor
        editor = check(self.edit("shots/link.xml", "--root", "."))
        # What it leads to by now is not in the folder.
        away = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, away)
        with open(os.path.join(away, "scene.xml"), "w", encoding="utf-8") as file:
            file.write(text.replace("3000", "77"))
        os.remove(self.path("shots/link.xml"))
        os.symlink(os.path.join(away, "scene.xml"), self.path("shots/link.xml"))
        editor.until(lambda document: not document["saved"])
        self.assertNotIn('"77"', editor.text)
        for route, body in (("save", {}), ("save", {"overwrite": True}), ("load", {})):
            self.refused(422, editor.post(route, body))
        self.assertEqual(editor.end()[0], 1)
        os.remove(self.path("shots/link.xml"))
        os.symlink("../real/scene.xml", self.path("shots/link.xml"))
        editor = self.edit("--root", ".")
        editor.done("open", file="shots/link.xml")
        check(editor)

    def test_another_name_of_the_file_is_another_file(self):
        editor = self.begin()
        os.link(self.path("scene.xml"), self.path("other.xml"))
        editor.set("poke.magnitude", "2000")
        self.refused(409, editor.post("save", {"file": "other.xml"}), "there already")
        editor.done("save", file="other.xml", overwrite=True)
        self.assertIn(b'"2000"', self.read("other.xml"))
        self.assertIn(b'"3000"', self.read("scene.xml"))
        self.assertEqual(editor.document["file"], "other.xml")

    def test_what_the_scene_reads_is_not_overwritten(self):
        fragment = '<fragment><point name="far" center="1 0 0" deformationRadius="4" forceRadius="2"/></fragment>'
        self.write("part.xml", fragment)
        editor = self.begin(SCENE.replace("</scene>", '<include file="part.xml"/></scene>'))
        editor.done("keep")
        os.link(self.path("scene.xml"), self.path("hard.npy"))
        os.symlink("part.xml", self.path("link.xml"))
        for file in ("part.xml", "./part.xml", "link.xml"):
            self.refused(422, editor.post("save", {"file": file, "overwrite": True}), "part.xml", "input")
            self.refused(422, editor.post("take", {"id": 1, "file": file, "overwrite": True}), "part.xml", "input")
        for file in ("part.xml", "scene.xml", "hard.npy"):
            self.refused(422, editor.post("export", {"file": file}), "input")
        self.assertEqual(self.read("part.xml").decode(), fragment)
        os.rename(self.path("scene.xml"), self.path("scene.npy"))
        self.assertEqual(editor.end(signal.SIGKILL)[0], -signal.SIGKILL)
        self.refused(422, self.edit("scene.npy").post("export", {"file": "scene.npy"}), "input")

    def test_nothing_is_read_outside(self):
        os.mkdir(self.path("away"))
        os.mkdir(self.path("in"))
        self.write("away/secret.obj", "v secretword 1 2\n")
        self.write("in/mesh.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n")
        self.write("in/scene.xml", '<scene version="1" start="1" end="4"><surface name="s"><mesh file="mesh.obj"/></surface>'
                   '<point name="p" center="0 0 0" deformationRadius="4" forceRadius="2"/></scene>')
        editor = self.edit("in/scene.xml")
        editor.done("export", file="a.npy")
        self.assertEqual(editor.wait_for("export", lambda data: data["state"] != "running")["state"], "done")
        os.remove(self.path("in/mesh.obj"))
        os.symlink("../away/secret.obj", self.path("in/mesh.obj"))
        for file in ("b.npy", "b.replay"):
            editor.done("export", file=file)
            failed = editor.wait_for("export", lambda data: data["state"] != "running" and data["file"] == file)
            self.assertEqual(failed["state"], "failed")
            self.assertIn("outside", failed["errors"][0]["message"])
        for answer in (editor.post("material", {"surface": "s", "material": "rubber"}), editor.post("add", {"kind": "point"})):
            self.refused(422, answer, "outside")
            self.assertNotIn("secretword", str(answer))
        self.assertEqual(sorted(os.listdir(self.path("in"))), ["a.npy", "mesh.obj", "scene.xml"])

    def test_pipes_and_devices_are_no_files(self):
        os.mkfifo(self.path("pipe.xml"))
        os.mkfifo(self.path("pipe.obj"))
        os.symlink("pipe.xml", self.path("link.xml"))
        editor = self.edit()
        for name in ("pipe.xml", "link.xml"):
            self.refused(422, editor.post("open", {"file": name}), "not a file")
        self.refused(422, editor.post("new", {"starter": "jiggle", "mesh": "pipe.obj"}), "not a file")
        self.assertEqual(editor.end(), (0, ""))
        editor = self.begin()
        self.refused(422, editor.post("add", {"kind": "mesh", "file": "pipe.obj"}), "not a file")
        self.refused(422, editor.post("export", {"file": "pipe.obj"}), "not a file")
        self.refused(422, editor.post("operations", {"operations": [
            {"op": "add", "kind": "surface", "shape": "mesh", "name": "m", "attributes": [{"attribute": "file", "value": "pipe.obj"}]}]}))
        for overwrite in (False, True):
            self.refused(422, editor.post("save", {"file": "pipe.xml", "overwrite": overwrite}), "not a file")
        os.remove(self.path("scene.xml"))
        os.mkfifo(self.path("scene.xml"))
        for route, body in (("save", {}), ("save", {"overwrite": True}), ("load", {})):
            self.refused(422, editor.post(route, body), "not a file")
        os.remove(self.path("scene.xml"))
        editor.done("save")
        self.assertEqual(editor.end(), (0, ""))

    def test_nothing_is_written_outside(self):
        editor = self.begin()
        os.symlink("/tmp", self.path("away"))
        for file in ("../x.xml", "/tmp/pliant-x.xml", "away/x.xml", ".", "", "a/../../x.xml", "nowhere/x.xml"):
            if file:
                self.refused(422, editor.post("save", {"file": file}))
            self.refused(422, editor.post("export", {"file": file.replace(".xml", ".npy")}))
        self.assertFalse(os.path.exists("/tmp/pliant-x.xml"))

    def test_a_file_that_changes_is_loaded_as_a_step(self):
        editor = self.begin()
        self.write("scene.xml", SCENE.format(end=8).replace("3000", "1234"))
        editor.until(lambda document: "1234" in document["text"])
        self.assertEqual((editor.document["saved"], editor.document["changedOnDisk"]), (True, False))
        editor.done("undo")
        self.assertIn("3000", editor.text)
        self.assertFalse(editor.document["saved"])

    def test_with_changes_somebody_must_decide(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        self.write("scene.xml", SCENE.format(end=8).replace("3000", "1234"))
        editor.until(lambda document: document["changedOnDisk"])
        self.assertIn("2000", editor.text)
        self.refused(409, editor.post("save", {}), "changed on the disk")
        self.assertIn(b"1234", self.read("scene.xml"))
        editor.done("load")
        self.assertIn("1234", editor.text)
        self.assertEqual((editor.document["saved"], editor.document["changedOnDisk"]), (True, False))
        editor.done("undo")
        self.assertIn("2000", editor.text)
        self.write("scene.xml", SCENE.format(end=8).replace("3000", "77"))
        editor.until(lambda document: document["changedOnDisk"])
        editor.done("save", overwrite=True)
        self.assertIn(b"2000", self.read("scene.xml"))
        self.assertEqual((editor.document["saved"], editor.document["changedOnDisk"]), (True, False))

    def test_a_file_that_is_gone_is_written_again(self):
        editor = self.begin()
        text = self.read("scene.xml")
        os.remove(self.path("scene.xml"))
        editor.until(lambda document: not document["saved"])
        editor.done("save")
        self.assertEqual(self.read("scene.xml"), text)
        self.assertTrue(editor.document["saved"])
        os.remove(self.path("scene.xml"))
        os.mkfifo(self.path("scene.xml"))
        editor.until(lambda document: not document["saved"])
        self.assertEqual(editor.end()[0], 1)

    def test_a_file_is_read_when_it_is_written_to_its_end(self):
        editor = self.begin()
        text = SCENE.format(end=8).replace("3000", "1234")
        revisions = {editor.document["revision"]}
        with open(self.path("scene.xml"), "w", encoding="utf-8") as file:
            for letter in text[:-40:12]:
                file.write(letter)
                file.flush()
                time.sleep(0.05)
                document = editor.document
                revisions.add(document["revision"])
                self.assertFalse(document["changedOnDisk"])
            file.seek(0)
            file.write(text)
        editor.until(lambda document: "1234" in document["text"])
        self.assertEqual(revisions, {1})

    def test_a_change_just_before_an_edit_is_seen(self):
        editor = self.begin()
        for k in range(5):
            editor.set("sheet.density", str(k + 2))
            self.write("scene.xml", SCENE.format(end=8).replace("3000", f"12{k}"))
            editor.set("sheet.density", str(k + 20))
            editor.until(lambda document: document["changedOnDisk"])
            editor.done("save", overwrite=True)

    def test_an_included_file_that_changes_is_read_again(self):
        part = '<fragment><point name="far" center="1 0 0" deformationRadius="4" forceRadius="2" magnitude="{}"/></fragment>'
        self.write("part.xml", part.format(5))
        editor = self.begin(SCENE.replace("</scene>", '<include file="part.xml"/></scene>'))
        frame = editor.frame(8)
        self.write("part.xml", part.format(900))
        editor.until(lambda document: document["revision"] == 2)
        self.assertNotEqual(editor.frame(8), frame)
        self.write("part.xml", part.format("x"))
        editor.until(lambda document: document["revision"] == 3)
        self.refused(422, editor.frame(8), "magnitude")
        self.assertIn("magnitude", editor.wait_for("failed")["errors"][0]["message"])
        self.write("part.xml", part.format(5))
        editor.until(lambda document: document["revision"] == 4)
        self.assertEqual(editor.frame(8), frame)

    def test_names_of_files_are_names(self):
        editor = self.begin()
        for name in ("a\0b.xml", "a\nb.xml", "x.txt", "-", "sub/x.xml"):
            self.refused(422, editor.post("save", {"file": name}))
        self.assertEqual(sorted(os.listdir(self.folder)), ["scene.xml", "state"])

    def test_a_mesh_that_changes_is_read_again(self):
        def obj(height):
            points = [(x, height, z) for z in range(4) for x in range(4)]
            lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"vt {x / 3} {z / 3}" for x, _, z in points]
            for j in range(3):
                for i in range(3):
                    a, b, c, d = (1 + 4 * n + m for n, m in ((j, i), (j, i + 1), (j + 1, i + 1), (j + 1, i)))
                    lines.append(f"f {a}/{a} {b}/{b} {c}/{c} {d}/{d}")
            return "\n".join(lines) + "\n"
        self.write("mesh.obj", obj(0))
        editor = self.begin('<scene version="1" start="1" end="4"><surface name="s"><mesh file="mesh.obj"/></surface></scene>')
        self.assertEqual(struct.unpack_from("<3f", editor.frame(1)[1][0]), (0, 0, 0))
        self.write("mesh.obj", obj(2))
        editor.until(lambda document: document["revision"] > 1)
        self.assertEqual(struct.unpack_from("<3f", editor.frame(1)[1][0]), (0, 2, 0))


class Journals(Editing):
    def test_a_killed_command_loses_nothing(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        text = editor.text
        time.sleep(1)
        editor.end(signal.SIGKILL)
        folder = os.path.join(self.folder, "state/pliant/edit")
        self.assertEqual(os.stat(folder).st_mode & 0o777, 0o700)
        self.assertEqual(len(os.listdir(folder)), 1)
        self.assertIn(b"3000", self.read("scene.xml"))
        editor = self.edit("scene.xml")
        self.assertEqual(editor.document["journal"].keys(), {"time"})
        self.assertIn("3000", editor.text)
        editor.done("restore")
        self.assertEqual(editor.text, text)
        self.assertIsNone(editor.document["journal"])
        self.assertEqual(editor.document["undo"], "restore")
        editor.done("undo")
        self.assertEqual(editor.text.encode(), self.read("scene.xml"))
        editor.done("redo")
        editor.end(signal.SIGINT)
        # It is there again after an end without saving, and gone once it is discarded.
        editor = self.edit("scene.xml")
        self.assertIsNotNone(editor.document["journal"])
        editor.done("discard")
        self.assertIsNone(editor.document["journal"])
        self.assertEqual(editor.end(), (0, ""))
        self.assertEqual(os.listdir(folder), [])
        self.assertIsNone(self.edit("scene.xml").document["journal"])

    def test_both_sides_are_killed_at_random(self):
        dice = random.Random(5)
        for _ in range(3):
            editor = self.begin()
            # A page that dies in the middle of what it says leaves all of a step, or nothing.
            texts = [editor.text]
            for k in range(20):
                body = json.dumps({"operations": [{"op": "set", "path": "poke.magnitude", "value": str(1000 + k)}]}).encode()
                head = f"POST {editor.base}operations HTTP/1.1\r\nHost: 127.0.0.1:{editor.port}\r\nContent-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n".encode()
                told = (head + body)[:dice.randint(1, len(head + body))]
                with socket.create_connection(("127.0.0.1", editor.port)) as link:
                    link.sendall(told)
                if dice.random() < 0.3:
                    editor.set("poke.forceRadius", str(dice.randint(1, 8) / 4))
                texts.append(editor.text)
                self.assertRegex(texts[-1], r'magnitude="(3000|10[01]\d)"')
            # What the command knew a second before its end is there again.
            made = [(time.monotonic(), editor.text)]
            until = time.monotonic() + 1.2 + dice.random()
            while time.monotonic() < until:
                editor.set("poke.magnitude", str(dice.randint(1, 10**6)))
                made.append((time.monotonic(), editor.text))
            editor.end(signal.SIGKILL)
            end = time.monotonic()
            editor = self.edit("scene.xml")
            editor.done("restore")
            recent = [text for k, (_, text) in enumerate(made) if k + 1 == len(made) or made[k + 1][0] > end - (30 if SANITIZED else 3)]
            self.assertIn(editor.text, recent)
            editor.done("save")
            self.run_pliant("validate", "scene.xml")
            self.assertEqual(editor.end(), (0, ""))

    def journals(self):
        folder = os.path.join(self.folder, "state/pliant/edit")
        return [os.path.join(folder, name) for name in sorted(os.listdir(folder))]

    def test_what_each_command_left_outlives_the_next(self):
        for k in range(3):
            editor = self.begin() if k == 0 else self.edit("scene.xml")
            editor.set("poke.magnitude", f"200{k}")
            if k == 1:
                time.sleep(1)
            editor.end(signal.SIGKILL if k == 1 else signal.SIGINT)
        editor = self.edit("scene.xml")
        for k in (2, 1, 0):
            self.assertIsNotNone(editor.document["journal"])
            editor.done("restore")
            self.assertIn(f'"200{k}"', editor.text)
        self.assertIsNone(editor.document["journal"])
        # What is restored is never without a journal.
        editor.end(signal.SIGKILL)
        editor = self.edit("scene.xml")
        editor.done("restore")
        self.assertIn('"2000"', editor.text)
        self.assertIsNone(editor.document["journal"])

    def test_a_number_that_another_process_has_by_now_hides_nothing(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        editor.end()
        name, = self.journals()
        with open(name, encoding="utf-8") as file:
            left = json.load(file)
        left["process"] = os.getpid()
        with open(name, "w", encoding="utf-8") as file:
            json.dump(left, file)
        editor = self.edit("scene.xml")
        self.assertIsNotNone(editor.document["journal"])
        time.sleep(0.8)
        editor.end(signal.SIGKILL)
        self.assertIsNotNone(self.edit("scene.xml").document["journal"])

    def test_two_commands_with_one_scene_keep_both(self):
        one, other = self.begin(), self.edit("scene.xml")
        one.set("poke.magnitude", "2001")
        self.assertIsNone(other.document["journal"])
        time.sleep(0.8)
        other.set("poke.magnitude", "2002")
        self.assertEqual(other.end()[0], 1)
        self.assertEqual(one.end(signal.SIGKILL)[0], -signal.SIGKILL)
        editor = self.edit("scene.xml")
        for value in ('"2002"', '"2001"'):
            editor.done("restore")
            self.assertIn(value, editor.text)

    def test_a_saved_document_whose_file_is_gone_has_one(self):
        for how in (signal.SIGKILL, signal.SIGINT):
            editor = self.begin()
            text = editor.text
            time.sleep(0.8)
            os.remove(self.path("scene.xml"))
            editor.until(lambda document: not document["saved"])
            if how == signal.SIGKILL:
                time.sleep(0.8)
            code, errors = editor.end(how)
            self.assertEqual((code, "offers them again" in errors), (1, True) if how == signal.SIGINT else (-how, False))
            editor = self.edit("scene.xml")
            editor.done("restore")
            self.assertEqual(editor.text, text)
            editor.done("save")
            self.assertEqual(editor.end(), (0, ""))

    def test_one_that_could_not_be_written_is_tried_again(self):
        editor = self.begin()
        folder = os.path.join(self.folder, "state/pliant/edit")
        os.rename(folder, folder + "-away")
        editor.set("poke.magnitude", "2000")
        editor.until(lambda document: document["journalFault"])
        os.rename(folder + "-away", folder)
        editor.until(lambda document: not document["journalFault"])
        editor.end(signal.SIGKILL)
        self.assertIsNotNone(self.edit("scene.xml").document["journal"])

    def test_a_saved_document_has_none(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        time.sleep(0.8)
        editor.done("save")
        editor.end(signal.SIGKILL)
        self.assertIsNone(self.edit("scene.xml").document["journal"])

    def test_a_journal_that_cannot_be_written_is_told(self):
        self.write("state", "a file")
        editor = self.begin()
        self.assertIn("cannot be made", editor.document["journalFault"])
        editor.set("poke.magnitude", "2000")
        code, errors = editor.end()
        self.assertEqual(code, 1)
        self.assertIn("lost", errors)

    def test_a_damaged_one_is_no_news(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000")
        editor.end()
        folder = os.path.join(self.folder, "state/pliant/edit")
        name = os.path.join(folder, os.listdir(folder)[0])
        with open(name, encoding="utf-8") as file:
            whole = file.read()
        for text in (whole[:-5], "", "[]", whole.replace('"text"', '"test"'), "\0"):
            with open(name, "w", encoding="utf-8") as file:
                file.write(text)
            editor = self.edit("scene.xml")
            self.assertIsNone(editor.document["journal"])
            self.assertEqual(editor.end(), (0, ""))


class FirstScreen(Editing):
    def test_a_scene_begins_with_a_starter(self):
        editor = self.edit("new.xml")
        self.assertEqual((editor.document["text"], editor.document["file"]), (None, "new.xml"))
        self.refused(409, editor.post("operations", {"operations": []}))
        starters = editor.get("starters")[1]
        listed = self.run_pliant("new").stdout
        for each in starters["starters"] + starters["materials"]:
            self.assertIn(each["name"], listed)
            self.assertIn(each["summary"], listed)
        for each in starters["starters"]:
            status, picture = editor.send("GET", "picture?starter=" + each["name"])
            self.assertEqual((status, picture[:8]), (200, b"\x89PNG\r\n\x1a\n"))
        editor.done("new", starter="trampoline")
        self.assertEqual(editor.text, self.run_pliant("new", "trampoline").stdout)
        self.assertFalse(editor.document["saved"])
        self.assertFalse(os.path.exists(self.path("new.xml")))
        editor.done("save")
        self.assertEqual(self.read("new.xml").decode(), editor.text)

    def test_a_starter_in_place_of_a_scene_is_a_step(self):
        editor = self.begin()
        editor.set("poke.magnitude", "2000", gesture="g")
        changed = editor.text
        self.refused(422, editor.post("new", {"starter": "none"}), "none")
        answer = editor.done("new", starter="trampoline")
        text = self.run_pliant("new", "trampoline").stdout
        edit, = answer["edits"]
        at, removed = edit["at"], edit["removed"].encode()
        self.assertEqual(changed.encode()[:at] + edit["inserted"].encode() + changed.encode()[at + len(removed):], text.encode())
        self.assertEqual((editor.text, answer["name"], answer["revision"]), (text, "begin", 3))
        document = editor.document
        self.assertEqual((document["file"], document["undo"], document["saved"]), ("scene.xml", "begin", False))
        self.assertEqual(editor.frame(document["start"])[0], 200)
        self.assertEqual(self.read("scene.xml").decode(), SCENE.format(end=8))
        editor.operate(gesture="g", cancel=True)
        self.assertEqual(editor.text, text)
        editor.done("undo")
        self.assertEqual(editor.text, changed)
        editor.done("redo")
        self.assertEqual(editor.done("new", starter="trampoline")["edits"], [])
        editor.done("save")
        self.assertEqual(self.read("scene.xml").decode(), text)
        editor.done("undo")
        editor.done("undo")
        self.assertEqual(editor.text, SCENE.format(end=8))

    def test_a_starter_in_place_of_a_scene_finds_its_mesh(self):
        for folder in ("real", "shots"):
            os.mkdir(self.path(folder))
        self.write("real/scene.xml", SCENE.format(end=8))
        os.symlink("../real/scene.xml", self.path("shots/link.xml"))
        for name in ("shots/link.xml", "real/scene.xml"):
            editor = self.edit(name, "--root", ".")
            editor.done("new", starter="jiggle")
            self.assertEqual(editor.document["file"], "real/scene.xml")
            mesh = name.replace(".xml", ".obj")
            self.assertIn(f'file="{os.path.basename(mesh)}"', editor.text)
            self.assertEqual(editor.frame(1)[0], 200)
            os.replace(self.path(mesh), self.path("mine.obj"))
            editor.done("new", starter="jiggle", mesh="mine.obj")
            self.assertIn('file="../mine.obj"', editor.text)
            self.assertEqual(editor.frame(1)[0], 200)
            editor.done("save")
            self.assertIn(b"../mine.obj", self.read("real/scene.xml"))
            self.assertEqual(editor.end(), (0, ""))
            os.remove(self.path("mine.obj"))
            self.write("real/scene.xml", SCENE.format(end=8))
        self.write("real/scene.obj", "mine")
        editor = self.edit("real/scene.xml", "--root", ".")
        self.refused(422, editor.post("new", {"starter": "jiggle"}), "scene.obj", "there already")
        self.assertEqual((editor.text, self.read("real/scene.obj")), (SCENE.format(end=8), b"mine"))

    def test_a_document_without_a_name_asks_for_one(self):
        editor = self.edit()
        editor.done("new", starter="sheet")
        self.assertEqual(editor.document["file"], "")
        self.refused(422, editor.post("save", {}), "name")
        editor.done("save", file="mine.xml")
        self.assertEqual(editor.document["file"], "mine.xml")
        self.assertEqual(self.read("mine.xml").decode(), editor.text)

    def test_a_starter_with_a_mesh_brings_it(self):
        editor = self.edit()
        editor.done("new", starter="jiggle")
        meshes = [name for name in os.listdir(self.folder) if name.endswith(".obj")]
        self.assertEqual(len(meshes), 1)
        self.assertEqual(editor.frame(1)[0], 200)
        self.refused(422, self.edit().post("new", {"starter": "none"}), "none")

    def test_scenes_and_meshes_of_the_folder_are_listed_and_opened(self):
        self.scene()
        self.write("no.xml", "<other/>")
        self.write("mesh.obj", "v 0 0 0\n")
        editor = self.edit()
        listed = editor.get("starters")[1]
        self.assertEqual((listed["scenes"], listed["meshes"]), (["scene.xml"], ["mesh.obj"]))
        self.refused(422, editor.post("open", {"file": "no.xml"}))
        self.refused(422, editor.post("open", {"file": "../scene.xml"}))
        editor.done("open", file="scene.xml")
        self.assertEqual(editor.text.encode(), self.read("scene.xml"))
        self.assertTrue(editor.document["saved"])


class Tools(Editing):
    def test_a_new_force_moves_the_surface_by_about_a_tenth_of_its_size(self):
        editor = self.begin('<scene version="1" start="1" end="{end}"><surface name="sheet">'
                            '<grid columns="21" rows="21" width="4" depth="4"/></surface></scene>', end=60)
        for kind in ("point", "pressure", "uniform", "noise"):
            answer = editor.done("add", kind=kind, surface="sheet")
            self.assertIn(answer["object"], editor.text)
            editor.done("save")
            peak = float(re.search(r"peak[^0-9]*([0-9.e-]+)", self.run_pliant("bake", "scene.xml", "-o", "out.npy").stdout)[1])
            self.assertGreater(peak, 0.1)
            self.assertLess(peak, 1.2)
            editor.done("undo")

    def test_everything_that_can_be_added_is_sound(self):
        editor = self.begin()
        formats = {each["name"]: each for each in editor.get("format")[1]["elements"]}
        choices = [each for each in formats["scene"]["children"] for each in each["names"]]
        kinds = [name for name in choices if name not in ("surface", "collider")]
        solids = [name for child in formats["collider"]["children"] for name in child["names"] if len(child["names"]) > 1 and name != "mesh"]
        self.assertIn("point", kinds)
        self.assertIn("sphere", solids)
        for kind in kinds + solids + ["grid"]:
            answer = editor.done("add", kind=kind)
            names = [each["name"] for each in editor.get("objects")[1]["objects"]]
            self.assertIn(answer["object"], names)
        editor.done("save")
        self.run_pliant("validate", "scene.xml")
        self.refused(422, editor.post("add", {"kind": "nothing"}), "nothing")
        self.refused(422, editor.post("add", {"kind": "mesh"}), "file")
        self.refused(422, editor.post("add", {"kind": "point", "surface": "none"}), "none")

    def asked(self, editor, route, **body):
        """A request whose answer is not waited for, and whether it is there."""
        link = http.client.HTTPConnection("127.0.0.1", editor.port, timeout=PATIENCE)
        self.addCleanup(link.close)
        link.request("POST", editor.base + route, json.dumps(body), {"Content-Type": "application/json"})
        return link, lambda: bool(select.select([link.sock], [], [], 0)[0])

    def test_the_document_goes_on_while_something_takes_long(self):
        editor = self.begin(SLOW, end=40)
        material = editor.get("starters")[1]["materials"][0]["name"]
        for route, body in (("add", {"kind": "point"}), ("material", {"surface": "sheet", "material": material}),
                            ("motion", {"surface": "sheet", "peak": 0.5})):
            before, told = editor.document, 0
            link, is_there = self.asked(editor, route, **body)
            while not is_there():
                told += editor.document == before
            self.assertEqual(link.getresponse().status, 200)
            self.assertGreater(told, 3, route)
            editor.done("undo")

    def test_what_is_overtaken_begins_again_unless_it_is_about_what_was_there(self):
        editor = self.begin(SLOW, end=40)
        material = editor.get("starters")[1]["materials"][0]["name"]
        for k, (route, body) in enumerate((("add", {"kind": "point"}), ("material", {"surface": "sheet", "material": material}))):
            revision = editor.document["revision"]
            link, is_there = self.asked(editor, route, **body)
            for _ in range(5):
                editor.get("document")
            self.assertFalse(is_there())
            editor.set("poke.magnitude", f"200{k}")
            answer = link.getresponse()
            self.assertEqual((answer.status, json.loads(answer.read())["revision"]), (200, revision + 2))
            self.assertIn(f'"200{k}"', editor.text)
        link, is_there = self.asked(editor, "motion", surface="sheet", peak=0.5)
        k = 0
        while not is_there():
            k += 1
            editor.set("poke.magnitude", str(3000 + k), gesture="g")
        answer = link.getresponse()
        body = json.loads(answer.read())
        self.refused(409, (answer.status, body), "revision")
        self.assertIn(f'"{3000 + k}"', editor.text)

    def test_a_motion_is_told_and_changed(self):
        editor = self.begin(end=40)
        motion = editor.get("motion?revision=1&surface=sheet")[1]
        self.assertGreater(motion["peak"], 0)
        answer = editor.done("motion", surface="sheet", peak=2 * motion["peak"], gesture="m")
        editor.done("motion", surface="sheet", peak=3 * motion["peak"], gesture="m")
        self.assertAlmostEqual(answer["reached"]["peak"]["value"] / motion["peak"], 2, delta=0.05)
        after = editor.get(f"motion?revision={editor.document['revision']}&surface=sheet")[1]
        self.assertAlmostEqual(after["peak"] / motion["peak"], 3, delta=0.07)
        editor.done("undo")
        self.assertEqual(editor.text.encode(), self.read("scene.xml"))
        self.refused(422, editor.post("motion", {"surface": "none", "peak": 1}), "none")
        answer = editor.done("motion", peak=2 * motion["peak"])
        self.assertAlmostEqual(answer["reached"]["peak"]["value"] / motion["peak"], 2, delta=0.05)

    def test_a_material_is_given_as_one_step(self):
        editor = self.begin(end=30)
        name = editor.get("starters")[1]["materials"][0]["name"]
        editor.done("material", surface="sheet", material=name)
        self.assertIn("<material", editor.text)
        editor.done("undo")
        self.assertEqual(editor.text.encode(), self.read("scene.xml"))
        self.refused(422, editor.post("material", {"surface": "sheet", "material": "none"}), "none")


class Takes(Editing):
    @staticmethod
    def png(width=4, height=3, rows=None):
        """A file as a browser makes it."""
        def chunk(name, content):
            return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
        rows = height * (b"\0" + 4 * width * b"\x80") if rows is None else rows
        return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0))
                + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))

    def names(self, editor):
        status, answer = editor.get("takes")
        self.assertEqual(status, 200)
        return [(each["id"], each["name"]) for each in answer["takes"]]

    def threads(self, editor):
        return len(os.listdir(f"/proc/{editor.process.pid}/task"))

    def test_one_is_opened_as_a_step(self):
        editor = self.begin(KEYED.replace("<scene", "<!-- ü -->\r\n<scene"))
        first = editor.text
        self.assertEqual(self.names(editor), [])
        kept = editor.done("keep")
        self.assertEqual((kept["take"], kept["revision"], kept["edits"]), (1, 1, []))
        editor.set("poke.forceRadius", "1")
        second = editor.text
        self.assertEqual(editor.done("keep", name="zwei <b>")["take"], 2)
        self.assertEqual(self.names(editor), [(1, "Take 1"), (2, "zwei <b>")])
        opened = editor.done("take", id=1)
        self.assertEqual((opened["name"], opened["parts"]), ("open Take 1", ["poke"]))
        self.assertEqual((editor.text, editor.document["saved"]), (first, True))
        # What it is already changes nothing.
        revision = editor.document["revision"]
        self.assertEqual(editor.done("take", id=1)["edits"], [])
        self.assertEqual(editor.document["revision"], revision)
        editor.done("undo")
        self.assertEqual(editor.text, second)
        editor.done("redo")
        self.assertEqual(editor.text, first)
        editor.done("take", id=2)
        self.assertEqual(editor.text, second)
        for _ in range(3):
            editor.done("undo")
        self.assertEqual(editor.text, first)
        self.refused(409, editor.post("undo", {}))

    def test_a_gesture_goes_on_when_one_is_kept(self):
        editor = self.begin()
        editor.set("poke.forceRadius", "1", gesture="g")
        editor.done("keep")
        editor.set("poke.forceRadius", "2", gesture="g")
        editor.done("undo")
        self.refused(409, editor.post("undo", {}))
        editor.done("take", id=1)
        self.assertIn('forceRadius="1"', editor.text)

    def test_names_are_names(self):
        editor = self.begin()
        for name in ("a" * 201, "a\nb", "\x1b[2J"):
            self.refused(422, editor.post("keep", {"name": name}), "name")
        editor.done("keep")
        editor.done("take", id=1, name="Ä " + 98 * "ü")
        for name in ("", "a" * 201, "a\nb"):
            self.refused(422, editor.post("take", {"id": 1, "name": name}), "name")
        self.assertEqual(self.names(editor), [(1, "Ä " + 98 * "ü")])
        for body in ({"id": 2}, {"id": 2, "name": "b"}, {"id": 2, "delete": True}, {"id": 2, "file": "b.xml"}, {"id": -1}):
            self.refused(422, editor.post("take", body), "no take")
        editor.done("take", id=1, delete=True)
        self.refused(422, editor.post("take", {"id": 1}), "no take 1")
        self.assertEqual((editor.done("keep")["take"], self.names(editor)), (2, [(2, "Take 2")]))

    def test_without_a_scene_there_is_nothing_to_keep(self):
        editor = self.edit()
        self.refused(409, editor.post("keep", {}), "no scene")
        self.refused(422, editor.post("take", {"id": 1}))
        self.assertEqual(self.names(editor), [])

    def test_pictures_are_pictures(self):
        editor = self.begin()
        sound = self.png()
        for bytes_ in (sound[:-1], sound + b"x", sound[:40] + b"\0" + sound[41:], b"GIF89a" + 30 * b"x", b"\xff\xd8\xff" + 30 * b"x",
                       self.png(rows=b"\0"), self.png(513, 1), self.png(1, 513), self.png(0, 0), self.png(2**31, 1, b""), b"<svg/>"):
            self.refused(422, editor.post("keep", {"picture": base64.b64encode(bytes_).decode()}), "picture")
        noise = random.Random(1).randbytes(512 * 2048)
        large = self.png(512, 512, b"".join(b"\0" + noise[k:k + 2048] for k in range(0, len(noise), 2048)))
        self.refused(422, editor.post("keep", {"picture": base64.b64encode(large).decode()}), "262144")
        for text in ("%", "a", "iVBORw0KGgo", base64.b64encode(sound).decode() + "\n"):
            self.refused(422, editor.post("keep", {"picture": text}), "picture")
        self.assertEqual(self.names(editor), [])
        editor.done("keep", picture=base64.b64encode(sound).decode())
        editor.done("keep")
        self.assertEqual([each["hasPicture"] for each in editor.get("takes")[1]["takes"]], [True, False])
        editor.link.request("GET", editor.base + "picture?take=1")
        answer = editor.link.getresponse()
        self.assertEqual((answer.status, answer.getheader("Content-Type"), answer.read()), (200, "image/png", sound))
        for take in (2, 3):
            self.assertEqual(editor.send("GET", f"picture?take={take}")[0], 404)
            editor.link.close()

    def test_there_is_an_end_to_them(self):
        editor = self.begin()
        for k in range(1, 65):
            self.assertEqual(editor.done("keep")["take"], k)
        self.refused(422, editor.post("keep", {}), "64 takes")
        editor.done("take", id=7, delete=True)
        self.assertEqual(editor.done("keep")["take"], 65)
        self.write("large.xml", SCENE.format(end=8).replace("</scene>", f"<!--{2_000_000 * 'x'}--></scene>"))
        editor = self.edit("large.xml", "--max-memory", "0.1")
        editor.done("keep")
        self.refused(422, editor.post("keep", {}), "bytes", "delete")
        editor.done("take", id=1, delete=True)
        editor.done("keep")

    def test_all_pages_are_told(self):
        editor = self.begin()
        editor.wait_for("takes", lambda data: data == {"takes": [], "readAgain": 0})
        editor.done("keep", name="a")
        editor.done("take", id=1, name="b")
        editor.wait_for("takes", lambda data: data["takes"] == [{"id": 1, "name": "b", "hasPicture": False}])
        editor.done("take", id=1, delete=True)
        editor.wait_for("takes", lambda data: data["takes"] == [])

    def test_one_is_saved_as_a_scene(self):
        text = SCENE.replace("<scene", "<!-- ü -->\r\n<scene")
        editor = self.begin(text)
        first = editor.text
        editor.done("keep")
        editor.set("poke.forceRadius", "1")
        os.mkdir(self.path("deep"))
        for name in ("a.xml", "deep/b.xml"):
            answer = editor.done("take", id=1, file=name)
            self.assertEqual((answer["name"], answer["edits"]), ("save take", []))
            self.assertEqual(self.read(name), first.encode())
        self.write("a.xml", "other")
        self.refused(409, editor.post("take", {"id": 1, "file": "a.xml"}), "a.xml", "already")
        self.assertEqual(self.read("a.xml"), b"other")
        editor.done("take", id=1, file="a.xml", overwrite=True)
        self.assertEqual(self.read("a.xml"), first.encode())
        os.symlink(self.path("a.xml"), self.path("link.xml"))
        os.symlink("/tmp", self.path("out"))
        os.mkfifo(self.path("pipe.xml"))
        for name in ("a.txt", "../a.xml", "/tmp/a.xml", "out/a.xml", "deep", "none/a.xml", "pipe.xml", "a\n.xml", ""):
            self.refused(422, editor.post("take", {"id": 1, "file": name, "overwrite": True}))
        editor.set("poke.forceRadius", "2")
        editor.done("keep")
        editor.done("take", id=2, file="link.xml", overwrite=True)
        self.assertTrue(os.path.islink(self.path("link.xml")))
        self.assertIn(b'forceRadius="2"', self.read("a.xml"))
        # The document has its name and its changes.
        self.assertEqual((editor.document["file"], editor.document["saved"]), ("scene.xml", False))
        self.assertEqual(self.read("scene.xml"), first.encode())
        self.refused(409, editor.post("take", {"id": 2, "file": "scene.xml"}), "already")
        self.assertEqual([name for name in os.listdir(self.folder) if "part" in name or "tmp" in name], [])

    def test_files_that_one_names_bind_it_to_its_folder(self):
        self.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 4/4 3/3\n")
        os.mkdir(self.path("deep"))
        editor = self.begin('<scene version="1" start="1" end="3"><surface name="s"><mesh file="mesh.obj"/></surface></scene>')
        editor.done("keep")
        self.refused(422, editor.post("take", {"id": 1, "file": "deep/a.xml"}))
        editor.done("take", id=1, file="a.xml")
        # Without its mesh it is a message, and with it again it plays; so it does when the mesh is another one.
        status, before = editor.frame(2, take=1)
        self.assertEqual(status, 200)
        self.write("mesh.obj", self.read("mesh.obj").decode().replace("v 1 0 1", "v 1 0 2"))
        editor.wait_for("takes", lambda data: data["readAgain"] == 1)
        self.assertNotEqual(editor.frame(2, take=1), (200, before))
        os.rename(self.path("mesh.obj"), self.path("gone.obj"))
        editor.wait_for("takes", lambda data: data["readAgain"] == 2)
        for route in ("frame?take=1&frame=2", "scene?take=1"):
            self.refused(422, editor.get(route), "mesh.obj")
        os.rename(self.path("gone.obj"), self.path("mesh.obj"))
        editor.wait_for("takes", lambda data: data["readAgain"] == 3)
        self.assertEqual(editor.frame(2, take=1)[0], 200)

    def test_a_ghost_is_what_a_bake_of_it_is(self):
        editor = self.begin(KEYED.replace("</surface>", '<transform translate="1 2 3" rotate="0 20 10"/></surface>'), end=30)
        editor.done("keep")
        # Others have other surfaces and frames.
        editor.operate({"op": "set", "path": "scene.end", "value": "12"}, {"op": "set", "path": "sheet.columns", "value": "9"},
                       {"op": "duplicate", "object": "sheet", "name": "other"})
        editor.done("keep")
        editor.set("poke.forceRadius", "1")
        for take, frames in ((1, (30, 1, 17)), (2, (12, 1, 7))):
            editor.done("take", id=take, file=f"take{take}.xml")
            for frame in frames:
                status, surfaces = editor.frame(frame, take=take)
                self.assertEqual((status, len(surfaces)), (200, take))
                if take == 1:
                    self.assertEqual(surfaces, [self.baked(frame, "take1.xml")])
                else:
                    self.run_pliant("bake", "take2.xml", "-o", "sheet.npy", "--surface", "sheet")
                    self.run_pliant("bake", "take2.xml", "-o", "other.npy", "--surface", "other")
                    self.assertEqual(surfaces, [self.single(self.read(f"{name}.npy"), frame) for name in ("sheet", "other")])
        self.refused(422, editor.frame(13, take=2), "12")
        self.refused(422, editor.frame(0, take=1))
        self.refused(422, editor.frame(1, take=3), "no take 3")
        # Shapes and the rest are there.
        for take in (1, 2):
            status, scene = editor.get(f"scene?take={take}")
            self.assertEqual((status, len(scene["surfaces"])), (200, take))
            for surface in scene["surfaces"]:
                self.assertEqual(editor.send("GET", "shape?key=" + surface["shape"])[0], 200)
            self.assertEqual(editor.send("GET", f"details?take={take}&frame=3")[0], 200)
        editor.done("take", id=2, delete=True)
        self.refused(422, editor.get("scene?take=2"), "no take 2")

    def test_a_ghost_is_freed(self):
        editor = self.begin(end=20)
        for _ in range(4):
            editor.done("keep")
        self.assertEqual(editor.frame(20)[0], 200)
        before = self.threads(editor)
        for take in range(1, 5):
            self.assertEqual(editor.frame(20, take=take)[0], 200)
            self.assertEqual(self.threads(editor), before + min(take, 2))
        self.assertEqual(editor.frame(20, take=1)[0], 200)  # again
        editor.done("take", id=1, ghost=False)
        editor.done("take", id=2, ghost=False)
        self.assertEqual(self.threads(editor), before + 1)
        editor.done("take", id=4, delete=True)
        self.assertEqual(self.threads(editor), before)
        self.assertEqual(editor.frame(20, take=1)[0], 200)
        self.assertEqual(editor.end()[0], 0)

    def test_what_waits_for_a_ghost_that_ends_is_answered(self):
        editor = self.begin(SLOW, end=100_000)
        editor.done("keep")
        link = http.client.HTTPConnection("127.0.0.1", editor.port, timeout=PATIENCE)
        link.request("GET", editor.base + "frame?take=1&frame=100000")
        time.sleep(0.3)
        editor.done("take", id=1, ghost=False)
        self.assertEqual(link.getresponse().status, 409)
        link.close()
        # The end of the command waits for none.
        link.request("GET", editor.base + "frame?take=1&frame=100000")
        time.sleep(0.3)
        self.assertEqual(editor.end()[0], 0)

    def test_the_document_goes_first(self):
        editor = self.begin(SLOW, end=3000)
        editor.done("keep")
        link = http.client.HTTPConnection("127.0.0.1", editor.port, timeout=PATIENCE)
        link.request("GET", editor.base + "frame?take=1&frame=3000")
        for k in range(20):
            revision = editor.set("poke.magnitude", str(2000 + k))["revision"]
            self.assertEqual(editor.frame(2, revision)[0], 200)
        self.assertEqual(select.select([link.sock], [], [], 0)[0], [])  # it is still solved
        editor.end(signal.SIGKILL)
        link.close()

    def test_a_ghost_that_does_not_fit_is_a_message(self):
        self.write("scene.xml", SCENE.format(end=40).replace('columns="13" rows="11"', 'columns="121" rows="121"'))
        editor = self.edit("scene.xml", "--max-memory", "0.1")
        editor.done("keep")
        editor.set("poke.magnitude", "2000")
        self.assertEqual(editor.frame(40)[0], 200)
        status, answer = editor.get("scene?take=1")
        if status == 200:
            status, answer = editor.frame(40, take=1)
        self.assertEqual(status, 422)
        self.refused(422, (status, answer), "allowed")
        self.assertEqual(editor.frame(39)[0], 200)

    def test_takes_edits_and_undo_in_any_order(self):
        editor = self.begin(end=12)
        dice = random.Random(3)
        texts, history, place = {}, [editor.text], 0
        for k in range(150):
            act = dice.choice(["keep", "set", "set", "undo", "redo", "open", "open", "delete", "rename", "ghost", "save"])
            take = dice.choice(list(texts)) if texts else None
            if act == "keep" and len(texts) < 6:
                texts[editor.done("keep", name=f"t{k}")["take"]] = history[place]
            elif act == "set":
                editor.set("poke.forceRadius", str(dice.randint(1, 9) / 4))
                if editor.text != history[place]:
                    history[place + 1:] = [editor.text]
                    place += 1
            elif act == "undo" and place > 0:
                editor.done("undo")
                place -= 1
            elif act == "redo" and place + 1 < len(history):
                editor.done("redo")
                place += 1
            elif take is not None and act == "open":
                editor.done("take", id=take)
                if texts[take] != history[place]:
                    history[place + 1:] = [texts[take]]
                    place += 1
            elif take is not None and act == "delete" and len(texts) > 4:
                editor.done("take", id=take, delete=True)
                del texts[take]
            elif take is not None and act == "rename":
                editor.done("take", id=take, name=f"n{k}")
            elif take is not None and act == "ghost":
                frame = dice.randint(1, 12)
                status, surfaces = editor.frame(frame, take=take)
                self.assertEqual(status, 200)
                if texts[take] == history[place]:
                    self.assertEqual(editor.frame(frame), (200, surfaces))
            elif take is not None and act == "save":
                editor.done("take", id=take, file="a.xml", overwrite=True)
                self.assertEqual(self.read("a.xml"), texts[take].encode())
            self.assertEqual(editor.text, history[place], (k, act))
            self.assertEqual([each for each, _ in self.names(editor)], list(texts))
        self.assertGreater(len(history), 10)
        for text in reversed(history[:place]):
            editor.done("undo")
            self.assertEqual(editor.text, text)
        self.refused(409, editor.post("undo", {}))


class Exports(Editing):
    def finished(self, editor, name):
        return editor.wait_for("export", lambda data: data["state"] != "running" and data["file"] == name)

    def test_files_are_those_of_bake(self):
        editor = self.begin(end=12)
        editor.set("poke.magnitude", "2000")
        self.write("changed.xml", editor.text)
        for name, options in (("a.glb", {}), ("a.npy", {"frames": [2, 7], "surface": "sheet", "space": "object"}), ("a.usda", {})):
            editor.done("export", file=name, **options)
            finished = self.finished(editor, name)
            self.assertEqual(finished["state"], "done", finished)
            words = ["--frames", "2:7", "--surface", "sheet", "--space", "object"] if options else []
            self.run_pliant("bake", "changed.xml", "-o", "b" + name, *words)
            self.assertEqual(self.read(name), self.read("b" + name), name)
        self.assertIn(b"3000", self.read("scene.xml"))
        self.refused(422, editor.post("export", {"file": "run.replay"}), "save")
        self.refused(422, editor.post("export", {"file": "run.replay", "frames": [1, 2]}))
        editor.done("save")
        self.refused(422, editor.post("export", {"file": "run.replay", "frames": [1, 11]}), "1 to 12")
        for name, options in (("run.replay", {}), ("all.replay", {"frames": [1, 12]})):
            editor.done("export", file=name, **options)
            self.assertEqual(self.finished(editor, name)["state"], "done")
        self.assertEqual(self.read("all.replay"), self.read("run.replay"))

    def test_what_a_scene_has_not_is_refused_at_once(self):
        editor = self.begin(end=12)
        for more in ({"frames": [5, 1]}, {"frames": [0, 3]}, {"frames": [3, 13]}, {"space": "x"}, {"surface": "none"}):
            self.refused(422, editor.post("export", {"file": "a.npy", **more}))
        self.refused(400, editor.post("export", {"stop": False}))

    def test_an_end_during_an_export_is_an_end(self):
        for delay in (0.02, 0.1, 0.2, 0.3):
            editor = self.begin(SCENE.replace('columns="13" rows="11"', 'columns="101" rows="101"'), end=2000)
            files = sorted(os.listdir(self.folder))
            editor.done("export", file="a.usda")
            time.sleep(delay)
            self.assertEqual(editor.end(), (0, ""))
            self.assertEqual(sorted(os.listdir(self.folder)), files)

    def test_what_bake_refuses_is_told(self):
        editor = self.begin(end=12)
        editor.done("export", file="a.xyz")
        failed = self.finished(editor, "a.xyz")
        self.assertEqual(failed["state"], "failed")
        self.assertIn("xyz", failed["errors"][0]["message"])

    def test_each_error_of_an_export_has_its_place(self):
        part = '<fragment><point name="far" center="1 0 0" deformationRadius="4" forceRadius="2" magnitude="{}" falloff="{}"/></fragment>'
        self.write("part.xml", part.format(5, "smooth"))
        editor = self.begin(SCENE.replace("</scene>", '<include file="part.xml"/></scene>'))
        self.write("part.xml", "\n" + part.format("x", "steep"))
        editor.until(lambda document: document["revision"] == 2)
        told = editor.frame(8)[1]["errors"]
        editor.done("export", file="a.npy")
        errors = self.finished(editor, "a.npy")["errors"]
        self.assertEqual([(each["message"], os.path.basename(each["file"]), each["line"]) for each in errors],
                         [(each["message"], os.path.basename(each["file"]), each["line"]) for each in told])
        self.assertEqual([each["line"] for each in errors], [2, 2])

    def test_a_stopped_export_leaves_nothing(self):
        editor = self.begin(SCENE.replace('columns="13" rows="11"', 'columns="201" rows="201"'), end=3000)
        files = sorted(os.listdir(self.folder))
        editor.done("export", file="a.npy")
        self.refused(422, editor.post("export", {"file": "b.npy"}), "running")
        editor.wait_for("export", lambda data: data["done"] > 0)
        editor.done("export", stop=True)
        self.assertEqual(self.finished(editor, "a.npy")["state"], "stopped")
        self.assertEqual(sorted(os.listdir(self.folder)), files)


if __name__ == "__main__":
    main()
