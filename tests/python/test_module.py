"""The module as a whole: its names, the types that editors and mypy see, and what it needs."""

import ast
import inspect
import pathlib
import re
import subprocess
import sys

import pytest

import pliant
from pliant import _core

pytestmark = pytest.mark.no_sanitizer
package = pathlib.Path(pliant.__file__).parent
here = pathlib.Path(__file__).parent


def mypy(folder, *arguments):
    """Its lines, without notes."""
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--python-version", "3.9",
         "--cache-dir", str(folder), *arguments],
        capture_output=True, text=True, env={"MYPYPATH": str(package.parent), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert not done.stderr, done.stderr
    return [line for line in done.stdout.splitlines() if ": note: " not in line]


def test_mypy_accepts_the_module_and_refuses_what_it_refuses(tmp_path):
    assert mypy(tmp_path, "-p", "pliant") == []
    examples = sorted((here.parents[1] / "examples/python").glob("*.py"))
    assert examples and mypy(tmp_path, *map(str, examples)) == []
    lines = mypy(tmp_path, str(here / "typed_use.py"))
    told = {int(re.search(r"typed_use\.py:(\d+): error", line)[1]) for line in lines}
    text = (here / "typed_use.py").read_text(encoding="utf-8").splitlines()
    expected = {number for number, line in enumerate(text, 1) if line.endswith("# refused")}
    assert len(expected) > 5
    assert told == expected, "\n".join(lines)


def stub_of(name):
    return ast.parse((package / f"{name}.pyi").read_text(encoding="utf-8")).body


def arguments_of(function):
    """Names as pybind11 tells them, with * where only names are taken."""
    arguments = function.args
    names = [each.arg for each in arguments.args]
    return names + ["*"] * bool(arguments.kwonlyargs) + [each.arg for each in arguments.kwonlyargs]


def told_arguments(docstring):
    """Of the first line of a docstring by pybind11."""
    inside = docstring.split("(", 1)[1].split(") ->")[0]
    pieces = re.sub(r"\[[^\]]*\]|\{[^}]*\}", "", inside).split(", ")
    return [piece.split(":")[0].split("=")[0].strip() for piece in pieces if piece]


def test_each_name_of_the_core_is_in_its_stub_with_its_arguments():
    stubs = {each.name: each for each in stub_of("_core") if isinstance(each, (ast.ClassDef, ast.FunctionDef))}
    values = {name: value for name, value in vars(_core).items() if not name.startswith("__") and name != "version"}
    assert set(stubs) == set(values)
    compared = 0
    for name, value in values.items():
        if not inspect.isclass(value):
            continue
        members = {each.name: each for each in stubs[name].body if isinstance(each, ast.FunctionDef)}
        own = {key for key, member in vars(value).items() if not key.startswith("__")}
        if issubclass(value, pliant.Frame):
            own -= {"keys", "values", "items", "get"}  # of Mapping
        assert own == {key for key in members if not key.startswith("__")}, name
        for key, stub in members.items():
            member = vars(value)[key]
            is_property = any(getattr(each, "id", "") == "property" for each in stub.decorator_list)
            assert isinstance(member, property) == is_property, f"{name}.{key}"
            told = (member.__doc__ or "").split("\n")[0]
            if "(self" in told and "arg0" not in told and not stub.args.posonlyargs:
                if any(getattr(each, "id", "") == "overload" for each in stub.decorator_list):
                    continue
                assert arguments_of(stub) == told_arguments(told), f"{name}.{key}"
                compared += 1
    assert compared > 25


def test_each_attribute_and_operation_has_its_type():
    parts = {each.name: each for each in stub_of("_parts") if isinstance(each, ast.ClassDef)}
    kinds = [each for each in vars(pliant).values() if inspect.isclass(each) and getattr(each, "_rows", None)]
    assert len(kinds) > 20
    for kind in kinds:
        stub = parts["SceneParts" if kind is pliant.Scene else kind.__name__]
        names = {each.target.id for each in stub.body if isinstance(each, ast.AnnAssign)}
        assert names == set(kind._rows), kind
        made = next(each for each in stub.body if isinstance(each, ast.FunctionDef))
        assert arguments_of(made)[1:] == [
            *kind._positional, "*", *(name for name in kind._rows if name not in kind._positional)
        ] or not set(kind._rows) - set(kind._positional), kind  # fmt: skip
    operations = {each.name: each for each in stub_of("edit") if isinstance(each, ast.ClassDef)}
    for name in pliant.edit.__all__[1:]:
        made = next(each for each in operations[name].body if isinstance(each, ast.FunctionDef))
        signature = inspect.signature(getattr(pliant.edit, name))
        assert arguments_of(made)[1:] == list(signature.parameters), name


def test_all_names_are_listed():
    public = {name for name, value in vars(pliant).items() if not name.startswith("_")}
    assert set(pliant.__all__) == public and len(set(pliant.__all__)) == len(pliant.__all__)
    assert {name for name in vars(pliant.edit) if not name.startswith("_")} == set(pliant.edit.__all__)


@pytest.mark.parametrize("version, is_taken", [("1.21.0", True), ("2.0.0rc1", False), ("2.1", False), ("10.0", False)])
def test_a_numpy_that_it_cannot_use_is_refused(tmp_path, version, is_taken):
    (tmp_path / "numpy.py").write_text(f"__version__ = {version!r}\n")
    code = f"import sys; sys.path.insert(0, {str(package)!r}); import _core"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    if is_taken:
        assert done.returncode == 0, done.stderr
    else:
        assert f"ImportError: this build of pliant" in done.stderr and f"NumPy {version}" in done.stderr


def test_importing_it_imports_numpy_and_little_else():
    code = "import sys, numpy; before = set(sys.modules); import pliant; print(*set(sys.modules) - before)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    more = {name.split(".")[0] for name in done.stdout.split()}
    assert {"pliant"} <= more <= {"pliant", *sys.stdlib_module_names, *sys.builtin_module_names}


def test_an_object_that_was_not_initialised_is_refused():
    kinds = [kind for kind in vars(_core).values() if inspect.isclass(kind)]
    assert len(kinds) > 8
    for kind in kinds:
        made = kind.__new__(kind)
        for name, member in vars(kind).items():
            if isinstance(member, property):
                with pytest.raises(TypeError):
                    getattr(made, name)
        for call in (repr, len, iter):
            if f"__{call.__name__}__" in vars(kind):
                with pytest.raises(TypeError):
                    call(made)


def test_the_code_of_the_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (here.parents[1] / "docs/python.md").read_text(encoding="utf-8")
    code = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(code) == 1
    names = {}
    exec(code[0], names)
    assert names["frames"].shape == (48, 3721, 3)
    assert pliant.load("poke.xml") == names["scene"]
