"""Shared by the tests of `pliant sweep`: a scene, a sweep of it, and what its folder has."""

import csv
import glob
import io
import json
import os

from command import Command

SCENE = """<scene version="1" start="1" end="{end}">
  <surface name="sheet"><grid columns="{columns}" rows="9" width="10" depth="10"/>
    <material density="{density}" damping="5" c="{c}"/></surface>
  <point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2.5" magnitude="{magnitude}"/>
</scene>
"""
PLAIN = {"end": 8, "columns": 11, "density": 1, "c": 2, "magnitude": 900}
VARY = ("--vary", "sheet.density=1,3", "--vary", "poke.magnitude*=0.5:2:4")


def edited(**changed):
    return SCENE.format(**{**PLAIN, **changed})


class SweepCommand(Command):
    def sweep(self, *arguments, **options):
        return self.run_pliant("sweep", *arguments, **options)

    def make(self, name="s", *options, vary=VARY, scene=None, code=0):
        scene = scene or self.write("scene.xml", edited())
        return self.sweep("run", scene, "-o", self.path(name), *vary, *options, code=code)

    def table(self, name="s"):
        return self.read(f"{name}/takes.csv")

    def rows(self, name="s"):
        return list(csv.DictReader(io.StringIO(self.table(name).decode())))

    def tree(self):
        return {os.path.join(folder, name): os.stat(os.path.join(folder, name)).st_mtime_ns
                for folder, _, names in os.walk(self.folder) for name in names}

    def undisturbed(self, *options, vary=VARY):
        self.make("undisturbed", "--threads", "1", *options, vary=vary)
        return self.table("undisturbed")

    def whole_lines(self, name):
        takes = set()
        for file in glob.glob(self.path(f"{name}/log/*.jsonl")):
            with open(file, encoding="utf-8") as lines:
                takes.update(json.loads(line)["take"] for line in lines if line.endswith("\n"))
        return len(takes)

    def log_size(self, name):
        return sum(os.path.getsize(file) for file in glob.glob(self.path(f"{name}/log/*.jsonl")))
