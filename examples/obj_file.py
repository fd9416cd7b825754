"""Shared by scripts that make meshes, as make_belly.py: their option -o, and the .obj that they write."""

import argparse
import pathlib


def chosen_file(script, description):
    """The file after -o; without it the one beside a script make_NAME.py: NAME.obj."""
    script = pathlib.Path(script)
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", type=pathlib.Path,
                        default=script.with_name(script.stem.removeprefix("make_") + ".obj"))
    return parser.parse_args().out


def write(out, name, vertices, faces):
    """`faces` are lists of vertices, counted from 0."""
    with out.open("w", encoding="utf-8") as file:
        file.write(f"o {name}\n")
        for vertex in vertices:
            file.write("v " + " ".join(f"{x:.5f}" for x in vertex) + "\n")
        for face in faces:
            file.write("f " + " ".join(str(corner + 1) for corner in face) + "\n")
