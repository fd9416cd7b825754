#!/usr/bin/env python3
"""Writes penguin.obj and penguin.pc2: a round figure, open under its feet, and its walk of 40 frames:
a few steps, from one foot to the other, until it stands.

    python3 make_penguin.py [-o penguin.obj]
"""

import math
import struct

import obj_file

RINGS, AROUND = 16, 20
FRAMES, STEP = 40, 8  # a step takes 8 frames
STOP = 26  # the frame at which it stands

# Half the width of the figure at some heights, of the feet, the belly, the neck and the head.
PROFILE = [(0, 0.62), (0.35, 0.95), (0.9, 1.08), (1.5, 0.9), (1.95, 0.6), (2.2, 0.52), (2.5, 0.58), (2.8, 0.5),
           (3.0, 0.22), (3.04, 0.0)]


def half_width(height):
    """The profile, straight between its points."""
    for (a, at_a), (b, at_b) in zip(PROFILE, PROFILE[1:]):
        if height <= b:
            t = (height - a) / (b - a)
            return at_a + (at_b - at_a) * t
    return 0.0


def at_rest():
    """Rings from the feet to the top, then the top; +z is ahead."""
    places = []
    for ring in range(RINGS):
        s = ring / RINGS
        height = 3.04 * (1 - (1 - s) ** 1.25)
        for n in range(AROUND):
            angle = 2 * math.pi * n / AROUND
            wide = half_width(height)
            x, z = wide * math.sin(angle), 0.92 * wide * math.cos(angle)
            belly = 0.2 * math.exp(-(((height - 0.95) / 0.55) ** 2)) * max(0.0, math.cos(angle)) ** 2
            beak = 0.5 * math.exp(-(((height - 2.48) / 0.14) ** 2)) * max(0.0, math.cos(angle)) ** 16
            places.append((x, height, z + belly + beak))
    return places + [(0.0, 3.04, 0.0)]


def faces():
    result = []
    for ring in range(RINGS - 1):
        for n in range(AROUND):
            a, b = ring * AROUND + n, ring * AROUND + (n + 1) % AROUND
            result.append((a, b, b + AROUND, a + AROUND))
    first = (RINGS - 1) * AROUND
    return result + [(first + n, first + (n + 1) % AROUND, first + AROUND) for n in range(AROUND)]


def walked(place, frame):
    """Where a point of the figure is at a frame: it leans onto one foot, lifts and turns the other
    side, and nods."""
    x, y, z = place
    # It sets off and stops within a few frames.
    going = min(1.0, frame / 4, max(0.0, (STOP - frame) / 4))
    going = going * going * (3 - 2 * going)
    phase = math.pi * frame / STEP
    height = y / 3.04
    lean = 0.2 * going * math.sin(phase)
    turn = 0.3 * going * math.cos(phase) * (1 - 0.8 * height)
    nod = 0.08 * going * math.cos(2 * phase) * height
    x, z = x * math.cos(turn) + z * math.sin(turn), z * math.cos(turn) - x * math.sin(turn)
    y, z = y * math.cos(nod) - z * math.sin(nod), z * math.cos(nod) + y * math.sin(nod)
    foot = math.copysign(0.5, lean)  # it leans over this foot
    x, y = foot + (x - foot) * math.cos(lean) + y * math.sin(lean), y * math.cos(lean) - (x - foot) * math.sin(lean)
    # How far it has walked: steps get longer, then shorter.
    way = min(max(frame, 0), STOP)
    way = 0.1 * (way - STOP / (2 * math.pi) * math.sin(2 * math.pi * way / STOP))
    return x, y + 0.06 * going * abs(math.sin(phase)), z + way


def main():
    out = obj_file.chosen_file(__file__, __doc__)
    places = at_rest()
    obj_file.write(out, "penguin", places, faces())
    with out.with_suffix(".pc2").open("wb") as file:
        file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, len(places), 1.0, 1.0, FRAMES))
        for frame in range(FRAMES):
            for place in places:
                # Rounded, so that every machine writes the same bytes.
                file.write(struct.pack("<3f", *(round(x, 5) for x in walked(place, frame))))


if __name__ == "__main__":
    main()
