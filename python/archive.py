"""Archives that are the same for the same files: what wheels and the add-on are made with."""

import zipfile


def files_of(folder):
    """All files of a folder: their names in it, and their bytes."""
    found = {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    return dict(sorted(found.items()))


def write_archive(out, files):
    """Writes a .zip of NAME → bytes, in this order, without their times. Libraries may be executed."""
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if ".so" in name and not name.endswith(".txt") else 0o100644) << 16
            archive.writestr(entry, data)
