"""Builds and installs the programs to compare, and describes the machine."""

import json
import os
import platform
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[1]
PROTO = PROJECT / "proto"


@dataclass
class Tools:
    flightcam: Path
    generator: Path
    python: Path  # with the packages of requirements.txt
    baseline: list  # the command without its arguments
    versions: list


def run(*command):
    subprocess.run(command, cwd=PROJECT, stdout=sys.stderr, check=True)


def ask(*command):
    return subprocess.run(command, cwd=PROJECT, stdout=subprocess.PIPE, check=True, text=True).stdout.strip()


def target_directory():
    metadata = json.loads(ask("cargo", "metadata", "--no-deps", "--format-version", "1"))
    return Path(metadata["target_directory"])


def prepare_tools():
    run("cargo", "build", "--release", "--bin", "flightcam", "--example", "generate_benchmark_log")
    target = target_directory()
    flightcam = target / "release/flightcam"

    requirements = HERE / "requirements.txt"
    environment = target / "side_by_side_python"
    python = environment / "bin/python"
    run(sys.executable, "-m", "venv", environment)
    run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", requirements)
    messages = environment / "messages"
    messages.mkdir(exist_ok=True)
    names = ("relative_rpy", "camera_orientation", "camera_velocity")
    protos = [PROTO / f"flightcam/v1/{name}.proto" for name in names]
    run(python, "-m", "grpc_tools.protoc", f"--proto_path={PROTO}", f"--python_out={messages}", *protos)

    commit = ask("git", "describe", "--always", "--dirty")
    return Tools(
        flightcam=flightcam,
        generator=target / "release/examples/generate_benchmark_log",
        python=python,
        baseline=["env", f"PYTHONPATH={messages}", python, HERE / "baseline.py"],
        versions=[
            f"{ask(flightcam, '--version')} ({commit})",
            ask("cp", "--version").splitlines()[0],
            ask(python, "--version"),
            *requirements.read_text().replace("==", " ").splitlines(),
        ],
    )


def describe_machine(folder):
    model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    filesystem = ask("df", "--output=fstype", folder).split()[-1]
    return (
        f"{model[1] if model else platform.machine()}, {os.cpu_count()} cores, {memory / 1e9:.0f} GB of memory, "
        f"{platform.system()} {platform.release()}, {filesystem}"
    )
