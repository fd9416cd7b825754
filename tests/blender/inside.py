"""Runs inside Blender: the tests of one file. usage: blender -b -P inside.py -- FILE [CLASS[.TEST]…]

The add-on is enabled first. `FILE` has unittest cases. Exits with 1 if one fails. With a window they run in a
thread, since Blender goes on, and call Blender through window_test.py's `do`.
"""

import importlib.util
import os
import sys
import threading
import traceback
import unittest

import addon_utils
import bpy


def complain(_error: Exception) -> None:
    traceback.print_exc()
    os._exit(1)


def main() -> None:
    file, *names = sys.argv[sys.argv.index("--") + 1 :]
    sys.path.insert(0, os.path.dirname(os.path.abspath(file)))
    addon_utils.enable("pliant_blender", handle_error=complain)
    spec = importlib.util.spec_from_file_location(os.path.basename(file)[:-3], file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    loader = unittest.defaultTestLoader
    suite = loader.loadTestsFromNames(names, module) if names else loader.loadTestsFromModule(module)

    def run() -> None:
        result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
        sys.stdout.flush()
        os._exit(0 if result.wasSuccessful() and result.testsRun else 1)  # Blender's own exit can take its time

    if bpy.app.background:
        run()
    else:  # the window needs this thread
        threading.Thread(target=run, daemon=True).start()


main()
