"""Looks for random scenes that are well posed (well_posed.py) and whose peak displacement is 0.03 to
1 of the sheet's size.

The search runs a scene up to eight times, and many that it rejects. What it finds is a `Find`, a line
of a file, from which the same scene is made without a run."""

import argparse
import collections
import dataclasses
import json
import os
import tempfile

import numpy as np

from random_yield import has_yields, with_yields
from well_posed import amplifies_noise, trouble_of


@dataclasses.dataclass
class Find:
    """What makes a scene, besides its name."""
    attempt: int  # seeds the drawing
    factor: float  # of all magnitudes
    stresses: dict  # the largest of each surface that may yield, at the factor 1
    rests: bool  # nothing moves


def search(kind, name, seed, index, rejections):
    """Finds a scene by a `kind` of SceneMaker; returns it and its diagnostics."""
    for attempt in range(1000):
        with tempfile.TemporaryDirectory() as scratch:
            rng = np.random.default_rng([seed, index, attempt])
            maker = kind(rng, scratch, name)
            text_of_factor = maker.make()
            find = Find(attempt, 1.0, {}, False)
            is_elastic = has_yields(text_of_factor(1.0))
            trial = os.path.join(scratch, name + ".xml")
            for _ in range(7):
                with open(trial, "w", encoding="utf-8") as stream:
                    stream.write(scene_text(text_of_factor, find))
                try:
                    trouble, peak, diagnostics, results = trouble_of(trial)
                except AssertionError as error:
                    trouble, peak = f"not legal ({str(error).split('=')[0]})", 0.0
                    break
                if 0.03 <= peak <= 1.0 or peak == 0:
                    if not is_elastic:
                        break
                    is_elastic = False
                    find.stresses = {surface: float(stress / find.factor)
                                     for surface, stress in diagnostics.stresses.items() if stress}
                    continue
                find.factor = float(find.factor * 0.3 / peak)
            else:
                trouble = trouble or "too little or too much motion"
            is_moved = 0.03 <= peak <= 1.0
            if trouble is None and (is_moved or peak == 0) and amplifies_noise(trial, results):
                trouble = "the reference amplifies noise"
            if trouble is None and not is_moved:
                # A few scenes without motion are wanted: they must stay exactly at rest.
                if peak > 0 or rng.random() > 0.05:
                    trouble = "too little or too much motion"
                find.rests = True
            if trouble is None:
                return find, diagnostics
            rejections[trouble] += 1
    raise AssertionError(f"no well-posed scene for {name}")


def scene_text(text_of_factor, find):
    return with_yields(text_of_factor(find.factor), {
        surface: find.factor * stress for surface, stress in find.stresses.items()})


def write_scene(kind, name, seed, index, find, folder, diagnostics=None):
    """Writes a scene that was found, with its files; returns its tags."""
    with tempfile.TemporaryDirectory() as scratch:
        maker = kind(np.random.default_rng([seed, index, find.attempt]), scratch, name)
        text = scene_text(maker.make(), find)
    if find.rests:
        maker.tags.add("nothing moves")
    if diagnostics:
        note_run(maker.tags, diagnostics)
    head, body = text.split("\n", 1)
    comment = f"<!-- {', '.join(sorted(maker.tags))} -->"
    with open(os.path.join(folder, name + ".xml"), "w", encoding="utf-8") as stream:
        stream.write(f"{head}\n{comment}\n{body}")
    for file, samples in maker.caches.items():
        np.save(os.path.join(folder, file), samples)
    for file, mesh_text in maker.meshes.items():
        with open(os.path.join(folder, file), "w", encoding="utf-8") as stream:
            stream.write(mesh_text)
    for file, picture in maker.pictures.items():
        with open(os.path.join(folder, file), "wb") as stream:
            stream.write(picture)
    return maker.tags


def note_run(tags, diagnostics):
    """Tags known only after a run."""
    if diagnostics.recovering:
        tags.add("ran: recovering nodes")
    if diagnostics.flows:
        tags.add("ran: flow")
    if diagnostics.touches:
        tags.add("ran: contact")
    if diagnostics.unions:
        tags.add("ran: a union that is no box")
    if diagnostics.exact_ties:
        tags.add("ran: exact ties")
    for _, _, reason in diagnostics.skips:
        tags.add(f"ran: {reason}")
    by_surface = collections.defaultdict(list)
    for frame, surface, box in diagnostics.solves:
        by_surface[surface].append((frame, box))
    for solves in by_surface.values():
        frames = [frame for frame, _ in solves]
        if any(q - p > 1 for p, q in zip(frames, frames[1:])):
            tags.add("ran: frames without a solve between solves")
        if len({box for _, box in solves}) > 1:
            tags.add("ran: region changes")


def read_finds(path):
    """The finds of a file by the names of their scenes; none if there is no file."""
    if path is None or not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as stream:
        lines = [json.loads(line) for line in stream]
    return {line.pop("scene"): Find(**line) for line in lines}


def main(kind, prefix):
    parser = argparse.ArgumentParser(description=f"Generates random scenes: {prefix}.")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("--finds", metavar="FILE",
                        help="makes the scenes that FILE tells, and adds the others to it")
    parser.add_argument("-o", "--output", required=True, metavar="DIR")
    arguments = parser.parse_args()
    os.makedirs(arguments.output, exist_ok=True)
    coverage, rejections = collections.Counter(), collections.Counter()
    finds = read_finds(arguments.finds)
    for index in range(arguments.count):
        name, diagnostics = f"{prefix}-{arguments.seed}-{index:03d}", None
        if name not in finds:
            finds[name], diagnostics = search(kind, name, arguments.seed, index, rejections)
            print(f"{name}: {len(diagnostics.solves)} solves, {len(diagnostics.skips)} without, "
                  f"margin {diagnostics.tie_margin:.1e}", flush=True)
            if arguments.finds:
                with open(arguments.finds, "a", encoding="utf-8") as stream:
                    stream.write(json.dumps({"scene": name} | dataclasses.asdict(finds[name])) + "\n")
        coverage.update(write_scene(kind, name, arguments.seed, index, finds[name], arguments.output,
                                    diagnostics))
    print("covered:")
    for tag, number in sorted(coverage.items()):
        print(f"  {number:4d}  {tag}")
    print("rejected:")
    for reason, number in rejections.most_common():
        print(f"  {number:4d}  {reason}")
    return 0
