# SPDX-License-Identifier: Apache-2.0
"""Builds the extension on the archives of the C library, for the stable ABI of CPython 3.11.

The archives come from CMake: the folder named by IMUKIT_BUILD, default build/ at the root of the
repository, is configured and built first. IMUKIT_SANITIZE=1 links the sanitizers that this build
was made with."""
import os
import pathlib
import re
import subprocess

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
BUILD = pathlib.Path(os.environ.get("IMUKIT_BUILD", ROOT / "build")).resolve()
ARCHIVES = ["imukit-io", "imukit-physics", "imukit"]
PACKAGES = ["yaml-0.1", "libzstd", "expat", "liblz4", "sqlite3", "zlib"]


def libraries():
    """What the archives need, for the linker."""
    hdf5 = next(name for name in ("hdf5-serial", "hdf5")
                if subprocess.run(["pkg-config", "--exists", name]).returncode == 0)
    flags = subprocess.run(["pkg-config", "--libs", *PACKAGES, hdf5], check=True, text=True,
                           capture_output=True).stdout.split()
    return [*flags, "-lbz2", "-lpthread", "-lm"]


class build_with_archives(build_ext):
    """Make the archives first."""

    def run(self):
        if not (BUILD / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-D", "CMAKE_BUILD_TYPE=Release"],
                           check=True)
        subprocess.run(["cmake", "--build", BUILD, "-j", str(os.cpu_count() or 2), "--target",
                        ARCHIVES[0]], check=True)
        super().run()


def version():
    text = (ROOT / "include/imukit/status.h").read_text(encoding="utf-8")
    return re.search(r'#define IMK_VERSION "([0-9.]+)"', text)[1]


# A function that is not of the stable ABI is not declared.
flags = ["-std=c17", "-O2", "-fvisibility=hidden", "-Wall", "-Wextra",
         "-Wno-missing-field-initializers", "-Werror=implicit-function-declaration"]
links = ["-Wl,--exclude-libs,ALL"]
if os.environ.get("IMUKIT_SANITIZE"):
    flags += ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O1", "-g"]
    links += ["-fsanitize=address,undefined"]

setup(
    version=version(),
    packages=["imukit"],
    package_data={"imukit": ["py.typed", "*.pyi"]},
    cmdclass={"build_ext": build_with_archives},
    ext_modules=[Extension(
        "imukit._core",
        sources=sorted(str(path.relative_to(HERE)) for path in (HERE / "extension").glob("*.c")),
        depends=["extension/extension.h"] + [str(BUILD / f"lib{name}.a") for name in ARCHIVES],
        include_dirs=[str(ROOT / "include")],
        define_macros=[("Py_LIMITED_API", "0x030b0000")],
        py_limited_api=True,
        extra_compile_args=flags,
        extra_objects=[str(BUILD / f"lib{name}.a") for name in ARCHIVES],
        extra_link_args=[*libraries(), *links],
    )],
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
