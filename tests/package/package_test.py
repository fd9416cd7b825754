"""Makes the packages of a build, checks them and runs the command of each.

usage: package_test.py BUILD [DEBIAN]

cpack makes the .deb and the .tar.gz of the folder BUILD. The test checks their contents, unpacks
both into scratch folders, runs the command there, and builds tests/consumer against the .tar.gz.

DEBIAN is a bare Debian as debootstrap makes it, whose apt sources can be reached; this needs root.
The test copies it and, in the copy, installs the .deb by apt-get, runs the command, installs the
build dependencies among the suggested packages, builds tests/consumer and removes the package.

Requires `script/bootstrap --package`. Ends with the line "N passed, N failed".
"""

import gzip
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = None
DEBIAN = None

# Set by setUpModule: a scratch folder; the two packages; the folders that they unpack to.
SCRATCH = DEB = TARBALL = DEB_ROOT = TARBALL_ROOT = None

# Files that must be in both packages, relative to the folder of installation.
CONTENTS = """
bin/pliant
include/pliant/core/result.hpp
include/pliant/forces/force.hpp
include/pliant/files/writer.hpp
include/pliant/pliant.hpp
include/pliant/replay/expect_replay.hpp
include/pliant/timeline/curve.hpp
include/pliant/timeline/edit/edit.hpp
lib/cmake/pliant/FindSleef.cmake
lib/cmake/pliant/FindxxHash.cmake
lib/cmake/pliant/PliantReplayTest.cmake
lib/cmake/pliant/pliant-config-version.cmake
lib/cmake/pliant/pliant-config.cmake
lib/cmake/pliant/pliant-targets.cmake
lib/libpliant_core.a
lib/libpliant_forces.a
lib/libpliant_files.a
lib/libpliant_mesh.a
lib/libpliant_plate.a
lib/libpliant_replay.a
lib/libpliant_simulation.a
lib/libpliant_timeline.a
lib/libpliant_timeline_edit.a
share/bash-completion/completions/pliant
share/doc/pliant/CHANGELOG.md
share/doc/pliant/LICENSE
share/doc/pliant/README.md
share/doc/pliant/changelog.gz
share/doc/pliant/copyright
share/doc/pliant/docs/README.md
share/doc/pliant/docs/command.md
share/doc/pliant/docs/images/viewer.png
share/doc/pliant/docs/pliant-scene.xsd
share/doc/pliant/docs/scene-format.md
share/doc/pliant/examples/head.obj
share/doc/pliant/examples/sheet.xml
share/doc/pliant/examples/thesis/fig08-force.xml
share/fish/vendor_completions.d/pliant.fish
share/pliant/pliant-scene.xsd
share/pliant/viewer.html
""".split()
ZSH = {"deb": "share/zsh/vendor-completions/_pliant", "tar.gz": "share/zsh/site-functions/_pliant"}
EXAMPLE = "share/doc/pliant/examples/sheet.xml"

FROM_COLLADA = """<scene version="1" start="1" end="3">
  <surface name="cloth"><mesh file="cloth.dae"/></surface>
  <point name="poke" center="2 0 2" deformationRadius="1.5" forceRadius="1.2" magnitude="50"/>
</scene>
"""


def collada(side):
    """A Collada file of a flat grid with side x side vertices, which only assimp reads."""
    nodes = [(i, j) for j in range(side) for i in range(side)]
    quads = [(j * side + i, (j + 1) * side + i, (j + 1) * side + i + 1, j * side + i + 1)
             for j in range(side - 1) for i in range(side - 1)]

    def source(name, rows, axes):
        numbers = " ".join(str(number) for row in rows for number in row)
        params = "".join(f'<param name="{axis}" type="float"/>' for axis in axes)
        return (f'<source id="{name}"><float_array id="{name}a" count="{len(rows) * len(axes)}">'
                f'{numbers}</float_array><technique_common><accessor source="#{name}a" '
                f'count="{len(rows)}" stride="{len(axes)}">{params}</accessor></technique_common>'
                "</source>")

    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g" name="cloth"><mesh>
{source("p", [(i, 0, j) for i, j in nodes], "XYZ")}
{source("t", [(i / (side - 1), j / (side - 1)) for i, j in nodes], "ST")}
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="{len(quads)}"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#t" offset="0" set="0"/>
<vcount>{" ".join("4" for _ in quads)}</vcount>
<p>{" ".join(str(corner) for quad in quads for corner in quad)}</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="cloth">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


