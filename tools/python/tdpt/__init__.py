"""Finds the light portals of a glTF scene, and renders through them, by the programs of tdpt:

    import tdpt
    for portal in tdpt.find_portals("room.glb"):
        print(portal.name, portal.polygon)
    picture = tdpt.render("room.glb", time=60, denoise=True)
    open("portals.py", "w").write(tdpt.for_cycles("room.glb", environment="sky.exr"))

What follows the scene are options of tdpt(1): a word as it is typed, or by its name, as in look_from=(0, 1.6, 3), quality="draft".
Arrays need numpy."""
from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Sequence, Union

if TYPE_CHECKING:
    import numpy

File = Union[str, "os.PathLike[str]"]
_OWN = Path(__file__).parent / "bin"  # in a wheel


class Error(Exception):
    """What a program said of its failure, in its own line; `code`: its exit code [tdpt(7), EXIT STATUS]."""

    def __init__(self, line: str, code: int):
        super().__init__(line)
        self.code = code


class Portal(NamedTuple):
    """A flat polygon that light passes: its convex outline, corners x 3 [metres, +Y up], counter-clockwise as seen from where the
    light goes; and its figures, such as area, flux_share and sky [portal(5)]."""

    name: str
    polygon: numpy.ndarray[Any, Any]
    figures: dict[str, Any]


def bundled() -> Path:
    """The folder of the programs in the wheel. Blender unpacks wheels without the right to execute them, which is given here."""
    for file in _OWN.iterdir():
        if not os.access(file, os.X_OK):
            file.chmod(0o755)
    return _OWN


def program(name: str = "tdpt") -> str:
    """The path of a program: the wheel's, or without a wheel the first on the PATH."""
    path = str(bundled() / name) if _OWN.is_dir() else shutil.which(name)
    if not path:
        raise Error(f"{name}: is not on the PATH", 127)
    return path


def run(name: str, *words: File) -> str:
    """Runs a program to its end, and returns its standard output; what it warns of is a Python warning. Raises Error."""
    done = subprocess.run([program(name), *words], stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8", errors="replace")
    lines = done.stderr.splitlines()
    if done.returncode != 0:
        raise Error(lines[-1] if lines else f"{name}: exit code {done.returncode}", done.returncode)
    for line in lines:
        if ": warning: " in line:
            warnings.warn(line, stacklevel=3)
    return done.stdout


def _words(options: dict[str, Any]) -> list[str]:
    words = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is True:
            words.append(option)
        elif value is not None and value is not False:
            parts = value if isinstance(value, (list, tuple)) else [value]
            words.append(f"{option}={','.join(map(str, parts))}")
    return words


def _files() -> tuple[Any, Any, Any]:
    """The modules of pictures, of portals and of arrays."""
    try:
        from . import exr, gltf_file
        import numpy
    except ModuleNotFoundError as missing:
        raise ImportError("tdpt: arrays need numpy: pip install numpy") from missing
    return exr, gltf_file, numpy


def find_portals(scene: File, *words: str, **options: Any) -> list[Portal]:
    """The portals through which light reaches the camera, those that bring most of it first; none is a result, too."""
    _, gltf_file, np = _files()
    with tempfile.TemporaryDirectory() as folder:
        found = os.path.join(folder, "portals.glb")
        run("tdpt", scene, "-o", found, *words, *_words(options))
        return [Portal(name, np.array(corners), figures) for name, corners, _, figures in gltf_file.read_portals(found)]


def render(scene: File, *words: str, portals: Sequence[Portal] = (), **options: Any) -> numpy.ndarray[Any, Any]:
    """The picture: height x width x 3, linear, float32, the first row at the top. `portals`: these alone, as find_portals() gives
    them; else they are searched for, which is quick for a scene that was searched before."""
    exr, gltf_file, np = _files()
    with tempfile.TemporaryDirectory() as folder:
        picture, given = (os.path.join(folder, name) for name in ("picture.exr", "given.portal.glb"))
        if portals:
            fans = ([(0, i - 1, i) for i in range(2, len(portal.polygon))] for portal in portals)
            gltf_file.write_portals(given, [(p.name, p.polygon.tolist(), fan) for p, fan in zip(portals, fans)])
        run("tdpt", scene, "-o", picture, *words, *_words(options), *(("--portal", given) if portals else ()))
        channels = exr.read(picture, {"R", "G", "B"})
        rgb: numpy.ndarray[Any, Any] = np.stack([channels[name] for name in "RGB"], -1).astype("f4")
        return rgb


def _text_for(renderer: str, scene: File, words: Sequence[str], options: dict[str, Any]) -> str:
    with tempfile.TemporaryDirectory() as folder:
        run("tdpt", scene, "-o", os.path.join(folder, "found.glb"), "--work", folder + "/work", *words, *_words(options))
        (grid,) = Path(folder).glob("work/portals-*/scene.vdb")
        return run("portalfit", "--for", renderer, grid)


def for_cycles(scene: File, *words: str, **options: Any) -> str:
    """A Python script that puts the windows to the sky into Blender as portals of Cycles [portalfit(1), OTHER RENDERERS]."""
    return _text_for("cycles", scene, words, options)


def for_mitsuba(scene: File, *words: str, **options: Any) -> str:
    """The windows to the sky as a scene that one of Mitsuba 3 includes [portalfit(1), OTHER RENDERERS]."""
    return _text_for("mitsuba", scene, words, options)


def main() -> NoReturn:
    """A console script: becomes the program by whose name it was called."""
    name = os.path.basename(sys.argv[0])
    os.execv(program(name), [name, *sys.argv[1:]])
