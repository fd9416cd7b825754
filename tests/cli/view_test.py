"""The data that `pliant view` puts into its page, decoded as docs/viewer.md describes, and its
server.

A build without npm has no page; then this tests the command's message. tests/viewer tests the page
in a browser, serve_test.py which requests the server answers.
"""

import base64
import hashlib
import json
import os
import re
import shutil
import zlib

import numpy as np

from command import Command, SOURCE, main
from view_server import HAS_PAGE, Server

SCENE = """<scene version="1" fps="25" start="{start}" end="{end}">
  <surface name="sheet"><grid columns="13" rows="11" width="12" depth="10"/>{transform}
    <material density="2" damping="3"/></surface>
  <surface name="other"><grid columns="5" rows="4"/></surface>
  <point name="poke" center="0 0 0" direction="0.2 1 0" deformationRadius="4.5" forceRadius="2.5" targets="sheet">
    <animate attribute="magnitude"><key frame="1" value="0"/><key frame="5" value="{magnitude}"/></animate></point>
</scene>
"""


def read_page(path):
    """Title, head and arrays of a page."""
    with open(path, encoding="utf-8") as file:
        page = file.read()
    packed = re.search(r'<script id="bake" type="text/plain">([^<]*)</script>', page).group(1)
    return re.search("<title>(.*?)</title>", page).group(1), *unpack(base64.b64decode(packed, validate=True))


def unpack(packed):
    unpacked = zlib.decompress(packed, wbits=-15)
    length = int.from_bytes(unpacked[:4], "little")
    return json.loads(unpacked[4:4 + length]), unpacked[4 + length:]


