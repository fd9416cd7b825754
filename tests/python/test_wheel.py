"""The wheel, installed where nothing of the build is."""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import zipfile

import numpy as np
import pytest

import pliant

# The folder of the wheel: that of a build.
folder = os.environ.get("PLIANT_WHEEL_FOLDER")
pytestmark = [
    pytest.mark.no_sanitizer,
    pytest.mark.skipif(not folder, reason="PLIANT_WHEEL_FOLDER is not set"),
]

# Shared libraries that every Linux has which takes wheels (manylinux).
SYSTEM = re.compile(r"linux-vdso|ld-linux|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s|z)\.so")

DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_geometries>
<geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


@pytest.fixture(scope="module")
def wheel():
    found = list(pathlib.Path(folder).glob("pliant-*.whl"))
    assert len(found) == 1
    return found[0]


@pytest.fixture(scope="module")
def venv(wheel, tmp_path_factory):
    """A function that runs the Python of a fresh environment which has the wheel, and its folder."""
    place = tmp_path_factory.mktemp("venv")
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", place], check=True)

    def run(*arguments, **options):
        clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        return subprocess.run([place / "bin/python", *arguments], env=clean, capture_output=True, text=True, **options)

    installed = run("-m", "pip", "install", "--no-deps", "--no-index", wheel)
    assert installed.returncode == 0, installed.stderr
    run.site = next(place.glob("lib/python*/site-packages"))
    return run


def test_its_tags_and_record_are_right(wheel):
    _, version, python, abi, platform = wheel.stem.split("-")
    own = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    assert (version, python, abi) == (pliant.__version__, own, own)
    assert platform == sysconfig.get_platform().replace("-", "_").replace(".", "_")
    with zipfile.ZipFile(wheel) as archive:
        assert archive.testzip() is None
        info = f"pliant-{version}.dist-info"
        record = dict(line.split(",", 1) for line in archive.read(f"{info}/RECORD").decode().splitlines())
        assert set(record) == set(archive.namelist())
        for name, told in record.items():
            if not name.endswith("/RECORD"):
                data = archive.read(name)
                digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
                assert told == f"sha256={digest},{len(data)}"
        assert f"Tag: {python}-{abi}-{platform}\n" in archive.read(f"{info}/WHEEL").decode()
        metadata = archive.read(f"{info}/METADATA").decode()
        assert "Requires-Python: >=3.9" in metadata and "Requires-Dist: numpy>=1.21" in metadata
        assert "Apache License" in archive.read(f"{info}/LICENSE").decode()
        assert {"Eigen", "pybind11", "three.js"} <= set(re.findall(r"[\w.]+", archive.read(f"{info}/copyright").decode()))
        for name in ("_core.pyi", "_parts.pyi", "edit.pyi", "py.typed"):
            assert f"pliant/{name}" in record


def test_all_that_the_system_need_not_have_is_inside(venv):
    package = venv.site / "pliant"
    for module in [next(package.glob("_core.*.so")), *package.glob("libs/*.so*")]:
        if not re.search(r"\.so(\.\d+)*$", module.name):
            continue
        # The module finds them by itself; those of the program that reads meshes are found for it.
        is_module = module.name.startswith("_core")
        environment = {"PATH": os.environ["PATH"]}
        environment.update({} if is_module else {"LD_LIBRARY_PATH": str(package / "libs")})
        told = subprocess.run(["ldd", module], env=environment, capture_output=True, text=True, check=True).stdout
        outside = [line.split()[0] for line in told.splitlines() if str(package) not in line]
        assert [name for name in outside if not SYSTEM.search(name)] == [], module.name
        assert "cholmod" not in told


def test_it_has_the_bits_of_the_build(venv, tmp_path, scene):
    scene.save(tmp_path / "scene.xml")
    (tmp_path / "quad.dae").write_text(DAE)
    done = venv("-c", """
import pathlib, numpy as np, pliant
print(pathlib.Path(pliant.__file__).parent)
print(pliant.read_mesh("quad.dae"))
np.save("a.npy", pliant.Simulation(pliant.load("scene.xml")).positions())
assert "<iframe" in pliant.Simulation(pliant.load("scene.xml"))._repr_html_()
""", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [str(venv.site / "pliant"), "<pliant.Mesh of 4 vertices, 1 faces>"]
    assert (np.load(tmp_path / "a.npy") == pliant.Simulation(scene).positions()).all()


def test_it_reads_meshes_by_its_own_libraries(venv, tmp_path):
    shutil.copytree(venv.site / "pliant", tmp_path / "pliant")
    (tmp_path / "quad.dae").write_text(DAE)
    library = next((tmp_path / "pliant/libs").glob("libassimp.so.*[0-9]"))
    code = "import pliant; print(pliant.__file__, pliant.read_mesh('quad.dae'))"
    assert "4 vertices" in venv("-c", code, cwd=tmp_path, check=True).stdout
    library.write_bytes(b"no library")
    assert "pliant.Unreadable" in venv("-c", code, cwd=tmp_path).stderr.replace("_errors.", "")


def test_pip_takes_it_away_again(venv):
    done = venv("-m", "pip", "uninstall", "-y", "pliant")
    assert done.returncode == 0, done.stderr
    assert not list(venv.site.glob("pliant*"))
