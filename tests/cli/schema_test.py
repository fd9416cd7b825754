"""docs/pliant-scene.xsd against the reader, by xmllint: what the reader accepts, the schema accepts; what the
reader refuses, the schema refuses too, but for the rules that docs/scene-format.md says it cannot state."""

import glob
import json
import os
import random
import re
import subprocess

from command import Command, PLIANT, SOURCE, main

SCHEMA = os.path.join(SOURCE, "docs/pliant-scene.xsd")
FORCES = ("point", "radial", "line", "uniform", "vortex", "noise", "inertia", "pressure")
ALIKE = {"number": "1", "vector": "1 1 1", "boolean": "true", "word": None, "integer": "1", "rate": "25",
         "name": "other", "names": "sheet", "integers": "0 3", "path": "none.obj", "text": "some",
         "one or two numbers": "1 2", "number or vector": "1 2 3", "one or four words": "clamped", "value": "2", "tangent": "auto",
         "interpolation": "linear", "extrapolation": "repeat", "handle": "0 0", "four numbers": "0 0 1 1"}

# The rules that the schema cannot say, in the words of docs/scene-format.md, and the reader's messages about them.
UNSAID = {
    "what a surface has once": r"has two shapes|has no shape|has a second <(transform|material|tangents|solver)>",
    "names that refer to others": r"no surface is named|is a <\w+>, not a surface|cannot drive itself|driven by",
    "what kind of values a channel has": r"a boolean channel|(three numbers|one number) (are|is) required|true or false|"
                                         r"not a number|handle|the slope",
    "the numbers of a net": r"each point has three|<nurbs>|control points|knots|weights",
    "numbers of which a double keeps nothing": r"range of numbers that can be stored",
    "the same name twice in a list": r"is given twice",
    "the first and third number of control": r"x1 and x2 must be",
    "how large a surface may be": r"needs [\d.]+ [GT]B|at most \d+ are allowed",
    "what is in files": r"\.obj|\.png|\.npy|cannot read|no node is above",
    "rules between values, attributes and elements":
        r"is already (animated|given)|has both|remove one of them|applies only to|needs control|must be (before|after)|"
        r"comes before|greater than -2|must be at most \d+ frames|frames|degree|has no such position|repeats the key|"
        r"is not after|copied keys|no key at|to=|at most 10|needs a file or an attribute|is for a mesh|but|waypoint",
}


def rule_of(message):
    """The rule of UNSAID that a message is about, or null."""
    return next((rule for rule, words in UNSAID.items() if re.search(words, message)), None)


def page_rows():
    """The rows of the tables of attributes: element, attribute, type, range, whether it is required."""
    rows = []
    with open(os.path.join(SOURCE, "docs/scene-format.md"), encoding="utf-8") as file:
        for line in file:
            cells = [cell.strip().replace("`", "") for cell in line.split("|")[1:-1]]
            if len(cells) == 8 and cells[0] not in ("element", "---"):
                rows.append((cells[0], cells[1], cells[2], "" if cells[5] == "–" else cells[5],
                             cells[4] == "required"))
    return rows


def tag(element, needed, change):
    """`<element …` with the needed attributes; `change` is (element, attribute, value or None)."""
    attributes = dict(re.findall(r'(\w+)="([^"]*)"', needed))
    if change and change[0] == element:
        attributes.pop(change[1], None)
        if change[2] is not None:
            attributes[change[1]] = change[2]
    return f"<{element}" + "".join(f' {name}="{value}"' for name, value in attributes.items())


