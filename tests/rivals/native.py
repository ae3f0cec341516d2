#!/usr/bin/env python3
"""Builds a Python with LAMMPS compiled for this processor, as the fastest rival. Optional: no test needs it.

    python3 tests/rivals/native.py FOLDER [--source CHECKOUT]
    python3 tests/rivals/lammps.py --python FOLDER/bin/python

Without a checkout the source is Debian's source package `lammps` (`apt-get source`, as root or with its index readable). It is compiled with
g++ `-O3 -march=native`, for one process, with the packages GRANULAR and OPT: some 700 files, about half an hour of processor time.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig

FLAGS = "-O3 -march=native"
PACKAGES = ["GRANULAR", "OPT"]


def debian(folder):
    """Downloads and unpacks Debian's source package."""
    listed = pathlib.Path("/etc/apt/sources.list.d/stripmine-sources.sources")
    for known in sorted(pathlib.Path("/etc/apt/sources.list.d").glob("*.sources")):
        listed.write_text(known.read_text().replace("Types: deb\n", "Types: deb-src\n"))
    try:
        subprocess.run(["apt-get", "update", "-q"], check=True)
        subprocess.run(["apt-get", "source", "-q", "lammps"], cwd=folder, check=True)
    finally:
        listed.unlink(missing_ok=True)
    return next(path for path in folder.glob("lammps-*") if path.is_dir())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--source", type=pathlib.Path, help="a checkout of LAMMPS")
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    checkout = asked.source or debian(asked.folder)
    source = checkout / "src"
    make = ["make", f"-j{os.cpu_count()}"]
    subprocess.run(["make", *(f"yes-{package}" for package in PACKAGES)], cwd=source, check=True, stdout=subprocess.DEVNULL)
    flags = [f"CCFLAGS=-g0 {FLAGS} -fPIC", f"LINKFLAGS={FLAGS}", "CC=g++ -std=c++11"]
    subprocess.run([*make, "serial", "mode=shared", *flags], cwd=source, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([sys.executable, "-m", "venv", str(asked.folder)], check=True)
    version = f"python{sysconfig.get_python_version()}"
    module = asked.folder / "lib" / version / "site-packages" / "lammps"
    shutil.copytree(checkout / "python" / "lammps", module, dirs_exist_ok=True)
    shutil.copy(source / "liblammps_serial.so", module / "liblammps.so")
    compiler = subprocess.run(["g++", "-dumpfullversion"], check=True, capture_output=True, text=True).stdout.strip()
    said = f"built from source {checkout.name} by g++ {compiler} {FLAGS} with {' and '.join(PACKAGES)}, one process"
    (module / "build.txt").write_text(said + "\n")
    print(said)


if __name__ == "__main__":
    main()
