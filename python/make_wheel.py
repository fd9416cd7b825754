"""Makes a wheel of an installed package: usage make_wheel.py FOLDER LICENCE COPYRIGHT VERSION NUMPY OUT

FOLDER is what `cmake --install BUILD --component python --prefix FOLDER` has filled, NUMPY what NumPy it
needs, such as ">=1.21". The wheel is for the Python that runs this. Prints its name.
"""

import base64
import hashlib
import importlib.machinery
import pathlib
import re
import sys
import sysconfig

from archive import files_of, write_archive

METADATA = """Metadata-Version: 2.1
Name: pliant
Version: {version}
Summary: Multi-force elastic animation: scenes in, surfaces that bulge, ring and settle out
License: Apache-2.0
License-File: LICENSE
License-File: copyright
Classifier: License :: OSI Approved :: Apache Software License
Classifier: Operating System :: POSIX :: Linux
Classifier: Programming Language :: Python :: 3
Classifier: Topic :: Multimedia :: Graphics :: 3D Modeling
Requires-Python: >=3.9
Requires-Dist: numpy{numpy}
"""
WHEEL = """Wheel-Version: 1.0
Generator: pliant ({version})
Root-Is-Purelib: false
Tag: {tag}
"""


def main():
    folder, licence, copyright_file, version, numpy, out = sys.argv[1:]
    root, out = pathlib.Path(folder), pathlib.Path(out)
    # An extension module is for one version and one ABI of one implementation.
    suffix = importlib.machinery.EXTENSION_SUFFIXES[0]
    found = re.fullmatch(r"\.cpython-(\d+)-.*\.so", suffix)
    if not found:
        raise SystemExit(f"make_wheel.py: a wheel is for CPython, not for modules named {suffix}")
    python = f"cp{found[1]}"
    tag = f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"
    files = files_of(root)
    if f"pliant/_core{suffix}" not in files:
        raise SystemExit(f"make_wheel.py: {folder} has no pliant/_core{suffix}")
    info = f"pliant-{version}.dist-info"
    facts = {"version": version, "tag": tag, "numpy": numpy}
    files[f"{info}/LICENSE"] = pathlib.Path(licence).read_bytes()
    files[f"{info}/copyright"] = pathlib.Path(copyright_file).read_bytes()
    files[f"{info}/METADATA"] = METADATA.format(**facts).encode()
    files[f"{info}/WHEEL"] = WHEEL.format(**facts).encode()
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    wheel = out / f"pliant-{version}-{tag}.whl"
    for old in out.glob("pliant-*.whl"):
        old.unlink()
    write_archive(wheel, files)
    print(wheel)


main()
