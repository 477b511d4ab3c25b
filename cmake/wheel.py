"""wheel.py ARCHIVE OUT: packs the archive of cmake/tarball.sh once more, into the folder OUT: as a wheel for pip, with the programs
as console scripts and the module of tools/python, and as Blender's extension with that wheel in it. The wheel asks for the C
library of this machine or a later one. The same archive gives the same bytes."""
import base64
import hashlib
import os
import platform
import sys
import tarfile
import time
import zipfile
from pathlib import Path

SOURCES = Path(__file__).resolve().parent.parent
MODULE = [SOURCES / "tools/python/tdpt/__init__.py", SOURCES / "tools/python/tdpt/py.typed",
          SOURCES / "tools/blender/tdpt/exr.py", SOURCES / "tools/blender/tdpt/gltf_file.py"]
METADATA = """\
Metadata-Version: 2.1
Name: tdpt-render
Version: {version}
Summary: Finds the doors and windows that light comes through, and renders through them
License: GPL-3.0-or-later
Description-Content-Type: text/markdown
Requires-Python: >=3.9
Provides-Extra: numpy
Requires-Dist: numpy; extra == "numpy"
Classifier: Operating System :: POSIX :: Linux
Classifier: Topic :: Multimedia :: Graphics :: 3D Rendering

The command-line programs of tdpt with their libraries, and a Python module over them. tdpt/share/man has their manuals,
tdpt/share/doc the licences of the libraries.

    pip install tdpt-render[numpy]
    tdpt room.glb -o room.exr --time 60 --preview

{words}
"""
TAGS = "Wheel-Version: 1.0\nGenerator: cmake/wheel.py\nRoot-Is-Purelib: true\nTag: {tag}\n"


def write(path, files, date):
    """A zip of {name: (mode, bytes)}, whole or not at all."""
    with zipfile.ZipFile(f"{path}.new", "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
        for name, (mode, data) in files.items():
            info = zipfile.ZipInfo(name, date)
            info.create_system, info.external_attr, info.compress_type = 3, (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
            if name.endswith(".whl"):
                info.compress_type = zipfile.ZIP_STORED
            out.writestr(info, data)
    os.replace(f"{path}.new", path)
    print(path)


def read(archive):
    """({name without the top folder: (mode, bytes)}, version, time of the commit) of the archive."""
    with tarfile.open(archive) as tar:
        members = [member for member in tar if not member.isdir()]
        files = {m.name.partition("/")[2]: (m.mode, tar.extractfile(m).read()) for m in members}  # links are followed
        return files, members[0].name.split("-")[1], time.gmtime(members[0].mtime)[:6]


def record(files, info):
    lines = []
    for name, (_, data) in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")
        lines.append(f"{name},sha256={digest},{len(data)}")
    return "\n".join([*lines, f"{info}/RECORD,,", ""])


def wheel(archive, version, tag):
    """The files of the wheel: the archive is inside of the package, so that programs find what is beside them."""
    names = sorted(name[4:] for name in archive if name.startswith("bin/"))
    files = {f"tdpt/{path.name}": (0o644, path.read_bytes()) for path in MODULE}
    files.update((f"tdpt/{name}", file) for name, file in archive.items())
    head = MODULE[0].read_text(encoding="utf-8").split('"""')[1]
    info = f"tdpt_render-{version}.dist-info"
    texts = {
        "METADATA": METADATA.format(version=version, words=head),
        "WHEEL": TAGS.format(tag=tag),
        "entry_points.txt": "\n".join(["[console_scripts]", *(f"{name} = tdpt:main" for name in names), ""]),
        "licenses/LICENSE": (SOURCES / "LICENSE").read_text(encoding="utf-8"),
    }
    files.update((f"{info}/{name}", (0o644, text.encode())) for name, text in texts.items())
    files[f"{info}/RECORD"] = (0o644, record(files, info).encode())
    return files


def extension(archive, whl, system):
    """The files of the extension, with the wheel and its platform in the manifest."""
    files = {name.partition("blender/")[2]: file for name, file in archive.items() if name.startswith("share/tdpt/blender/tdpt/")}
    mode, manifest = files["tdpt/blender_manifest.toml"]
    named = f'platforms = ["{system}"]\nwheels = ["./wheels/{whl.name}"]\n\n[permissions]'.encode()
    files["tdpt/blender_manifest.toml"] = (mode, manifest.replace(b"\n[permissions]", named))
    return {**files, f"tdpt/wheels/{whl.name}": (0o644, whl.read_bytes())}


def main(archive, out):
    content, version, date = read(archive)
    machine = platform.machine()
    libc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
    tag = f"py3-none-manylinux_{libc}_{machine}"
    for old in [*Path(out).glob("tdpt_render-*.whl"), *Path(out).glob("tdpt-blender-*.zip")]:
        old.unlink()
    whl = Path(out) / f"tdpt_render-{version}-{tag}.whl"
    write(whl, wheel(content, version, tag), date)
    system = f"linux-{ {'x86_64': 'x64', 'aarch64': 'arm64'}.get(machine, machine)}"
    write(Path(out) / f"tdpt-blender-{version}-{system}.zip", extension(content, whl, system), date)


main(*sys.argv[1:])
