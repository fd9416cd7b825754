"""Checks that the sources agree with the table of rooms in docs/architecture.md, and that script/check_rooms
finds each kind of disagreement, in small made-up trees.

usage: rooms_test.py SOURCE_FOLDER
"""

import os
import subprocess
import sys
import tempfile

SOURCE = os.path.abspath(sys.argv[1])

PAGE = """\
    for each surface:
      ├─ shapes   a picture
      └─ body

| room | folder | contains | may use |
|---|---|---|---|
| core | lib/pliant/core | results | nothing |
| shapes | lib/pliant/shapes | shapes | core |
| shapes_edit | lib/pliant/shapes/edit | edits of shapes | shapes |
| body | lib/pliant/body | a body | shapes/box.hpp, core |
| cli | cli | the command | everything public |
| pages | pages | pages for programs | everything public |

| another | table |
"""

# Agrees with itself. shapes_edit includes core, which it may use through shapes.
TREE = {
    "docs/architecture.md": PAGE,
    "lib/CMakeLists.txt": "target_link_libraries(pliant INTERFACE pliant::body pliant::shapes_edit)\n",
    "docs/embedding.md": "Edits of shapes have a header of their own, `pliant/shapes/edit/edit.hpp`.\n",
    "lib/pliant/pliant.hpp": '#include "pliant/body/body.hpp"\n#include "pliant/shapes/ball.hpp"\n',
    "lib/pliant/core/CMakeLists.txt": "pliant_room(core LAYERS low high HEADERS core.hpp SOURCES core.cpp PUBLIC fmt::fmt)\n",
    "lib/pliant/core/core.hpp": "#include <vector>\n",
    "lib/pliant/core/core.cpp": '#include "pliant/core/core.hpp"\n#include "made_by_the_build.hpp"\n',
    "lib/pliant/core/secret.hpp": "",
    "lib/pliant/core/low/low.hpp": "",
    "lib/pliant/core/high/high.hpp": '#include "pliant/core/low/low.hpp"\n',
    "lib/pliant/shapes/CMakeLists.txt": "pliant_room(shapes  # a comment (pliant::cli)\n"
                                        "  HEADERS box.hpp ball.hpp\n  PUBLIC pliant::core)\n",
    "lib/pliant/shapes/box.hpp": '#include "pliant/core/core.hpp"\n',
    "lib/pliant/shapes/ball.hpp": "",
    "lib/pliant/shapes/edit/CMakeLists.txt": "pliant_room(shapes_edit HEADERS edit.hpp PRIVATE pliant::shapes)\n",
    "lib/pliant/shapes/edit/edit.hpp": "",
    "lib/pliant/shapes/edit/edit.cpp": '#include "pliant/shapes/ball.hpp"\n#include "pliant/core/core.hpp"\n',
    "lib/pliant/body/CMakeLists.txt": "pliant_room(body HEADERS body.hpp\n  PUBLIC pliant::shapes pliant::core)\n",
    "lib/pliant/body/body.hpp": '#include "pliant/shapes/box.hpp"\n#include "pliant/core/core.hpp"\n',
    "cli/CMakeLists.txt": "target_link_libraries(pliant_cli PRIVATE pliant::pliant)\n",
    "cli/main.cpp": '#include <pliant/pliant.hpp>\n#include "pliant/core/core.hpp"\n#include "usage.hpp"\n',
    "cli/terminal/usage.hpp": "",
    "pages/CMakeLists.txt": "pliant_room(pages HEADERS pliant/pages/page.hpp PUBLIC pliant::pliant)\n",
    "pages/pliant/pages/page.hpp": '#include "pliant/core/core.hpp"\n',
    "pages/pliant/pages/page.cpp": '#include "pliant/pages/page.hpp"\n#include "pages/json.hpp"\n',
    "pages/json.hpp": "",
}

