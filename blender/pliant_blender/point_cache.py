"""Point caches as files: PC2, which a Mesh Cache modifier plays."""

from __future__ import annotations

import contextlib
import os
import struct

import numpy as np

HEADER = struct.Struct("<12siiffi")  # signature, version, vertices, first frame, frames a sample, samples


class Cache:
    """A PC2 file: the frame ahead of the first one, at rest, and all frames of a scene."""

    def __init__(self, path: str):
        self.path = path
        self.first, self.count, self.vertices = 0, 0, 0
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o600)

    def shape(self, first: int, count: int, vertices: int) -> None:
        """Room for `count` samples from the frame `first` on."""
        if (first, count, vertices) == (self.first, self.count, self.vertices):
            return
        self.first, self.count, self.vertices = first, count, vertices
        os.ftruncate(self._file, 0)
        os.pwrite(self._file, HEADER.pack(b"POINTCACHE2\0", 1, vertices, float(first), 1.0, count), 0)
        os.ftruncate(self._file, HEADER.size + 12 * vertices * count)

    def write(self, frame: int, positions: np.ndarray) -> None:
        """Float32 (V, 3), C order."""
        os.pwrite(self._file, positions, HEADER.size + 12 * self.vertices * (frame - self.first))

    def read(self, frame: int) -> np.ndarray:
        """What was written: float32 (3 V,)."""
        size = 12 * self.vertices
        return np.frombuffer(os.pread(self._file, size, HEADER.size + size * (frame - self.first)), np.float32)

    def close(self) -> None:
        os.close(self._file)
        with contextlib.suppress(OSError):  # whoever empties folders of temporary files was ahead of us
            os.unlink(self.path)