def run(*words, **options):
    """Standard output of a program; if it fails, an error with its whole output."""
    ended = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                           check=False, **options)
    if ended.returncode != 0:
        output = ended.stdout + ended.stderr
        raise AssertionError(f"{' '.join(words)}: exit {ended.returncode}\n{output}")
    return ended.stdout


def cached(variable):
    """A variable of the build's CMake cache."""
    with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as cache:
        return re.search(rf"^{variable}:\w+=(.*)$", cache.read(), re.M)[1]


def files_below(root):
    """Path and content hash of each file below a folder, by paths relative to it."""
    found = {}
    for folder, _, names in os.walk(root):
        for name in names:
            path = os.path.join(folder, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, root)] = hashlib.sha256(file.read()).hexdigest()
    return found


def control(field):
    return run("dpkg-deb", "-f", DEB, field).strip()


def packages_of(field):
    """The names of packages in a field of the .deb such as Depends."""
    return [entry.split()[0] for entry in control(field).split(",")]


def setUpModule():
    global SCRATCH, DEB, TARBALL, DEB_ROOT, TARBALL_ROOT
    SCRATCH = tempfile.mkdtemp(prefix="pliant-package-")
    unittest.addModuleCleanup(shutil.rmtree, SCRATCH)
    begin = time.monotonic()
    made = run("cpack", "--config", os.path.join(BUILD, "CPackConfig.cmake"), cwd=SCRATCH)
    packages = re.findall(r"^CPack: - package: (.*) generated\.$", made, re.M)
    DEB = next(path for path in packages if path.endswith(".deb"))
    TARBALL = next(path for path in packages if path.endswith(".tar.gz"))
    for path in packages:
        print(f"{path}: {os.path.getsize(path) / 1e6:.2f} MB", file=sys.stderr)
    print(f"both made in {time.monotonic() - begin:.1f} s", file=sys.stderr)

    run("dpkg-deb", "-x", DEB, os.path.join(SCRATCH, "deb"))
    DEB_ROOT = os.path.join(SCRATCH, "deb", "usr")
    # The command and the CMake package must work in any folder, even with a blank in its name.
    anywhere = os.path.join(SCRATCH, "any where")
    os.mkdir(anywhere)
    run("tar", "-xzf", TARBALL, "-C", anywhere)
    TARBALL_ROOT = os.path.join(anywhere, os.path.basename(TARBALL)[:-len(".tar.gz")])


