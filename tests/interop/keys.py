"""Keys between pliant and Blender: what each shows of the other's curves. Used by interop_test.py."""

import json
import os
import random
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
SCRIPT = os.path.join(HERE, "..", "..", "script", "blender_curves.py")
COUNT = 200

EASES = [ease + side for ease in ("sine", "quad", "cubic", "quart", "quint", "expo", "circ", "back", "bounce",
                                  "elastic") for side in ("In", "Out", "InOut")]
TANGENTS = ("auto", "spline", "linear", "flat", "clamped", "plateau", "smooth", "free", "0.5", "-2")
OUTSIDE = ("hold", "linear", "linearOuter", "slope 0.3", "repeat", "repeatOffset", "mirror", "repeat 2", "mirror 3",
           "repeatOffset 2")


def animate(chance):
    lines = [f'<animate attribute="magnitude" before="{chance.choice(OUTSIDE)}" after="{chance.choice(OUTSIDE)}" '
             f'overshoot="{chance.choice(("limit", "keepStart", "contain"))}">']
    frame = chance.randint(-10, 10)
    for _ in range(chance.randint(1, 6)):
        kind = chance.choice(["bezier"] * 8 + ["step", "stepNext", "linear"] * 2 + [chance.choice(EASES)] * 6)
        more = f' interpolation="{kind}"'
        if kind.startswith("elastic") and chance.random() < 0.5:
            more += f' amplitude="{chance.uniform(0, 20)}" period="{chance.uniform(2, 8)}"'
        for side in ("in", "out"):
            more += f' {side}="{chance.choice(TANGENTS)}"'
            if chance.random() < 0.4:
                more += f' {side}Length="{chance.uniform(0, 15)}"'
        if chance.random() < 0.15:
            more += f' left="{chance.uniform(-10, 10)}"'
        lines.append(f'<key frame="{frame}" value="{chance.uniform(-10, 10)}"{more}/>')
        frame += chance.randint(1, 14)
    return "\n".join(lines + ["</animate>"])


def scene(elements):
    points = "\n".join(f'<point name="f{number}">{element}</point>' for number, element in enumerate(elements))
    return f'<scene version="1" start="1" end="60"><surface name="s"><grid columns="3" rows="3"/></surface>{points}</scene>'


class Keys:
    """Both ways, once. `rows(kind)`: of each curve its name and [frame, of Blender, of pliant]."""

    def __init__(self, pliant, folder):
        self.pliant, self.folder = pliant, folder
        chance = random.Random(5)
        self.write("ours.xml", scene([animate(chance) for _ in range(COUNT)]))
        self.told = self.run(pliant, "export", "curves", self.path("ours.xml"), "-o", self.path("ours.json")).stderr
        self.run("blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P",
                 os.path.join(HERE, "blender_keys.py"), "--", SCRIPT,
                 *map(self.path, ("ours.json", "seen.json", "theirs.json", "made.json")))
        self.write("theirs.xml", scene([""] * COUNT))
        maps = [word for number in range(COUNT) for word in ("--map", f'Ball.["p{number}"]=f{number}.magnitude')]
        self.read_told = self.run(pliant, "import", "curves", self.path("theirs.json"), "-o", self.path("theirs.xml"),
                                  *maps).stderr

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    @staticmethod
    def run(*command):
        result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=240)
        if result.returncode != 0:
            raise RuntimeError(f"{command[:3]}: {result.stdout[-3000:]}\n{result.stderr[-3000:]}")
        return result

    def load(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return json.load(file)

    def ours_at(self, name, number, frames):
        """Values of pliant's curve at frames, and just beside them."""
        self.write("at.txt", "".join(f"{frame!r}\n" for frame in frames))
        text = self.run(self.pliant, "curves", self.path(name), "--channel", f"f{number}.magnitude", "--at",
                        self.path("at.txt")).stdout
        return [float(line.split(",")[2]) for line in text.splitlines()[1:]]

    def disagreements(self, name, seen, is_told, gap, inside=None):
        """The names of curves whose values in Blender are none of those that pliant's curve has within `gap`
        frames, up to single precision, or up to the tolerance where a change was told."""
        wrong = []
        for number, rows in enumerate(seen):
            told = is_told(number)
            rows = [row for row in rows if inside is None or not told or inside[0] <= row[0] <= inside[1]]
            width = (gap if told else 0) + 2e-4
            frames, steps = [], 0
            for frame, _ in rows:
                near = [frame + width * (2 * k / 8 - 1) for k in range(9)]
                # Keys of Blender are in single precision, and it takes a frame within 0.0001 for theirs. A curve
                # may jump there, or arrive upright.
                near += [float(f"{frame:.7g}"), float(f"{frame:.8g}"), round(frame, 5)]
                whole = round(frame)
                near += [whole, whole - 1e-9] if abs(whole - frame) <= width else [frame, frame]
                frames += near
                steps = len(near)
            ours = self.ours_at(name, number, frames)
            size = max((abs(value) for _, value in rows), default=0) + 1
            slack = (2e-4 if told else 2e-5) * size
            for index, (frame, value) in enumerate(rows):
                near = ours[steps * index:steps * (index + 1)]
                # Between two samples of a steep curve there may be any value in between.
                if not min(near) - slack <= value <= max(near) + slack:
                    wrong.append((number, frame, value, near[4]))
                    break
        return wrong