# What is wrong: the file, its text replaced by another, and the only fault that this makes.
WRONG = [
    ("an include that the table does not allow", "lib/pliant/core/core.cpp", "<<end>>",
     '\n  #  include "pliant/shapes/ball.hpp"\n',
     "lib/pliant/core/core.cpp:4: includes shapes/ball.hpp, but by docs/architecture.md core may not use shapes"),
    ("an include in angle brackets", "lib/pliant/core/core.hpp", "<vector>", "<pliant/shapes/ball.hpp>",
     "lib/pliant/core/core.hpp:1: includes shapes/ball.hpp, but by docs/architecture.md core may not use shapes"),
    ("an include by a relative path", "lib/pliant/core/core.hpp", "<vector>", '"../shapes/ball.hpp"',
     "lib/pliant/core/core.hpp:1: includes shapes/ball.hpp, but by docs/architecture.md core may not use shapes"),
    ("a room that uses the one in its folder", "lib/pliant/shapes/ball.hpp", "<<end>>",
     '#include "pliant/shapes/edit/edit.hpp"\n',
     "lib/pliant/shapes/ball.hpp:1: includes shapes_edit/edit.hpp, but by docs/architecture.md shapes may not use "
     "shapes_edit"),
    ("another header than the one that the table allows", "lib/pliant/body/body.hpp", "<<end>>",
     '#include "pliant/shapes/ball.hpp"\n',
     "lib/pliant/body/body.hpp:3: includes shapes/ball.hpp, but by docs/architecture.md body may not use shapes"),
    ("a layer that includes one above it", "lib/pliant/core/low/low.hpp", "<<end>>",
     '#include "pliant/core/high/high.hpp"\n',
     "lib/pliant/core/low/low.hpp:1: includes high/high.hpp, of a layer above its own"),
    ("a private header in the command", "cli/main.cpp", "core.hpp", "secret.hpp",
     "cli/main.cpp:2: includes core/secret.hpp, which is not public"),
    ("a header that does not exist", "cli/main.cpp", "core/core.hpp", "core/cores.hpp",
     "cli/main.cpp:2: includes pliant/core/cores.hpp, which does not exist"),
    ("a public header that no program needs", "docs/embedding.md", "`pliant/shapes/edit/edit.hpp`", "it",
     "lib/pliant/shapes/edit/CMakeLists.txt:1: edit.hpp is public, but no program needs it"),
    ("an internal header in a public one", "lib/pliant/core/core.hpp", "<vector>", '"pliant/core/secret.hpp"',
     "lib/pliant/core/core.hpp:1: a public header includes secret.hpp, which is not public"),
    ("an arrow that is missing", "docs/architecture.md", "| shapes/box.hpp, core |", "| core |",
     "lib/pliant/body/body.hpp:1: includes shapes/box.hpp, but by docs/architecture.md body may not use shapes",
     "lib/pliant/body/CMakeLists.txt:1: links shapes, but by docs/architecture.md body may not use it"),
    ("an arrow too many", "docs/architecture.md", "| shapes/box.hpp, core |", "| shapes/box.hpp, core, shapes_edit |",
     "docs/architecture.md:10: body may use shapes_edit, but does not"),
    ("a header too many", "docs/architecture.md", "shapes/box.hpp, core", "shapes/box.hpp, shapes/ball.hpp, core",
     "docs/architecture.md:10: body may use shapes/ball.hpp, but does not"),
    ("an unknown room", "docs/architecture.md", "| shapes/box.hpp, core |", "| shapes/box.hpp, core, solver |",
     "docs/architecture.md:10: body may use solver, which is not a room of a row above"),
    ("a room of a row below", "docs/architecture.md", "| nothing |", "| body |",
     "docs/architecture.md:7: core may use body, which is not a room of a row above"),
    ("a room twice", "docs/architecture.md", "| cli | cli |", "| core | cli |",
     "docs/architecture.md:11: the room core or its folder cli has two rows"),
    ("a folder that does not exist", "docs/architecture.md", "| cli | cli |", "| cli | lib/cli |",
     "docs/architecture.md:11: the folder lib/cli of cli does not exist",
     "docs/architecture.md:11: no CMakeLists.txt makes cli"),
    ("no table", "docs/architecture.md", "may use |\n", "uses |\n",
     "docs/architecture.md: there is no table with the columns room, folder, …, may use"),
    ("a picture with an unknown room", "docs/architecture.md", "└─ body", "└─ bodies",
     "docs/architecture.md:3: the picture names bodies, which is not a room of the table"),
    ("a picture in another order", "docs/architecture.md", "└─ body", "├─ body\n      └─ core",
     "docs/architecture.md:4: the table has core above body, the picture below"),
    ("a folder of no room", "lib/pliant/extra/extra.cpp", "<<end>>", "int extra;\n",
     "lib/pliant/extra/extra.cpp: its folder is of no room in docs/architecture.md"),
    ("a library that the table does not name", "lib/pliant/extra/CMakeLists.txt", "<<end>>", "\npliant_room(extra\n)\n",
     "lib/pliant/extra/CMakeLists.txt:2: makes the room extra, which is not in docs/architecture.md"),
    ("a library in another folder", "lib/pliant/shapes/edit/CMakeLists.txt", "pliant_room(shapes_edit ",
     "pliant_room(shapes PUBLIC pliant::core)\npliant_room(shapes_edit ",
     "lib/pliant/shapes/edit/CMakeLists.txt:1: makes the room shapes, whose folder is lib/pliant/shapes"),
    ("no library", "lib/pliant/shapes/edit/CMakeLists.txt", "pliant_room(shapes_edit HEADERS edit.hpp PRIVATE",
     "target_link_libraries(other PRIVATE", "docs/architecture.md:9: no CMakeLists.txt makes shapes_edit"),
    ("a link that the table does not allow", "lib/pliant/core/CMakeLists.txt", "PUBLIC",
     "PUBLIC $<BUILD_INTERFACE:pliant::shapes>",
     "lib/pliant/core/CMakeLists.txt:1: links shapes, but by docs/architecture.md core may not use it"),
    ("a link to everything", "lib/pliant/core/CMakeLists.txt", "PUBLIC", "PUBLIC pliant::pliant",
     "lib/pliant/core/CMakeLists.txt:1: links pliant::pliant, but by docs/architecture.md core may not use everything"),
    ("a link too many", "lib/pliant/body/body.hpp", '#include "pliant/core/core.hpp"\n', "",
     "docs/architecture.md:10: body may use core, but does not",
     "lib/pliant/body/CMakeLists.txt:1: links core, but does not include it"),
    ("a link that is missing", "lib/pliant/shapes/edit/CMakeLists.txt", "PRIVATE pliant::shapes", "",
     "lib/pliant/shapes/edit/CMakeLists.txt:1: includes core, but does not link it",
     "lib/pliant/shapes/edit/CMakeLists.txt:1: includes shapes, but does not link it"),
    ("a public link that only sources need", "lib/pliant/shapes/edit/CMakeLists.txt", "PRIVATE", "PUBLIC",
     "lib/pliant/shapes/edit/CMakeLists.txt:1: links shapes as PUBLIC, but no public header includes it"),
    ("a private link that a header needs", "lib/pliant/shapes/CMakeLists.txt", "PUBLIC", "PRIVATE",
     "lib/pliant/shapes/CMakeLists.txt:1: includes core in a public header, but links it as PRIVATE",
     "lib/pliant/shapes/edit/CMakeLists.txt:1: includes core, but does not link it"),
    ("an internal header in a public one for some programs", "pages/pliant/pages/page.hpp", "<<end>>",
     '#include "pages/json.hpp"\n',
     "pages/pliant/pages/page.hpp:2: a public header includes json.hpp, which is not public"),
    ("everything as a private link that a header needs", "pages/CMakeLists.txt", "PUBLIC", "PRIVATE",
     "pages/CMakeLists.txt:1: includes core in a public header, but links it as PRIVATE"),
    ("a library that programs do not get", "lib/CMakeLists.txt", " pliant::shapes_edit", "",
     "lib/pliant/shapes/edit/CMakeLists.txt:1: pliant::pliant does not link shapes_edit"),
]


def check(tree):
    """The faults that script/check_rooms finds in a tree, and its exit code."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in tree.items():
            path = os.path.join(folder, path)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        run = subprocess.run([sys.executable, os.path.join(SOURCE, "script/check_rooms"), folder],
                             stdout=subprocess.PIPE, encoding="utf-8", check=False)
        return run.stdout.splitlines(), run.returncode


def main():
    run = subprocess.run([sys.executable, os.path.join(SOURCE, "script/check_rooms"), SOURCE], stdout=subprocess.PIPE,
                         encoding="utf-8", check=False)
    assert (run.stdout, run.returncode) == ("", 0), run.stdout
    assert check(TREE) == ([], 0), check(TREE)
    for name, path, old, new, *faults in WRONG:
        text = TREE.get(path, "")
        changed = text + new if old == "<<end>>" else text.replace(old, new, 1)
        assert changed != text, name
        found, code = check(TREE | {path: changed})
        assert sorted(found) == sorted(faults) and code == 1, (name, found)
    print(f"ok {len(WRONG)} faults")


if __name__ == "__main__":
    main()
