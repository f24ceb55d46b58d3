"""Builds the wheel: the package and the shared library, which make compiles. A build backend of PEP 517 that wants nothing
but Python; `make python` calls it, `pip wheel examples/bindings/python` does, too."""
import base64
import hashlib
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOP = HERE.parents[2]
LIBRARY = "build/bindings/libflexbeam_scene.so"


def version():
    return re.search(r'#define FB_VERSION "([^"]*)"', (TOP / "flexbeam.h").read_text(encoding="ascii")).group(1)


def contents(folder, tag):
    """Files of the wheel: name, bytes."""
    for file in sorted((HERE / "flexbeam").glob("*.py*")):
        if file.suffix != ".pyc" and file.is_file():
            yield f"flexbeam/{file.name}", file.read_bytes()
    yield f"flexbeam/{Path(LIBRARY).name}", (TOP / LIBRARY).read_bytes()
    project = (HERE / "pyproject.toml").read_text(encoding="ascii")
    summary, python = (re.search(rf'^{key} = "(.*)"$', project, re.M).group(1) for key in ("description", "requires-python"))
    yield f"{folder}/METADATA", (f"Metadata-Version: 2.1\nName: flexbeam\nVersion: {version()}\nSummary: {summary}\n"
                                 f"License: MIT\nRequires-Python: {python}\nRequires-Dist: numpy\n").encode()
    yield f"{folder}/WHEEL", f"Wheel-Version: 1.0\nGenerator: flexbeam\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    yield f"{folder}/LICENSE", (TOP / "LICENSE").read_bytes()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    if not (TOP / LIBRARY).exists():
        subprocess.run(["make", "-s", LIBRARY], cwd=TOP, check=True)
    tag = "py3-none-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    folder = f"flexbeam-{version()}.dist-info"
    name = f"flexbeam-{version()}-{tag}.whl"
    record = []
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for file, data in contents(folder, tag):
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{file},sha256={digest},{len(data)}\n")
            wheel.writestr(file, data)
        wheel.writestr(f"{folder}/RECORD", "".join(record) + f"{folder}/RECORD,,\n")
    return name


if __name__ == "__main__":
    print(build_wheel(sys.argv[1]))
