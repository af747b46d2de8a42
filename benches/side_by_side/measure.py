"""What a command takes: time, CPU, memory."""

import ctypes
import os
import signal
import subprocess
import time
from dataclasses import dataclass

# A process's peak memory is never less than its parent's at the fork, and Python is large. So a small shell forks
# the command, which waits for a line until the shell has exited and this process has adopted it.
SHELL = 'exec 3<&0; { read -r _ <&3; exec "$@" 3<&-; } <"$FROM" >"$TO" & echo $!'
PR_SET_CHILD_SUBREAPER = 36


@dataclass
class Measurement:
    seconds: float
    user: float
    system: float
    peak_bytes: int
    output_bytes: int


def adopt_orphans():
    """Call this once, before anything is measured."""
    if ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0):
        raise OSError(ctypes.get_errno(), "prctl")


def measure(command, output, stdin=os.devnull, stdout=os.devnull):
    """Runs a command until its output is on the disk, whether or not the command syncs it."""
    environment = {**os.environ, "FROM": str(stdin), "TO": str(stdout)}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(["sh", "-c", SHELL, "sh", *command], env=environment, text=True, **pipes) as shell:
        pid = int(shell.stdout.readline())
        shell.wait()
        start = time.perf_counter()
        print(file=shell.stdin, flush=True)
        try:
            _, status, usage = os.wait4(pid, 0)
        except KeyboardInterrupt:  # which a shell's background commands ignore
            os.kill(pid, signal.SIGTERM)
            raise
        if status == 0:
            with open(output, "rb") as f:
                os.fsync(f.fileno())
        seconds = time.perf_counter() - start
    if status != 0:
        raise subprocess.CalledProcessError(os.waitstatus_to_exitcode(status), command)
    output_bytes = os.stat(output).st_size
    return Measurement(seconds, usage.ru_utime, usage.ru_stime, usage.ru_maxrss * 1024, output_bytes)
