"""Makes the package of the add-on: usage make_package.py SOURCE MODULE COPYRIGHT VERSION OUT

MODULE is the folder that has the installed package pliant, as a wheel has it; it is for the Python that runs
this. OUT is the .zip that Blender installs, as an add-on and, from 4.2, as an extension.
"""

import pathlib
import re
import sys
import sysconfig

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "python"))
from archive import files_of, write_archive  # noqa: E402


def put(text, pattern, value, file):
    """The text with what the group of the pattern matches replaced."""
    found = re.search(pattern, text, re.MULTILINE)
    if not found:
        raise SystemExit(f"make_package.py: {file} has nothing like {pattern}")
    return text[: found.start(1)] + value + text[found.end(1) :]


def main():
    source, module, copyright_file, version, out = map(pathlib.Path, sys.argv[1:])
    version = str(version)
    numbers = re.match(r"(\d+)\.(\d+)\.(\d+)", version)
    files = {path.name: path.read_bytes() for path in sorted((source / "pliant_blender").glob("*.py"))}
    files["blender_curves.py"] = (source.parent / "script" / "blender_curves.py").read_bytes()
    first = files["__init__.py"].decode()
    tuple_of = f"({', '.join(numbers.groups())})"
    files["__init__.py"] = put(first, r'"version": (\(.*?\))', tuple_of, "__init__.py").encode()
    manifest = (source / "blender_manifest.toml").read_text()
    manifest = put(manifest, r'^version = "(.*)"', ".".join(numbers.groups()), "the manifest")
    platform = sysconfig.get_platform().replace("x86_64", "x64").replace("aarch64", "arm64")
    files["blender_manifest.toml"] = put(manifest, r'^platforms = \["(.*)"\]', platform, "the manifest").encode()
    files["LICENSE"] = (source / "LICENSE").read_bytes()
    files["copyright"] = copyright_file.read_bytes()
    files["_built_for.py"] = (
        f'"""What the module of this package needs."""\n\nPYTHON = "{sys.version_info[0]}.{sys.version_info[1]}"\n'
    ).encode()
    files.update({f"pliant/{name}": data for name, data in files_of(module / "pliant").items()})
    write_archive(out, {f"pliant_blender/{name}": data for name, data in sorted(files.items())})
    print(out)


main()
