"""Calls of limn that the documentation shows: found in Markdown, run in a folder that has the files they read.

A call is a line of a code block that starts with `limn COMMAND`, with `$ ` before it where output follows; text behind two spaces and a # is
a comment.
"""
import dataclasses
import pathlib
import re
import shutil
import subprocess

# A tetrahedron.
STL = "solid part\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {corner}\n" for corner in face) + "endloop\nendfacet\n" for face in (
    ("0 0 0", "0 1 0", "1 0 0"), ("0 0 0", "1 0 0", "0 0 1"), ("0 0 0", "0 0 1", "0 1 0"), ("1 0 0", "0 1 0", "0 0 1"))) + "endsolid part\n"
SCENE = '[[object]]\nname = "egg"\nshape = "ellipsoid"\nradii = [1.0, 0.7, 0.5]\n'


@dataclasses.dataclass
class Call:
    page: str
    line: int
    text: str
    heading: str
    message: str = ""  # what it prints on stderr, where the page shows that; then it ends with 2

    @property
    def words(self):
        return self.text.split()

    @property
    def command(self):
        return self.words[1]

    def outputs(self):
        return [after for before, after in zip(self.words, self.words[1:]) if before in ("-o", "--output")]


def commands_of(limn):
    text = subprocess.run([limn, "--help"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"^  ([a-z]+)\s", text.split("Subcommands:")[1].split("\n\n")[0], re.M))


def calls_of(file, commands):
    """Every call in a Markdown file, in order."""
    found, heading, fenced = [], "", False
    for number, line in enumerate(pathlib.Path(file).read_text().splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        if line.startswith("#") and not fenced:
            heading = line.lstrip("# ")
        if not fenced and not line.startswith("    "):
            continue
        if line.strip().startswith("limn: ") and found and found[-1].line == number - 1 and found[-1].message is None:
            found[-1].message = line.strip()
            continue
        match = re.match(r"\s*(\$ )?(limn ([a-z]+)( .*)?)$", line)
        if match and match[3] in commands:
            text = re.sub(r"\s\s*#( .*)?$", "", match[2]).strip()
            found.append(Call(pathlib.Path(file).name, number, text, heading, None if match[1] else ""))
    for call in found:
        call.message = call.message or ""
    return found


def make_files(limn, repository, folder):
    """What the calls read: files of the reader's own, here made from built-in scenes."""
    folder.mkdir(parents=True)

    def make(*arguments):
        subprocess.run([limn, *arguments, "-q"], cwd=folder, check=True, timeout=300)

    make("export", "rook", "--level", "1", "-o", "mine.obj")
    for name in ("cow.obj", "bunny.obj", "part.obj", "model.obj"):
        shutil.copy(folder / "mine.obj", folder / name)
    make("export", "teacup", "--level", "0", "--refined", "-o", "spot.obj")
    make("export", "gyroid", "--voxels", "48", "-o", "bunny.vdb")
    make("render", "teacup", "--size", "96x72", "-o", "teacup.exr")
    make("contours", "machined_part", "--size", "640x360", "-o", "drawing.svg")
    make("render", "model.obj", "--eye", "3,2,4", "--size", "320x240", "--method", "contours", "--background", "white", "-o", "screenshot.png")
    (folder / "part.toml").write_text(SCENE)
    (folder / "part.stl").write_text(STL)
    for scene in ("still_life.toml", "two_metals.toml"):
        shutil.copy(repository / "samples" / "scenes" / scene, folder)
    shutil.copy(repository / "samples" / "stability" / "cases" / "cube_faces.toml", folder / "my_case.toml")


def run(call, limn, folder, text=None, seconds=600):
    """Runs a call, or `text` in its place, by a shell, as a reader would."""
    tools = folder / ".bin"
    tools.mkdir(exist_ok=True)
    if not (tools / "limn").is_symlink():
        (tools / "limn").symlink_to(pathlib.Path(limn).resolve())
    environment = {"PATH": f"{tools}:/usr/bin:/bin", "HOME": str(folder), "LC_ALL": "C.UTF-8"}
    return subprocess.run(["bash", "-o", "pipefail", "-c", text or call.text], cwd=folder, env=environment, capture_output=True, text=True, timeout=seconds)