def positions(head, arrays, surface, is_rest=False):
    """Frames x vertices x 3, world space, decoded by the page's rules, one number at a time; of the
    shape at rest if it is animated."""
    motion = surface["restMotion"] if is_rest else surface

    def array(name, kind):
        place = motion[name] if name in motion else surface[name]
        return np.frombuffer(arrays, kind, place["count"], place["begin"])

    count = surface["vertices"]
    order = np.argsort(array("nodes", "<u4"), kind="stable")
    missed = array("lowBytes", "u1").astype(int) + 256 * array("highBytes", "u1").astype(int)
    missed = np.where(missed % 2, -(missed + 1) // 2, missed // 2)
    missed = missed.reshape(-1, 3, count)
    steps = np.zeros((len(missed) + 2, 3, count), int)  # two frames of rest before the first
    for frame, predictor in enumerate(array("predictors", "u1")):
        now = missed[frame]
        if predictor & 4:
            now = np.cumsum(now, axis=1)
        before, earlier = steps[frame + 1], steps[frame]
        now = now + [0, before, 2 * before - earlier][predictor & 3]
        steps[frame + 2] = (now + 2**15) % 2**16 - 2**15
    offsets = np.empty((len(missed), count, 3))
    offsets[:, order] = motion["step"] * steps[2:].transpose(0, 2, 1)
    rest = array("rest", "<f4").reshape(-1, 3).astype(float) + surface["origin"]
    frames = head["last"] - head["first"] + 1
    transforms = np.array(surface["transforms"] * (frames if len(surface["transforms"]) == 1 else 1))
    transforms = transforms.reshape(frames, 3, 4)
    return np.einsum("frc,fvc->fvr", transforms[:, :, :3], offsets + rest) + transforms[:, None, :, 3]


class View(Command):
    def scene(self, name="scene.xml", *, start=1, end=12, magnitude=3000, transform=""):
        return self.write(name, SCENE.format(start=start, end=end, magnitude=magnitude, transform=transform))


class WithoutPage(View):
    def test_a_build_without_the_page_says_how_to_get_it(self):
        if HAS_PAGE:
            self.skipTest("this build has the page")
        result = self.run_pliant("view", self.scene(), code=1)
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertIn("no viewer", result.stderr)
        self.assertIn("script/bootstrap", result.stderr)
        self.assertEqual(os.listdir(self.folder), ["scene.xml"])


class Page(View):
    def setUp(self):
        if not HAS_PAGE:
            self.skipTest("this build has no page")
        super().setUp()

    def compare(self, scene, *options):
        """Compares the page's positions with those of a bake, within the page's error bound."""
        self.run_pliant("view", scene, "-o", "view.html", "--quiet", *options)
        self.run_pliant("bake", scene, "-o", "bake.npy", "--quiet", *options)
        _, head, arrays = read_page(self.path("view.html"))
        for surface in head["surfaces"]:
            several = self.path(f"bake-{surface['name']}.npy")
            expected = np.load(several if os.path.exists(several) else self.path("bake.npy"))
            linear = np.array(surface["transforms"]).reshape(-1, 3, 4)[:, :, :3]
            stretch = max(np.linalg.norm(each, 2) for each in linear)
            error = np.abs(positions(head, arrays, surface) - expected).max()
            self.assertLessEqual(error, 1.75 * surface["error"] * stretch + 1e-12)  # along a diagonal
            size = np.ptp(expected.reshape(-1, 3), axis=0).max()
            self.assertLess(surface["error"], size / 65535)
            moved = np.linalg.norm(positions(head, arrays, surface)[0] - expected[0], axis=1).max()
            self.assertLessEqual(moved, 2 * surface["error"] * stretch + 1e-12)
        return head, arrays

    def test_positions_are_those_of_a_bake(self):
        head, _ = self.compare(self.scene())
        self.assertEqual((head["first"], head["last"], head["fps"], head["sceneFrames"]), (1, 12, 25, [1, 12]))
        self.assertGreater(head["surfaces"][0]["peakDisplacement"], 0.1)
        self.assertEqual(head["surfaces"][1]["peakDisplacement"], 0)
        baked = np.load(self.path("bake-sheet.npy"))
        displaced = np.linalg.norm(baked - baked[0], axis=2).max(axis=1)
        np.testing.assert_allclose(head["displaced"], displaced, atol=1e-12)
        self.assertEqual(max(head["displaced"]), head["surfaces"][0]["peakDisplacement"])

    def test_a_moving_transform_is_kept_apart_from_the_displacement(self):
        transform = ('<transform rotate="20 30 -50" scale="1 3 -0.5"><animate attribute="translate">'
                     '<key frame="1" value="0 0 0"/><key frame="12" value="500 10 2"/></animate></transform>')
        head, _ = self.compare(self.scene(transform=transform))
        self.assertEqual(len(head["surfaces"][0]["transforms"]), 12)
        self.assertEqual(len(head["surfaces"][1]["transforms"]), 1)

    def test_an_animated_shape_has_the_motion_of_its_rest(self):
        k, vertex = np.meshgrid(np.arange(12), np.arange(99), indexing="ij")
        i, j = vertex % 11, vertex // 11
        rest = np.stack([(i - 5) / 10, 0 * i, (j - 4) / 8], axis=-1)
        shapes = rest + np.stack([0.05 * k, 0.02 * k * np.sin(i + k), 0 * k], axis=-1)
        np.save(self.path("walk.npy"), shapes)
        scene = self.write("scene.xml", """<scene version="1" start="1" end="12"><surface name="hide">
            <grid columns="11" rows="9" cache="walk.npy"/><transform translate="1 2 3" rotate="10 20 30"/>
            <material density="2" damping="3"/><solver region="all"/></surface>
            <inertia name="sway" forceRadius="9"/></scene>""")
        head, arrays = self.compare(scene)
        surface = head["surfaces"][0]
        still = self.write("still.xml", self.read("scene.xml").decode().replace('region="all"', 'startFrame="99"'))
        self.run_pliant("bake", still, "-o", "still.npy", "--quiet")
        error = np.abs(positions(head, arrays, surface, is_rest=True) - np.load(self.path("still.npy"))).max()
        self.assertLess(error, 1.75 * (surface["restMotion"]["step"] + surface["error"]))
        baked = np.load(self.path("bake.npy")) - np.load(self.path("still.npy"))
        self.assertAlmostEqual(surface["peakDisplacement"], np.linalg.norm(baked, axis=-1).max(), places=6)

    def test_some_of_the_frames(self):
        head, _ = self.compare(self.scene(start=-3), "--frames", "-1:7")
        self.assertEqual((head["first"], head["last"], head["sceneFrames"]), (-1, 7, [-3, 12]))
        self.assertEqual(len(head["displaced"]), 9)

    def test_a_mesh_in_any_order_and_every_kind_of_force(self):
        for example in ("travelling", "flag", "thesis/fig10-coarse"):
            with self.subTest(example):
                self.compare(os.path.join(SOURCE, "examples", f"{example}.xml"))

    def test_the_head_has_the_values_of_the_channels(self):
        self.run_pliant("view", self.scene(), "--quiet")
        _, head, _ = read_page(self.path("view.html"))
        rows = self.run_pliant("curves", self.scene()).stdout.split("\n")[1:-1]
        force = head["forces"][0]
        self.assertEqual(force["magnitude"], [float(row.split(",")[2]) for row in rows])
        self.assertEqual((force["center"], force["deformationRadius"]), ([[0, 0, 0]], [4.5]))
        channel = head["channels"][0]
        self.assertEqual((channel["path"], [key["at"] for key in channel["keys"]]),
                         ("poke.magnitude", [[1, 0], [5, 3000]]))
        for row in rows:
            frame, value = (float(word) for word in row.split(",")[1:])
            self.assertIn([frame, value], channel["points"])

    def test_forces_have_a_deformation_radius_where_they_select(self):
        scene = self.write("s.xml", """<scene version="1" start="1" end="3">
  <surface name="a"><grid columns="5" rows="5"/><solver region="all"/></surface>
  <surface name="b"><grid columns="5" rows="5"/></surface>
  <point name="p" targets="a"/><point name="q" targets="b"/><point name="r"/>
  <group name="g" targets="a"><point name="s"/></group></scene>""")
        self.run_pliant("view", scene, "-o", "a.html", "--quiet")
        _, head, _ = read_page(self.path("a.html"))
        self.assertEqual([force["name"] for force in head["forces"] if "deformationRadius" in force], ["q", "r"])

    def test_regions_are_those_that_bake_tells_of(self):
        scene = os.path.join(SOURCE, "examples/hands.xml")
        self.run_pliant("view", scene, "--quiet")
        self.run_pliant("bake", scene, "-o", "a.npy", "--regions", "regions.json", "--quiet")
        _, head, _ = read_page(self.path("view.html"))
        with open(self.path("regions.json"), encoding="utf-8") as file:
            frames = json.load(file)["frames"]
        marks = head["surfaces"][0]["marks"]
        self.assertLess(len(marks), len(frames))  # stored only where they change
        for frame in frames:
            told = frame["surfaces"][0]
            now = [each for each in marks if each["frame"] <= frame["frame"]][-1]
            parts = [[[*part["columns"], *part["rows"]] for part in region["parts"]] for region in told["regions"]]
            self.assertEqual([region["parts"] for region in now["regions"]], parts)
            boxes = {force["name"]: [*force["forceBox"]["columns"], *force["forceBox"]["rows"]]
                     for force in told["forces"] if force["forceBox"]}
            self.assertEqual({head["forces"][each["force"]]["name"]: each["box"] for each in now["forces"]}, boxes)

    def test_a_hundred_frames_of_ten_thousand_vertices_stay_below_5_mb(self):
        text = SCENE.format(start=1, end=100, magnitude=9000, transform="").replace(
            'columns="13" rows="11"', 'columns="100" rows="100"').replace("4.5", "30")
        noise = '<noise name="n" frequency="0.5" rate="4" deformationRadius="30" forceRadius="30" magnitude="4000"/>'
        with open(self.path("large.xml"), "w", encoding="utf-8") as file:
            file.write(text.replace("</scene>", noise + "</scene>"))
        self.run_pliant("view", "large.xml", "--quiet")
        self.assertLess(os.path.getsize(self.path("view.html")), 5e6)

    def test_no_name_ends_the_script_that_holds_it(self):
        name = "a<b>&amp;</title><script>alert(1)</script>.xml".replace("/", "")
        self.run_pliant("view", self.scene(name), "--quiet")
        title, head, _ = read_page(self.path("view.html"))
        self.assertNotIn("<", title)
        self.assertTrue(head["scene"].endswith(name))

    def test_the_page_asks_for_nothing_else(self):
        self.run_pliant("view", self.scene(), "--quiet")
        with open(self.path("view.html"), encoding="utf-8") as file:
            page = file.read()
        self.assertEqual(re.findall(r'<(?:script|img|iframe)[^>]*\bsrc=', page), [])
        self.assertEqual(re.findall(r'<link[^>]*href="(?!data:)', page), [])
        self.assertEqual(page.count("</script>"), 2)  # the bake, and the program

    def test_the_policy_lets_the_page_run_and_ask_nobody(self):
        self.run_pliant("view", self.scene(), "--quiet")
        with open(self.path("view.html"), encoding="utf-8") as file:
            page = file.read()
        policy = re.search('<meta http-equiv="Content-Security-Policy" content="([^"]*)">', page)
        self.assertLess(policy.end(), page.index("<style>"))
        rules = dict(rule.split(" ", 1) for rule in policy.group(1).split("; "))
        for name in ("default-src", "connect-src", "base-uri", "form-action"):
            self.assertEqual(rules[name], "'none'")
        for name, element in (("script-src", r'<script type="module">(.*?)</script>'), ("style-src", "<style>(.*?)</style>")):
            texts = re.findall(element, page, re.DOTALL)
            hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in texts]
            self.assertEqual(rules[name], " ".join(f"'sha256-{each}'" for each in hashes))

    def test_the_same_scene_gives_the_same_page(self):
        self.run_pliant("view", self.scene(), "-o", "a.html", "--threads", "1")
        self.run_pliant("view", self.scene(), "-o", "b.html", "--threads", "3")
        with open(self.path("a.html"), "rb") as a, open(self.path("b.html"), "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_the_summary_is_one_line(self):
        result = self.run_pliant("view", self.scene())
        self.assertRegex(result.stdout, r"^view\.html: 12 frames, 163 vertices, [\d.]+ kB, [\d.]+ s, "
                                        r"peak displacement [\d.]+\n$")

    def test_an_ending_names_the_format_ahead_of_all_work(self):
        # Not even the scene is read.
        for option, allowed, names in (("-o", ".html, .htm", ("a.png", "a.pdf", "a", "a.html.gz", "a.xml", ".html")),
                                       ("--png", ".png", ("a.jpg", "a.jpeg", "a", "a.png.tif", "a.html", "png", "a.")),
                                       ("--movie", ".mp4, .gif, .webm", ("a.png", "a.mov", "a"))):
            for name in names:
                result = self.run_pliant("view", "none.xml", option, name, code=2)
                ending = os.path.splitext(name)[1]
                self.assertEqual(result.stderr, f'pliant: error: {option} {name}: no format has the ending "{ending}"; '
                                                f"allowed: {allowed}\n")
        self.assertIn(".png", self.run_pliant("view", "none.xml", "--png", "a.jpg", "--contact-sheet", code=2).stderr)
        for option, name in (("-o", "A.HTML"), ("-o", "a.htm"), ("--png", "a.PNG"), ("--movie", "a.Mp4")):
            self.assertNotIn("ending", self.run_pliant("view", "none.xml", option, name, code=2).stderr)

    def test_what_cannot_be(self):
        scene = self.scene("scene.html")
        shutil.copy(scene, self.path("scene.png"))
        for arguments, code, words in (
                (["view", "none.xml"], 2, "none.xml"),
                (["view", scene, "-o", scene], 2, "it is the scene"),
                (["view", "scene.png", "--png", "scene.png"], 2, "it is the scene"),
                (["view", scene, "--frames", "5:99"], 2, "--frames 5:99"),
                (["view", scene, "-o", "no/where/view.html"], 1, "no/where/view.html"),
                (["view", scene, "--serve", "99999"], 2, "must be a port"),
                (["view", scene, "--png", "a.png", "--frame", "99"], 2, "--frame 99"),
                (["view", scene, "--png", "a.png", "--size", "3x99999"], 2, "--size 3x99999"),
                (["view", scene, "--frame", "3"], 2, "--png"),
                (["view", scene, "--size", "64x64"], 2, "--png or --movie"),
                (["view", scene, "--look", "turn=3"], 2, "--png or --movie"),
                (["view", scene, "--movie", "a.avi"], 2, "allowed: .mp4, .gif, .webm"),
                (["view", scene, "--movie", "a.mp4", "--png", "a.png"], 2, "--png"),
                (["view", scene, "--movie", "a.mp4", "--size", "641x361"], 2, "must be even"),
                (["view", scene, "--movie", "a.mp4", "--frames", "5:99"], 2, "--frames 5:99"),
                (["view", scene, "--png", "a.png", "--contact-sheet", "--frame", "3"], 2, "--frame")):
            with self.subTest(arguments):
                result = self.run_pliant(*arguments, code=code)
                self.assertIn(words, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertEqual(sorted(os.listdir(self.folder)), ["scene.html", "scene.png"])


    def test_a_movie_without_its_programs_fails_ahead_of_the_run(self):
        scene = self.scene(end=3)
        bare = self.path("bin")
        os.mkdir(bare)
        result = self.run_pliant("view", scene, "--movie", "a.mp4", code=1, env={"PATH": bare})
        self.assertRegex(result.stderr, r"\Apliant: error: --movie needs ffmpeg.*not on the PATH\n\Z")
        with open(os.path.join(bare, "ffmpeg"), "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\n")
        os.chmod(file.name, 0o755)
        result = self.run_pliant("view", scene, "--movie", "a.mp4", code=1, env={"PATH": bare})
        self.assertRegex(result.stderr, r"\Apliant: error: --movie needs Chromium.*\n\Z")
        self.assertEqual(sorted(os.listdir(self.folder)), ["bin", "scene.xml"])

    def test_a_movie_overwrites_no_input_and_its_rate_must_be_one(self):
        scene = self.scene("scene.mp4", end=3)
        result = self.run_pliant("view", scene, "--movie", scene, code=2)
        self.assertIn("it is the scene", result.stderr)
        for fps, name, words in (("2000", "a.webm", "0.01 to 1000"), ("60", "a.gif", "a .gif can have at most 50")):
            scene = self.scene(end=3)
            with open(scene, encoding="utf-8") as file:
                text = file.read()
            with open(scene, "w", encoding="utf-8") as file:
                file.write(text.replace('fps="25"', f'fps="{fps}"'))
            result = self.run_pliant("view", scene, "--movie", name, code=2)
            self.assertIn(words, result.stderr)

    def test_every_frame_is_among_the_points_of_a_curve(self):
        self.run_pliant("view", self.scene(end=399), "--quiet")
        _, head, _ = read_page(self.path("view.html"))
        frames = {point[0] for point in head["channels"][0]["points"]}
        self.assertEqual(frames & set(range(1, 400)), set(range(1, 400)))

    def test_more_frames_than_memory_holds_are_refused_ahead(self):
        scene = self.scene(end=3000)
        result = self.run_pliant("view", scene, "--max-memory", "0.006", code=1)
        self.assertRegex(result.stderr, r"a page of 3000 frames of 163 vertices needs .* --frames A:B\n$")
        self.assertEqual(os.listdir(self.folder), ["scene.xml"])
        self.run_pliant("view", scene, "--max-memory", "0.006", "--frames", "1:40")


class Serve(View):
    def setUp(self):
        if not HAS_PAGE:
            self.skipTest("this build has no page")
        super().setUp()
        self.server = None

    def tearDown(self):
        if self.server:
            self.server.kill()

    def scene(self, name="scene.xml", **values):
        """Saves in one step, so that no incomplete save is read."""
        os.replace(super().scene("next.xml", **values), self.path(name))
        return self.path(name)

    def start(self):
        self.server = Server(self.scene())
        self.server.wait_for("baked")
        return self.server

    def test_a_save_is_seen(self):
        server = self.start()
        before, _ = unpack(server.get("bake")[1])
        for magnitude in (500, 7000):
            self.scene(magnitude=magnitude)
            server.wait_for("baked")
            after, _ = unpack(server.get("bake")[1])
            self.assertEqual(after["forces"][0]["magnitude"][4], magnitude)
            self.assertNotEqual(after["surfaces"][0]["peakDisplacement"], before["surfaces"][0]["peakDisplacement"])

    def test_what_was_solved_for_an_earlier_save_is_not_solved_again(self):
        server = self.start()
        for magnitude in (500, 7000, 500):
            self.scene(magnitude=magnitude)
            server.wait_for("baked")
        _, out, _ = server.close()
        solved = [int(count) for count in re.findall(r", (\d+) frames? solved, \d+ read\n", out)]
        self.assertEqual(len(solved), 4)
        self.assertGreater(solved[2], 0)
        self.assertEqual(solved[3], 0)

    def test_errors_are_told_with_their_lines_and_go_with_the_next_save(self):
        server = self.start()
        kept = server.get("bake")[1]
        path = self.scene()
        with open(path, "a", encoding="utf-8") as file:
            file.write("<scene>")
        messages = json.loads(server.wait_for("failed"))["messages"]
        self.assertEqual(messages[0]["kind"], "error")
        self.scene(magnitude='7" falof="')
        messages = json.loads(server.wait_for("failed"))["messages"]
        self.assertEqual([(each["file"], each["line"]) for each in messages], [("scene.xml", 6)])
        self.assertIn("falof", messages[0]["text"])
        self.assertEqual(server.get("bake")[1], kept)
        self.scene(magnitude=5)
        server.wait_for("baked")

    def told_to_a_new_page(self):
        """The first event of a new page: its name and its data."""
        with self.server.connect(self.server.request("events")) as link:
            text = b""
            while b"\n\n" not in text.partition(b"\r\n\r\n")[2]:
                text += link.recv(65536)
        name, told = re.match(r"event: (\w+)\ndata: (.*)\n\n", text.decode().partition("\r\n\r\n")[2]).groups()
        return name, json.loads(told)

    def test_a_new_page_is_told_what_the_others_were_told(self):
        server = self.start()
        self.assertEqual(self.told_to_a_new_page(), ("baked", {"bake": 1, "messages": []}))
        kept = server.get("bake")[1]
        scene = self.path("scene.xml")
        for spoil, place in ((lambda: self.scene(magnitude='7" falof="'), "scene.xml"), (lambda: os.remove(scene), "scene.xml")):
            spoil()
            told = json.loads(server.wait_for("failed"))
            self.assertEqual((told["bake"], told["messages"][0]["file"]), (1, place))
            self.assertEqual(self.told_to_a_new_page(), ("failed", told))
            self.assertEqual(server.get("bake")[1], kept)
        with open(self.path("other.xml"), "w", encoding="utf-8") as file:
            file.write(SCENE.format(start=1, end=12, magnitude=5, transform=""))
        os.replace(self.path("other.xml"), scene)
        told = json.loads(server.wait_for("baked"))
        self.assertEqual(told, {"bake": 2, "messages": []})
        self.assertEqual(self.told_to_a_new_page(), ("baked", told))

    def test_a_file_replaced_by_one_of_the_same_size_and_age_is_seen(self):
        server = self.start()
        old = os.stat(self.path("scene.xml"))
        other = self.path("other.xml")
        with open(other, "w", encoding="utf-8") as file:
            file.write(SCENE.format(start=1, end=12, magnitude=7000, transform=""))
        os.utime(other, ns=(old.st_atime_ns, old.st_mtime_ns))
        self.assertEqual(os.stat(other).st_size, old.st_size)
        os.replace(other, self.path("scene.xml"))
        server.wait_for("baked")
        after, _ = unpack(server.get("bake")[1])
        self.assertEqual(after["forces"][0]["magnitude"][4], 7000)

    def test_a_scene_that_is_wrong_from_the_start_is_served_all_the_same(self):
        with open(self.path("scene.xml"), "w", encoding="utf-8") as file:
            file.write("<scene")
        self.server = Server(self.path("scene.xml"))
        told = json.loads(self.server.wait_for("failed"))
        self.assertEqual((told["bake"], self.told_to_a_new_page()), (0, ("failed", told)))
        self.assertEqual(self.server.get("bake")[0], 404)
        self.scene()
        self.server.wait_for("baked")

    def test_ctrl_c_ends_it_while_pages_listen(self):
        server = self.start()
        code, out, err = server.close()
        self.assertEqual((code, err), (0, ""), out)

    def test_a_taken_port_is_said(self):
        server = self.start()
        result = self.run_pliant("view", self.scene(), "--serve", str(server.port), code=1)
        self.assertIn(f"127.0.0.1:{server.port}", result.stderr)


if __name__ == "__main__":
    main()