class Contents(unittest.TestCase):
    def test_names_have_version_and_architecture(self):
        version = cached("CMAKE_PROJECT_VERSION")
        debian = run("dpkg", "--print-architecture").strip()
        self.assertEqual(os.path.basename(DEB), f"pliant_{version}_{debian}.deb")
        self.assertEqual(os.path.basename(TARBALL),
                         f"pliant-{version}-Linux-{os.uname().machine}.tar.gz")

    def test_every_part_is_there(self):
        for kind, root in (("deb", DEB_ROOT), ("tar.gz", TARBALL_ROOT)):
            files = files_below(root)
            for path in CONTENTS + [ZSH[kind]]:
                with self.subTest(kind, path=path):
                    self.assertIn(path, files)

    def test_every_document_and_example_of_the_source_is_there(self):
        files = files_below(os.path.join(TARBALL_ROOT, "share/doc/pliant"))
        for folder in ("docs", "examples"):
            for path in files_below(os.path.join(SOURCE, folder)):
                # Of the examples all: scenes name meshes of several formats, documents name scripts.
                is_example = folder == "examples" and "__pycache__" not in path
                if is_example or path.endswith((".md", ".png", ".svg", ".xml", ".obj", ".pc2")):
                    with self.subTest(f"{folder}/{path}"):
                        self.assertIn(f"{folder}/{path}", files)

    def test_both_packages_have_the_same_files(self):
        deb, tarball = files_below(DEB_ROOT), files_below(TARBALL_ROOT)
        self.assertEqual(deb.pop(ZSH["deb"]), tarball.pop(ZSH["tar.gz"]))
        self.assertEqual(deb, tarball)

    def test_nothing_is_outside_usr(self):
        self.assertEqual(os.listdir(os.path.join(SCRATCH, "deb")), ["usr"])

    def test_files_belong_to_root_and_all_may_read_them(self):
        for line in run("dpkg-deb", "-c", DEB).splitlines():
            mode, owner = line.split()[:2]
            with self.subTest(line):
                self.assertEqual(owner, "root/root")
                is_program = mode[0] == "d" or line.endswith("/usr/bin/pliant")
                self.assertEqual(mode[1:], "rwxr-xr-x" if is_program else "rw-r--r--")

    def test_the_command_is_stripped(self):
        self.assertNotIn(".symtab", run("readelf", "-SW", os.path.join(DEB_ROOT, "bin/pliant")))

    def test_the_cmake_package_names_no_folder_of_the_build(self):
        folder = os.path.join(TARBALL_ROOT, "lib/cmake/pliant")
        for name in os.listdir(folder):
            with self.subTest(name), open(os.path.join(folder, name), encoding="utf-8") as file:
                text = file.read()
                self.assertNotIn(SOURCE, text)
                self.assertNotIn(BUILD, text)

    def test_documents_link_to_files_of_the_package(self):
        root = os.path.join(TARBALL_ROOT, "share/doc/pliant")
        for path in files_below(root):
            if not path.endswith(".md"):
                continue
            with open(os.path.join(root, path), encoding="utf-8") as file:
                links = re.findall(r"\]\(([^)#\s]+)", file.read())
            for link in links:
                if not link.startswith("http"):
                    with self.subTest(path, link=link):
                        target = os.path.join(root, os.path.dirname(path), link)
                        self.assertTrue(os.path.exists(target))

    def test_the_changelog_is_the_compressed_one(self):
        folder = os.path.join(DEB_ROOT, "share/doc/pliant")
        with gzip.open(os.path.join(folder, "changelog.gz"), "rt", encoding="utf-8") as short, \
                open(os.path.join(folder, "CHANGELOG.md"), encoding="utf-8") as plain:
            self.assertEqual(short.read(), plain.read())

    def test_the_copyright_file_states_the_licence_of_the_binary(self):
        with open(os.path.join(DEB_ROOT, "share/doc/pliant/copyright"), encoding="utf-8") as file:
            text = file.read()
        paragraphs = text.split("\n\n")
        self.assertTrue(text.startswith("Format: https://www.debian.org/doc/packaging-manuals/"))
        self.assertNotIn("@", text)
        has_cholmod = cached("PLIANT_WITH_CHOLMOD") == "ON"
        self.assertIn(f"\nLicense: {'GPL-3+' if has_cholmod else 'Apache-2.0'}", paragraphs[0])
        self.assertEqual("libcholmod" in text, has_cholmod)
        self.assertEqual("(OpenSubdiv)" in text, cached("PLIANT_WITH_OPENSUBDIV") == "ON")
        # Every licence that a paragraph of files names has a paragraph of its own.
        explained = {re.match(r"License: (\S+)\n ", paragraph)[1]
                     for paragraph in paragraphs if paragraph.startswith("License:")}
        for paragraph in paragraphs:
            if paragraph.startswith("Files:"):
                names = re.search(r"^License: (.*)$", paragraph, re.M)[1].split(" and ")
                self.assertLessEqual(set(names), explained)


class Control(unittest.TestCase):
    def test_depends_on_the_libraries_of_the_command_and_of_its_mesh_reader(self):
        depends = " ".join(packages_of("Depends"))
        expected = ["libc6", "libstdc", "libfmt", "libsleef", "libxxhash", "zlib1g", "libassimp"]
        if cached("PLIANT_WITH_CHOLMOD") == "ON":
            expected.append("libcholmod")
        if cached("PLIANT_WITH_OPENSUBDIV") == "ON":
            expected.append("libosdcpu")
        if cached("PLIANT_WITH_SECCOMP") == "ON":
            expected.append("libseccomp")
        for library in expected:
            with self.subTest(library):
                self.assertIn(library, depends)
        self.assertNotIn("-dev", depends)
        self.assertEqual(len(packages_of("Depends")), len(set(packages_of("Depends"))))

    def test_suggests_the_build_dependencies_of_programs(self):
        suggests = packages_of("Suggests")
        for package in ("cmake", "g++", "libeigen3-dev", "libexpected-dev", "libfmt-dev",
                        "libsleef-dev", "libxxhash-dev"):
            with self.subTest(package):
                self.assertIn(package, suggests)
        self.assertEqual("libsuitesparse-dev" in suggests, cached("PLIANT_WITH_CHOLMOD") == "ON")
        self.assertEqual("libosd-dev" in suggests, cached("PLIANT_WITH_OPENSUBDIV") == "ON")

    def test_has_name_version_section_and_description(self):
        self.assertEqual(control("Package"), "pliant")
        self.assertEqual(control("Version"), cached("CMAKE_PROJECT_VERSION"))
        self.assertEqual(control("Section"), "graphics")
        self.assertRegex(control("Maintainer"), r"^.+ <\S+@\S+>$")
        self.assertIn("elastic", control("Description").splitlines()[0])


