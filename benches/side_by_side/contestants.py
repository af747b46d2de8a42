"""Who competes, and how each is run."""

import shlex
import shutil
import subprocess
from dataclasses import dataclass

from measure import measure

DEPRESSION = "30"
BLOCK = 1 << 24


@dataclass
class Contestant:
    name: str
    command: list  # has {input} and {output}; without {input} it changes {output}, which is a copy of the log
    expected: str  # what check.py expects of the output
    piped: bool = False

    def run(self, log, output):
        """Runs with the log in the page cache and the disk idle. Returns the measurement and leaves the output."""
        output.unlink(missing_ok=True)
        if "{input}" not in self.command and not self.piped:
            shutil.copyfile(log, output)
        with open(log, "rb") as f:
            while f.read(BLOCK):
                pass
        subprocess.run(["sync"], check=True)
        redirection = {"stdin": log, "stdout": output} if self.piped else {}
        return measure(self.fill(log, output), output, **redirection)

    def fill(self, log, output):
        return [str(part).format(input=log, output=output) for part in self.command]

    def is_known(self, output):
        """Whether this flightcam has the mode: exit code 2 means no. The log is empty, so nothing else happens."""
        quiet = {stream: subprocess.DEVNULL for stream in ("stdin", "stdout", "stderr")}
        return subprocess.run(self.fill("/dev/null", output), **quiet).returncode != 2


def choose_contestants(tools, also):
    """In the order of the table: first, what the others are compared with."""
    enrich = [tools.flightcam, "enrich", "--quiet", "--depression", DEPRESSION]
    python = [*tools.baseline, "{input}", "{output}", DEPRESSION]
    return [
        Contestant("cp", ["cp", "--reflink=never", "{input}", "{output}"], "copy"),
        Contestant("flightcam enrich", [*enrich, "{input}", "-o", "{output}"], "appended"),
        Contestant(
            "flightcam enrich --visuals",
            [*enrich, "--visuals", "--hfov", "70", "--vfov", "50", "{input}", "-o", "{output}"],
            "shown",
        ),
        Contestant("flightcam enrich --in-place", [*enrich, "{output}", "--in-place"], "appended"),
        Contestant(
            "flightcam enrich --layout interleaved",
            [*enrich, "{input}", "--layout", "interleaved", "-o", "{output}"],
            "derived",
        ),
        Contestant("flightcam enrich - -o -", [*enrich, "-", "-o", "-"], "appended", piped=True),
        Contestant("Python", python, "reference"),
        *(Contestant(command, shlex.split(command), "messages") for command in also),
    ]
