"""Looks for random scenes that are well posed (well_posed.py) and whose peak displacement is 0.03 to
1 of the sheet's size."""

import argparse
import collections
import os
import tempfile

import numpy as np

from random_yield import has_yields, with_yields
from well_posed import amplifies_noise, trouble_of


def make_scene(kind, prefix, seed, index, folder, rejections):
    """Writes one accepted scene, made by a `kind` of SceneMaker; returns its tags, its relative peak
    and its diagnostics."""
    name = f"{prefix}-{seed}-{index:03d}"
    path = os.path.join(folder, name + ".xml")
    for attempt in range(1000):
        rng = np.random.default_rng([seed, index, attempt])
        with tempfile.TemporaryDirectory() as scratch:
            maker = kind(rng, scratch, name)
            text_of_factor = maker.make()
            factor, stresses = 1.0, {}  # stresses are those of the factor 1
            is_elastic = has_yields(text_of_factor(factor))
            trial = os.path.join(scratch, name + ".xml")
            for _ in range(7):
                text = with_yields(text_of_factor(factor), {
                    surface: factor * stress for surface, stress in stresses.items()})
                with open(trial, "w", encoding="utf-8") as stream:
                    stream.write(text)
                try:
                    trouble, peak, diagnostics, results = trouble_of(trial)
                except AssertionError as error:
                    trouble, peak = f"not legal ({str(error).split('=')[0]})", 0.0
                    break
                if 0.03 <= peak <= 1.0 or peak == 0:
                    if not is_elastic:
                        break
                    is_elastic = False
                    stresses = {surface: stress / factor
                                for surface, stress in diagnostics.stresses.items() if stress}
                    continue
                factor *= 0.3 / peak
            is_moved = 0.03 <= peak <= 1.0
            if trouble is None and (is_moved or peak == 0) and amplifies_noise(trial, results):
                trouble = "the reference amplifies noise"
            if trouble is None and not is_moved:
                # A few scenes without motion are wanted: they must stay exactly at rest.
                if peak > 0 or rng.random() > 0.05:
                    trouble = "too little or too much motion"
                else:
                    maker.tags.add("nothing moves")
            if trouble is not None:
                rejections[trouble] += 1
                continue
            note_run(maker.tags, diagnostics)
            head, body = text.split("\n", 1)
            comment = f"<!-- {', '.join(sorted(maker.tags))} -->"
            with open(path, "w", encoding="utf-8") as stream:
                stream.write(f"{head}\n{comment}\n{body}")
            for file, samples in maker.caches.items():
                np.save(os.path.join(folder, file), samples)
            for file, mesh_text in maker.meshes.items():
                with open(os.path.join(folder, file), "w", encoding="utf-8") as stream:
                    stream.write(mesh_text)
            for file, picture in maker.pictures.items():
                with open(os.path.join(folder, file), "wb") as stream:
                    stream.write(picture)
            return maker.tags, peak, diagnostics
    raise AssertionError(f"no well-posed scene for {name}")


def note_run(tags, diagnostics):
    """Tags known only after a run."""
    if diagnostics.recovering:
        tags.add("ran: recovering nodes")
    if diagnostics.flows:
        tags.add("ran: flow")
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


def main(kind, prefix):
    parser = argparse.ArgumentParser(description=f"Generates random scenes: {prefix}.")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("-o", "--output", required=True, metavar="DIR")
    arguments = parser.parse_args()
    os.makedirs(arguments.output, exist_ok=True)
    coverage, rejections = collections.Counter(), collections.Counter()
    for index in range(arguments.count):
        tags, peak, diagnostics = make_scene(kind, prefix, arguments.seed, index,
                                             arguments.output, rejections)
        coverage.update(tags)
        print(f"{prefix}-{arguments.seed}-{index:03d}: peak {peak:.3g} of the size, "
              f"{len(diagnostics.solves)} solves, {len(diagnostics.skips)} without, "
              f"margin {diagnostics.tie_margin:.1e}", flush=True)
    print("covered:")
    for tag, number in sorted(coverage.items()):
        print(f"  {number:4d}  {tag}")
    print("rejected:")
    for reason, number in rejections.most_common():
        print(f"  {number:4d}  {reason}")
    return 0