class WithoutViewer(unittest.TestCase):
    def test_there_is_no_package_without_the_viewer_page(self):
        for generator, prefix in (("DEB", "/usr"), ("TGZ", "/")):
            with self.subTest(generator):
                ended = subprocess.run(
                    ["cmake", f"-DCPACK_GENERATOR={generator}",
                     f"-DCPACK_TEMPORARY_INSTALL_DIRECTORY={SCRATCH}/none",
                     f"-DCPACK_PACKAGING_INSTALL_PREFIX={prefix}",
                     "-P", f"{SOURCE}/cmake/FinishPackage.cmake"],
                    capture_output=True, text=True, check=False)
                self.assertNotEqual(ended.returncode, 0)
                message = " ".join(ended.stderr.split())
                self.assertIn("no package without the viewer's page", message)


class Installed:
    """Tests of an installed pliant. Subclasses define `root`, the folder of installation, and
    `call`, which runs a program there. Test files are in the folder `work`; programs see it as
    `inside`.
    """

    def pliant(self, *words):
        return self.call(self.root + "/bin/pliant", *words)

    def read(self, name):
        with open(os.path.join(self.work, name), "rb") as file:
            return file.read()

    def test_version(self):
        self.assertIn(cached("CMAKE_PROJECT_VERSION"), self.pliant("--version"))

    def test_bakes_an_example_to_obj_and_glb(self):
        example = f"{self.root}/{EXAMPLE}"
        self.pliant("bake", example, "--frames", "1:3", "-o", f"{self.inside}/sheet.obj", "--quiet")
        self.assertEqual(len(re.findall(rb"^v ", self.read("sheet.0003.obj"), re.M)), 61 * 61)
        self.assertNotEqual(self.read("sheet.0003.obj"), self.read("sheet.0001.obj"))
        self.pliant("bake", example, "--frames", "1:3", "-o", f"{self.inside}/sheet.glb", "--quiet")
        self.assertEqual(self.read("sheet.glb")[:4], b"glTF")

    def test_finds_the_mesh_of_an_example(self):
        self.pliant("validate", f"{self.root}/share/doc/pliant/examples/travelling.xml")

    def test_writes_a_page(self):
        self.pliant("view", f"{self.root}/{EXAMPLE}", "--frames", "1:3",
                    "-o", f"{self.inside}/page.html", "--quiet")
        page = self.read("page.html")
        self.assertGreater(len(page), 500000)
        self.assertRegex(page, rb'<script id="bake" type="text/plain">[A-Za-z0-9+/]{1000}')

    def test_reads_collada_in_its_own_process(self):
        with open(os.path.join(self.work, "cloth.dae"), "w", encoding="utf-8") as file:
            file.write(collada(5))
        with open(os.path.join(self.work, "cloth.xml"), "w", encoding="utf-8") as file:
            file.write(FROM_COLLADA)
        self.pliant("bake", f"{self.inside}/cloth.xml", "-o", f"{self.inside}/cloth.obj", "--quiet")
        self.assertGreaterEqual(len(re.findall(rb"^v ", self.read("cloth.0003.obj"), re.M)), 25)

    def test_completes_a_word(self):
        self.assertIn("validate", self.pliant("__complete", "val"))

    def build_consumer(self, consumer, readme):
        """Another project that uses this installation, with its replay tests."""
        self.call("cmake", f"-DPREFIX={self.root}", f"-DSOURCE={consumer}", f"-DREADME={readme}",
                 f"-DWORK={self.inside}/consumer", "-DCOMPILER=c++", "-P", f"{consumer}/run.cmake")


class Unpacked(Installed):
    @classmethod
    def setUpClass(cls):
        cls.work = cls.inside = tempfile.mkdtemp(dir=SCRATCH)

    def call(self, *words):
        return run(*words)


