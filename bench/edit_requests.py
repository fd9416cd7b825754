#!/usr/bin/env python3
"""Measures over HTTP how long an edit takes while it is dragged: from the first byte of POST operations to the last one
of GET frame, at the last of 96 frames.

    bench/edit_requests.py build/release/pliant [EDITS] (50 by default)

The centre of a force goes along a circle, as one gesture. The scenes are those of bench/edits: a sheet with three
forces, whose box is all of 61 x 61 nodes, or islands of at most 61 x 61 on 201 x 201.

  change  the answer to POST: the text is edited, read and checked [ms]
  frame   from there to the frame [ms]
  whole   both [ms]

Medians, and in brackets the slowest of ten (90th percentile).
"""

import http.client
import json
import math
import os
import re
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time

FRAMES = 96
CASES = [("61 box", 61, "box", 12), ("201 islands", 201, "islands", 2.9)]


def scene_of(side, combine, radius):
    keys = "".join(f'<key frame="{frame}" value="{value}"/>' for frame, value in ((1, 0), (13, 8000), (25, 0)))
    forces = "".join(
        f'<point name="poke{k}" center="{center}" deformationRadius="{radius}" forceRadius="{radius / 2}">'
        f'<animate attribute="magnitude">{keys}</animate></point>\n'
        for k, center in enumerate(("-4 0 -5", "5 0 -5", "0 0 5")))
    return (f'<scene version="1" start="1" end="{FRAMES}">\n<surface name="sheet">'
            f'<grid columns="{side}" rows="{side}" width="20" depth="20"/><material density="40" damping="20"/>'
            f'<solver combine="{combine}"/></surface>\n{forces}</scene>\n')


class Editor:
    def __init__(self, pliant, folder):
        self.process = subprocess.Popen([pliant, "edit", "scene.xml", "--no-open"], cwd=folder, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                        env={**os.environ, "XDG_STATE_HOME": folder})
        port, self.base = re.fullmatch(r"http://127.0.0.1:(\d+)(/\w+/)\n", self.process.stdout.readline()).groups()
        self.link = http.client.HTTPConnection("127.0.0.1", int(port), timeout=60)
        self.link.connect()
        self.link.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def ask(self, method, route, body=None):
        self.link.request(method, self.base + route, body, {"Content-Type": "application/json"} if body else {})
        answer = self.link.getresponse()
        content = answer.read()
        if answer.status != 200:
            sys.exit(f"{route}: {answer.status} {content[:300]}")
        return content

    def edit(self, angle):
        value = f"{-5 + math.cos(angle):.4f} 0 {-5 + math.sin(angle):.4f}"
        operations = [{"op": "set", "path": "poke0.center", "value": value}]
        begin = time.perf_counter()
        answer = self.ask("POST", "operations", json.dumps({"operations": operations, "gesture": "drag"}))
        changed = time.perf_counter()
        self.ask("GET", f"frame?revision={json.loads(answer)['revision']}&frame={FRAMES}")
        return 1e3 * (changed - begin), 1e3 * (time.perf_counter() - changed)

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait()


def main():
    pliant = os.path.abspath(sys.argv[1])
    edits = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    print(f"{'case':>12} {'change':>14} {'frame':>14} {'whole':>14}")
    for name, *case in CASES:
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "scene.xml"), "w", encoding="utf-8") as file:
                file.write(scene_of(*case))
            editor = Editor(pliant, folder)
            editor.edit(0)
            times = [editor.edit(0.1 * (n + 1)) for n in range(edits)]
            editor.end()
        columns = [*zip(*times), [sum(each) for each in times]]
        cells = [f"{statistics.median(column):.1f} ({statistics.quantiles(column, n=10)[-1]:.1f})" for column in columns]
        print(f"{name:>12} " + " ".join(f"{cell:>14}" for cell in cells))


if __name__ == "__main__":
    main()
