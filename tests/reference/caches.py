"""Animated shapes: reads .npy, .pc2 and .mdd, trusting them, and gives R at every frame (SPEC 9)."""

import os
import struct

import numpy as np


def read_samples(path, fps, start, first):
    """(frame of each sample, samples x vertices x 3) of a cache whose first sample is at `first`,
    None for its own frame or the scene's start."""
    with open(path, "rb") as file:
        content = file.read()
    kind = os.path.splitext(path)[1].lower()
    if kind == ".npy":
        samples = np.load(path).astype(float)
        times = np.arange(len(samples), dtype=float)
        return times + (start if first is None else first), samples
    if kind == ".pc2":
        magic, version, vertices, own, rate, count = struct.unpack("<12siiffi", content[:32])
        assert magic == b"POINTCACHE2\0" and version == 1
        times = rate * np.arange(count) + (own if first is None else first)
        numbers = np.frombuffer(content, "<f4", 3 * count * vertices, 32)
    else:
        assert kind == ".mdd", kind
        count, vertices = struct.unpack(">ii", content[:8])
        seconds = np.frombuffer(content, ">f4", count, 8).astype(float)
        times = (seconds - seconds[0]) * fps
        is_whole = np.abs(times - np.rint(times)) <= 1e-6 * np.maximum(times, 1)
        times = np.where(is_whole, np.rint(times), times) + (start if first is None else first)
        numbers = np.frombuffer(content, ">f4", 3 * count * vertices, 8 + 4 * count)
    return times, numbers.astype(float).reshape(count, vertices, 3)


class Cache:
    """R of all vertices over time: linear between samples, held outside."""

    def __init__(self, path, fps, start, first):
        self.times, self.samples = read_samples(path, float(fps), start, first)

    def at(self, frame):
        after = int(np.searchsorted(self.times, frame, side="right"))
        if after == 0:
            return self.samples[0].copy()
        if after == len(self.times):
            return self.samples[-1].copy()
        before = after - 1
        share = (frame - self.times[before]) / (self.times[after] - self.times[before])
        return self.samples[before] + share * (self.samples[after] - self.samples[before])

    def around(self, frame):
        """R at the frame before, at the frame and at the one after, mirrored at the ends."""
        before, now, after = (self.at(frame + step) for step in (-1, 0, 1))
        if self.times[0] <= frame <= self.times[-1]:
            if frame - 1 < self.times[0]:
                before = 2 * now - after
            elif frame + 1 > self.times[-1]:
                after = 2 * now - before
        return before, now, after


class NoCache:
    """The shape of the mesh, at every frame."""

    def __init__(self, vertices):
        self.vertices = vertices

    def at(self, frame):
        del frame
        return self.vertices.copy()

    def around(self, frame):
        return self.at(frame), self.at(frame), self.at(frame)
