"""What `import springpot` and each command weigh: seconds, MiB, and the packages that they load.

PYTHONPATH=build/ns .venv/bin/python tests/bench/weights.py: a table; the work itself is small, so
that what is shown is what was loaded. Times are the median of five, in one run, side by side.
"""

import shlex
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from support.pages.job import small_job

ROUNDS = 5
HEAVY = (
    "numpy", "scipy", "sklearn", "h5py", "cffi", "pydantic", "rich", "serial", "can", "matplotlib",
    "jinja2", "joblib",
)  # fmt: skip
LISTED = f"""
def said():
    loaded = [name for name in {HEAVY!r} if name in sys.modules]
    peak = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
    print(int(peak.split()[1]) / 1024, *loaded, file=sys.stderr)
import atexit, sys
atexit.register(said)
"""
MAIN = "import sys; sys.argv = ['springpot', *{}]; from springpot.host.cli import main; main()"
COMMANDS = (
    "--help", "train --help", "doctor --json", "check training",
    "train training --model rf-fd --out other.spm", "train training --model rbf-fd --out other.spm",
    "emit --scene scene.toml --out c", "validate c --recording validation",
    "stability --scene scene.toml", "report c",
    "run --scene scene.toml --device sim://ecoflex-00-30 --seconds 1",
)  # fmt: skip


def weigh(code: str, folder: Path) -> tuple[float, float, str]:
    """Seconds, MiB and packages of a Python process."""
    begin = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", LISTED + code], cwd=folder, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    seconds = time.perf_counter() - begin
    if done.returncode:
        raise SystemExit(done.stderr)
    peak_mib, *packages = done.stderr.strip().splitlines()[-1].split()
    return seconds, float(peak_mib), " ".join(packages)


def main() -> None:
    """Print the table."""
    rows = {"python -c pass": "pass", "import springpot": "import springpot"}
    rows |= {f"springpot {line}": MAIN.format(shlex.split(line)) for line in COMMANDS}
    print("| what | s | MiB | packages |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        small_job(folder)
        for name, code in rows.items():
            found = [weigh(code, folder) for _ in range(ROUNDS)]
            seconds = statistics.median(item[0] for item in found)
            print(f"| `{name}` | {seconds:.2f} | {found[0][1]:.0f} | {found[0][2]} |", flush=True)


if __name__ == "__main__":
    main()