class UnpackedDeb(Unpacked, unittest.TestCase):
    root = property(lambda self: DEB_ROOT)


class UnpackedTarball(Unpacked, unittest.TestCase):
    root = property(lambda self: TARBALL_ROOT)

    def test_another_project_finds_it(self):
        self.build_consumer(f"{SOURCE}/tests/consumer", f"{SOURCE}/README.md")


class InDebian(Installed, unittest.TestCase):
    """The tests run in the order of their names; the last one removes the package."""

    root = "/usr"
    inside = "/root/work"

    @classmethod
    def setUpClass(cls):
        if DEBIAN is None:
            raise unittest.SkipTest("no bare Debian is given")
        # A copy, so that the bare Debian stays bare.
        cls.debian = os.path.join(SCRATCH, "debian")
        run("cp", "-a", "--reflink=auto", DEBIAN, cls.debian)
        cls.work = cls.debian + cls.inside
        os.mkdir(cls.work)
        shutil.copy(DEB, f"{cls.work}/pliant.deb")
        shutil.copytree(f"{SOURCE}/tests/consumer", f"{cls.work}/tests")
        cls.enter("apt-get", "update", "-qq")
        begin = time.monotonic()
        cls.enter("apt-get", "install", "-y", "--no-install-recommends", f"{cls.inside}/pliant.deb")
        print(f"installed by apt-get in {time.monotonic() - begin:.1f} s", file=sys.stderr)

    @classmethod
    def enter(cls, *words):
        # The mounts are in a namespace of the process and disappear with it.
        proxies = [f"{name}={value}" for name, value in os.environ.items()
                   if re.fullmatch("(https?|no)_proxy", name, re.I)]
        return run("unshare", "--mount", "sh", "-c",
                   'mount -t proc proc "$1/proc" && mount --bind /dev "$1/dev" && shift && '
                   'exec env -i "$@"',
                   "sh", cls.debian, *proxies,
                   "HOME=/root", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LANG=C.UTF-8",
                   "DEBIAN_FRONTEND=noninteractive", "chroot", cls.debian, *words)

    def call(self, *words):
        return self.enter(*words)

    def test_it_was_bare(self):
        for program in ("pliant", "c++", "cmake"):
            self.assertFalse(os.path.exists(f"{DEBIAN}/usr/bin/{program}"), program)

    def test_completion_is_where_the_shells_look(self):
        for path in ("share/bash-completion/completions/pliant", ZSH["deb"],
                     "share/fish/vendor_completions.d/pliant.fish"):
            with self.subTest(path):
                self.assertTrue(os.path.exists(f"{self.debian}/usr/{path}"))

    def test_installed_files_are_as_packed(self):
        self.assertEqual(self.call("dpkg", "--verify", "pliant"), "")

    def test_yy_another_project_finds_it(self):
        packages = [name for name in packages_of("Suggests")
                    if name in ("cmake", "g++") or name.endswith("-dev")]
        self.call("apt-get", "install", "-y", "--no-install-recommends", "ninja-build", *packages)
        self.build_consumer(f"{self.inside}/tests", "/usr/share/doc/pliant/README.md")

    def test_zz_is_removed_without_a_trace(self):
        files = [f"usr/{path}" for path in files_below(DEB_ROOT)]
        self.call("dpkg", "--purge", "pliant")
        self.assertEqual([path for path in files if os.path.exists(f"{self.debian}/{path}")], [])
        self.assertFalse(os.path.exists(f"{self.debian}/usr/share/doc/pliant"))


def main():
    global BUILD, DEBIAN
    BUILD = os.path.abspath(sys.argv[1])
    classes = [Contents, Control, WithoutViewer, UnpackedDeb, UnpackedTarball]
    if len(sys.argv) > 2:
        DEBIAN = os.path.abspath(sys.argv[2])
        if os.geteuid() != 0:
            sys.exit("package_test: only root can install packages in a Debian of its own")
        classes.append(InDebian)
    suite = unittest.TestSuite(map(unittest.defaultTestLoader.loadTestsFromTestCase, classes))
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    # Several subtests of one test may fail. If setUpModule fails, no test runs: one failure.
    failed = len({str(getattr(test, "test_case", test))
                  for test, _ in result.failures + result.errors})
    print(f"{max(result.testsRun - failed, 0)} passed, {failed} failed")
    sys.exit(0 if failed == 0 and result.testsRun > 0 else 1)


if __name__ == "__main__":
    main()