def scene_around(change, extra=None):
    """A valid scene around the element that `change` names, with the change. `extra`: what follows the start tag
    of the element, as (element, text)."""
    element, attribute = change[0], change[1]

    def inside(name):
        return extra[1] if extra and extra[0] == name else ""

    def whole(name, needed="", content=""):
        return f"{tag(name, needed, change)}>{inside(name)}{content}</{name}>"

    shape = whole("grid", 'columns="4" rows="4"')
    if element in ("mesh", "subdivision"):
        shape = whole(element, f'file="{SOURCE}/examples/head.obj"')
    if element in ("nurbs", "points", "weights", "knots"):
        shape = whole("nurbs", 'columns="4" rows="4" degreeU="2" degreeV="2"',
                      whole("points", "", " ".join("0" * 48)) + whole("weights", "", " ".join("1" * 16)) +
                      whole("knots", 'along="u"', "0 0 0 1 2 2 2"))
    part = ""
    if element in ("transform", "material", "tangents", "solver"):
        part = whole(element)
    if element == "map":
        part = whole("material", "", whole("map", f'channel="b" file="{SOURCE}/examples/soft.png"'))
    if element == "hold":
        part = whole("hold", "" if attribute == "vertices" else f'file="{SOURCE}/examples/soft.png"')
    easing = {"amplitude": ' interpolation="elasticIn"', "period": ' interpolation="elasticIn"',
              "back": ' interpolation="backIn"', "control": ' interpolation="cubicBezier"'}.get(attribute, "")
    children = ""
    if element in ("path", "waypoint"):
        children = whole("path", 'attribute="center"', whole("waypoint", 'at="0 0 0"') +
                         '<waypoint at="1 0 0"/><waypoint at="1 1 0"/>')
    elif element == "falloff" or (element == "key" and attribute == "at"):
        children = whole("falloff", "", whole("key", 'at="0" value="1"'))
    elif element in ("animate", "key", "loop"):
        children = whole("animate", 'attribute="magnitude"', whole("key", 'frame="1" value="0"' + easing) +
                         '<key frame="5" value="1"/>' + whole("loop", 'from="1" to="5"'))
    force = element if element in FORCES + ("group",) else "point"
    return whole("scene", 'start="1" end="9"', whole("surface", 'name="sheet"', shape + part) +
                 whole(force, 'name="poke"', children))


def range_faults(kind, limits):
    """Values just out of the range of a row."""
    def of(number):
        return {"vector": f"1 {number} 1", "one or two numbers": f"1 {number}"}.get(kind, str(number))
    numbers = [float(word) for word in re.findall(r"-?\d[\d.e+]*", limits)]
    if kind == "four numbers" or not numbers or kind not in ("number", "integer", "vector", "one or two numbers", "rate"):
        return []
    whole = kind == "integer"
    def beyond(bound, by):
        if whole:
            return int(re.findall(r"-?\d+", limits)[0 if by < 0 else -1]) + by
        return bound + by * max(1e-9, abs(bound) * 1e-9)
    if limits.startswith(">"):
        faults = ["0", "-1"] + ([repr(2 * numbers[1])] if len(numbers) > 1 else [])
    elif limits.startswith("≥"):
        faults = [str(beyond(numbers[0], -1))]
    elif limits.startswith("≠"):
        faults = ["0", "-0.0e5", "00.00"]
    elif " to " in limits:
        faults = [str(beyond(numbers[0], -1)), str(beyond(numbers[1], 1))]
    else:
        faults = ["0", "2"]
    return [of(fault) for fault in faults]


def faults_of(row):
    """Single faults of an attribute: (kind of fault, scene)."""
    element, attribute, kind, limits, is_required = row
    def change(value):
        return scene_around((element, attribute, value))
    if is_required:
        yield "missing", change(None)
    yield "unknown attribute", scene_around((element, attribute + "x", "1"))
    if kind in ("path", "text"):
        yield "empty", change("")
        return
    for value in ("", "1,5 ?", "nan", "inf", "+1", "0x10", "1e", "1e999", "TRUE", "1 2", "1 2 3 4 5"):
        allowed = kind == "one or two numbers" and value == "1 2"
        if not allowed:
            yield f"no {kind}", change(value)
    if kind == "integer":
        yield "no integer", change("3.0")
    if kind == "boolean":
        yield "no boolean", change("1")
    for value in range_faults(kind, limits):
        yield "out of range", change(value)


class Schema(Command):
    def verdicts(self, scenes):
        """For each text: the reader's problems, and whether the schema accepts it."""
        names = [self.write(f"{k:05}.xml", text) for k, text in enumerate(scenes)]
        problems, accepted = {name: [] for name in names}, {}
        for first in range(0, len(names), 400):
            some = names[first:first + 400]
            read = subprocess.run([PLIANT, "validate", "--json", *some], capture_output=True, text=True, check=False,
                                  timeout=600)
            for problem in json.loads(read.stdout)["problems"]:
                if problem["kind"] != "note":
                    # One about a mesh is a problem of its scene.
                    if problem["severity"] == "error":
                        problems.setdefault(problem["file"], []).append(problem["message"])
            for scene in json.loads(read.stdout)["scenes"]:
                if not scene["valid"] and not problems[scene["file"]]:
                    problems[scene["file"]].append("cannot read one of its files")
            checked = subprocess.run(["xmllint", "--noout", "--schema", SCHEMA, *some], capture_output=True, text=True,
                                     check=False, timeout=600)
            for line in checked.stderr.splitlines():
                if found := re.fullmatch(r"(.*) (validates|fails to validate)", line):
                    accepted[found[1]] = found[2] == "validates"
        return [(problems[name], accepted.get(name, False)) for name in names]

    def test_all_scenes_of_the_project_are_valid(self):
        found = [path for folder in ("examples", "tests", "docs", "bench", "cli/new/starters")
                 for path in glob.glob(os.path.join(SOURCE, folder, "**/*.xml"), recursive=True)]
        self.assertGreater(len(found), 80)
        result = subprocess.run(["xmllint", "--noout", "--schema", SCHEMA, *found], capture_output=True, text=True,
                                check=False, timeout=300)
        self.assertEqual([line for line in result.stderr.splitlines() if not line.endswith(" validates")], [])

    def test_each_value_that_the_page_allows(self):
        scenes = []
        for element, attribute, kind, limits, _ in page_rows():
            values = [ALIKE[kind]] if kind != "word" else limits.split(", ")
            if kind == "word" and attribute == "attribute":
                values = ["center" if element == "path" else "magnitude"]
            if kind == "integer" and (bounds := re.findall(r"-?\d+", limits)):
                values = [bounds[0], bounds[-1]]
            values += ["$x", "$x + 1", "2*${x}"]
            scenes += [(values[k], scene_around((element, attribute, values[k]))) for k in range(len(values))]
        for (value, text), (_, accepted) in zip(scenes, self.verdicts([text for _, text in scenes])):
            self.assertTrue(accepted, text)

    def test_single_faults_of_every_attribute(self):
        faults = [(row, kind, text) for row in page_rows() for kind, text in faults_of(row)]
        self.assertGreater(len(faults), 1000)
        unsaid = set()
        for (row, kind, text), (problems, accepted) in zip(faults, self.verdicts([text for _, _, text in faults])):
            if not problems:  # no fault after all: "1e5" is a value of many kinds
                self.assertTrue(accepted, (row, kind, text))
            elif accepted:
                unsaid.add((row[1], kind, rule_of(problems[0])))
        # Words such as "inf" are names, but of no surface. All else that is wrong with one attribute is said.
        self.assertEqual(unsaid, {("targets", "no names", "names that refer to others")})

    def test_wrong_children(self):
        places = {"scene", "surface", "grid", "mesh", "nurbs", "points", "weights", "knots", "subdivision", "transform",
                  "material", "map", "tangents", "hold", "solver", "path", "waypoint", "falloff", "animate", "key", "loop",
                  "group", *FORCES}
        scenes = [scene_around((place, "at" if place == "key" else "", None), (place, content))
                  for place in sorted(places) for content in ("<wrong/>", "some text", f"<{place}/>")]
        for text, (problems, accepted) in zip(scenes, self.verdicts(scenes)):
            self.assertTrue(problems, text)
            self.assertFalse(accepted, text)

    def test_what_stands_twice_or_is_missing(self):
        force = '<point name="p">{}</point>'
        animate = '<animate attribute="magnitude"><key frame="1" value="0"/></animate>'
        falloff = '<falloff><key at="0" value="1"/></falloff>'
        grid = '<grid columns="3" rows="3"/>'
        waypoints = ['<waypoint at="%d 0 0"/>' % k for k in range(4)]
        progress = '<animate attribute="progress"><key frame="1" value="0"/></animate>'
        path = '<path attribute="center">{}</path>'
        net = '<nurbs columns="3" rows="3" degreeU="2" degreeV="2">{}</nurbs>'
        points, weights = f"<points>{'0 ' * 27}</points>", f"<weights>{'1 ' * 9}</weights>"
        knots = ['<knots along="%s">0 0 0 1 1 1</knots>' % along for along in "uv"]
        surface = '<surface name="s">{}</surface>'
        said = [
            (False, force.format(animate + animate)), (False, force.format(falloff + falloff)),
            (False, surface.format(grid) + surface.format(grid)),
            (False, force.format("") + '<group name="p"/>'),
            (False, '<group name="g">' + force.format("") + "</group>" + force.format("")),
            (False, '<group name="g"><point name="p" deformationRadius="1"/></group>'),
            (False, '<group name="g"><point name="p"><animate attribute="deformationRadius"><key frame="1" value="0"/>'
                    "</animate></point></group>"),
            (False, force.format('<animate attribute="magnitude"></animate>')),
            (False, force.format("<falloff></falloff>")),
            (False, force.format(animate.replace("</", '<loop from="1" to="2"/>' * 2 + "</"))),
            (True, force.format(animate.replace("<key", '<loop from="1" to="5"/><key').replace(
                "</", '<key frame="5" value="1"/></'))),
            (True, force.format(animate.replace("</", '<loop from="1" to="5"/><key frame="5" value="1"/></'))),
            (False, force.format(path.format("".join(waypoints[:2])))),
            (False, force.format(path.format("".join(waypoints) + progress + progress))),
            (False, force.format(path.format("".join(waypoints)) * 2)),
            (False, force.format(path.format("".join(waypoints)) + animate.replace("magnitude", "center"))),
            (False, '<uniform name="u">' + path.format("".join(waypoints)) + "</uniform>"),
            *((True, force.format(path.format("".join(waypoints[:k]) + progress + "".join(waypoints[k:]))))
              for k in range(5)),
            (True, surface.format(net.format(knots[1] + weights + points + knots[0]))),
            (True, surface.format(net.format(points))),
            (False, surface.format(net.format(weights))), (False, surface.format(net.format(points + points))),
            (False, surface.format(net.format(points + weights + weights))),
            (False, surface.format(net.format(points + knots[0] + knots[0]))),
            (False, surface.format(net.format(points.replace("0 ", "")))),
            (False, surface.format(net.format(points + weights.replace("1", "0")))),
            (False, surface.format(grid + '<material><map channel="b" file="a.npy"/><map channel="b" file="b.npy"/></material>')),
            (False, surface.format(grid + '<transform><animate attribute="rotate"><key frame="1" value="0 0 0"/></animate>'
                                   '</transform><animate attribute="rotate"><key frame="1" value="0 0 0"/></animate>')),
            (False, surface.format(grid + '<transform><animate attribute="rotate"><key frame="1" value="1"/></animate></transform>')),
            (False, surface.format(grid + '<material><animate attribute="b"><key frame="1" value="1 1 1"/></animate></material>')),
            (True, force.format(animate) + surface.format(grid + "<solver/><material/>")),
        ]
        unsaid = [
            ("what a surface has once", surface.format("")), ("what a surface has once", surface.format(grid + grid)),
            *(("what a surface has once", surface.format(grid + f"<{part}/>" * 2))
              for part in ("transform", "material", "tangents", "solver")),
            ("names that refer to others", '<surface name="s" drivenBy="t">' + grid + "</surface>"),
            ("rules between values, attributes and elements",
             '<point name="p" magnitude="1">' + animate + "</point>"),
            ("rules between values, attributes and elements",
             force.format(animate.replace("</", '<key frame="1" value="1"/></'))),
            ("what kind of values a channel has", force.format(animate.replace('"0"', '"0 0 0"'))),
            ("the numbers of a net", surface.format(net.format(points + "<weights>1</weights>"))),
            ("numbers of which a double keeps nothing", '<point name="p" magnitude="1e-999"/>'),
            ("the same name twice in a list", surface.format(grid) + '<point name="p" targets="s s"/>'),
            ("the first and third number of control", force.format(animate.replace(
                'value="0"', 'value="0" interpolation="cubicBezier" control="2 0 0 1"'))),
            ("how large a surface may be",
             surface.format('<grid columns="60000" rows="30000" width="1" depth="1"/>')),
            ("what is in files", surface.format('<mesh file="none.obj"/>')),
        ]
        self.assertEqual({rule for rule, _ in unsaid}, set(UNSAID))
        scenes = [f'<scene start="1" end="9">{body}</scene>' for _, body in said + unsaid]
        verdicts = self.verdicts(scenes)
        for (is_valid, body), (problems, accepted) in zip(said, verdicts):
            self.assertEqual((not problems, accepted), (is_valid, is_valid), (body, problems))
        for (rule, body), (problems, accepted) in zip(unsaid, verdicts[len(said):]):
            self.assertTrue(problems and accepted, (rule, body, problems))
            self.assertEqual(rule_of(problems[0]), rule, problems[0])

    def test_the_page_lists_what_the_schema_cannot_say(self):
        with open(os.path.join(SOURCE, "docs/scene-format.md"), encoding="utf-8") as file:
            page = " ".join(file.read().split())
        listed = re.search(r"It cannot say: (.*?)\. ", page)[1]
        self.assertEqual(set(re.split(r"; ", listed)), set(UNSAID))

    def test_random_changes_of_good_scenes(self):
        """The schema refuses nothing that the reader accepts, and what only the reader refuses has one of the reasons
        above."""
        random.seed(7)
        folder = os.path.join(SOURCE, "tests/reference/scenes")
        texts = []
        for path in sorted(glob.glob(os.path.join(folder, "*.xml"))) + sorted(glob.glob(os.path.join(SOURCE, "examples/*.xml"))):
            with open(path, encoding="utf-8") as file:
                text = re.sub(r"<!--.*?-->|<\?.*?\?>", "", file.read(), flags=re.DOTALL)
            texts.append(re.sub(r'(file|cache)="([^"$]*)"', lambda found: f'{found[1]}="{os.path.dirname(path)}/{found[2]}"',
                                text))
        attributes = re.findall(r' (\w+)="([^"]*)"', "".join(texts))
        elements = re.findall(r"<\w+(?: [^<>]*)?/>", "".join(texts))
        scenes = []
        for _ in range(1200):
            text = random.choice(texts)
            for _ in range(random.randint(1, 2)):
                places = list(re.finditer(r' (\w+)="([^"]*)"', text))
                place = random.choice(places)
                name, value = random.choice(attributes)
                kind = random.randrange(5)
                if kind == 0:  # another value
                    text = text[:place.start(2)] + value + text[place.end(2):]
                elif kind == 1:  # no attribute
                    text = text[:place.start()] + text[place.end():]
                elif kind == 2 and f' {name}="' not in text[text.rfind("<", 0, place.start()):text.find(">", place.end())]:
                    text = text[:place.start()] + f' {name}="{value}"' + text[place.start():]
                elif kind == 3:  # another element
                    single = random.choice(list(re.finditer(r"<\w+(?: [^<>]*)?/>", text)) or [place])
                    if single is not place:
                        text = text[:single.start()] + random.choice(elements) + text[single.start():]
                else:  # no element
                    single = random.choice(list(re.finditer(r"<\w+(?: [^<>]*)?/>", text)) or [place])
                    text = text[:single.start()] + text[single.end():]
            scenes.append(text)
        counts = {"both accept": 0, "both refuse": 0, "only the reader refuses": 0}
        for text, (problems, accepted) in zip(scenes, self.verdicts(scenes)):
            if not problems:
                self.assertTrue(accepted, text)
                counts["both accept"] += 1
            elif not accepted:
                counts["both refuse"] += 1
            else:
                counts["only the reader refuses"] += 1
                self.assertIsNotNone(rule_of(problems[0]), (problems[0], text))
        self.assertGreater(min(counts.values()), 100, counts)

    def test_including_and_defining(self):
        """Elements that are replaced before a scene is read."""
        texts = {
            True: ['<scene start="1" end="$last"><define name="last" value="48"/><include file="rig.xml"/></scene>',
                   '<scene start="1" end="9"><surface name="s"><include file="shape.xml"><define name="size" value="4"/>'
                   '</include><material><include file="maps.xml"/></material></surface></scene>',
                   '<fragment><define name="a" value="1"/><material density="$a"/><grid columns="2*$a" rows="9"/></fragment>',
                   '<material density="3"><animate attribute="b"><key frame="1" value="1"/></animate></material>',
                   '<animate attribute="center"><key frame="$f" value="0 0 $z"/></animate>', '<surface name="s"/>'],
            False: ['<scene start="1" end="9"><include/></scene>', '<scene start="1" end="9"><define name="a"/></scene>',
                    *(f'<scene start="1" end="9"><define name="{name}" value="1"/></scene>' for name in ("1x", "a-b", "a b")),
                    '<scene start="1" end="9"><transform><include file="a.xml"/></transform></scene>', "<other/>",
                    '<fragment size="1"/>', '<include file="a.xml"><grid columns="3" rows="3"/></include>']}
        for is_valid, group in texts.items():
            for text in group:
                result = subprocess.run(["xmllint", "--noout", "--schema", SCHEMA, self.write("a.xml", text)],
                                        capture_output=True, text=True, check=False, timeout=60)
                self.assertEqual(result.returncode == 0, is_valid, text + result.stderr)


if __name__ == "__main__":
    main()
