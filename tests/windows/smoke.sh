#!/usr/bin/env bash
# What a Windows springpot has to do, beside the same on this system.
#
#     smoke.sh FOLDER PYTHON
#
# FOLDER: of make_python.sh; PYTHON: this system's, which has springpot.
set -euo pipefail
made=$(realpath "$1") tests=$(dirname "$(dirname "$(realpath "$0")")")
python=$(realpath -s "$2")
here=$(dirname "$python")/springpot
work=$(mktemp -d)
trap 'kill ${peer:-} 2>/dev/null || true; rm -rf "$work"' EXIT
cd "$work"
printf 'schema = 1\nname = "Prüfkörper"\nmodel = "model.spm"\n' > scene.toml
cat > study.toml <<'T'
schema = 1
name = "softness"
seed = 1
sessions = 1
practice = 1
questions = ["What was the same?"]
[[material]]
name = "Prüfkörper"
scenes.one = "scene.toml"
T
"$python" - <<'P'
rows = ["Zeit_s;Weg_mm;Kraft_N", *(f"{k/100:.2f};{k % 50/10:.1f};{k % 50/10:.1f}" for k in range(300))]
open("Prüfung.csv", "wb").write("\r\n".join(rows).replace(".", ",").encode("cp1252"))
P
# What it reads and writes are pipes: see make_python.sh.
step() {
    local begin=$SECONDS program=$made/wsp
    if [ "$1" = python ]; then
        program=$made/wpy
        shift
    fi
    if ! cat "${typed:-/dev/null}" | "$program" "$@" 2>&1 | cat > out.txt; then
        cat out.txt
        echo "windows: $* failed"
        exit 1
    fi
    echo "windows: $1 ${2:-}: $((SECONDS - begin)) s"
}
expect() { grep -aq "$1" out.txt || { cat out.txt; echo "windows: no \"$1\""; exit 1; }; }

step record --device sim://ecoflex-00-30 --protocol paper --out training
step record --device sim://ecoflex-00-30 --protocol validation --seed 1 --out validation
step import Prüfung.csv --map time=Zeit_s:s,position=Weg_mm:mm,force=Kraft_N:N --out imported
"$here" check imported >/dev/null 2>&1
step train training --model hammerstein --out model.spm
step emit --scene scene.toml --out c
"$here" emit --scene scene.toml --out c-here >/dev/null 2>&1
diff -r c c-here
echo "windows: the same files as here, the model's too"
step page c --out press.html
PATH=/none PYTHONPATH=$tests/../build/zig "$here" page c-here --out press-here.html >/dev/null 2>&1
cmp press.html press-here.html
echo "windows: the same page as here"
step validate c --recording validation
expect "0 ticks differ"
step stability --scene scene.toml
step report c
# One process: a read of the pipe between joblib's workers does not return under wine 8.
LOKY_MAX_CPU_COUNT=1 step bench --recording training --validate validation --model springpot --out bench
step study plan study.toml --participants 2 --out plan
printf 'l\nr\n70\nq\n' > keys.txt
typed=keys.txt step study run plan --participant 01 --device sim://ecoflex-00-30
expect "1 .*rated\|done *1"
step run --scene scene.toml --device sim://ecoflex-00-30 --seconds 4 --log felt.h5
expect "^ticks *4000 of 4000"
grep -a '^ticks' out.txt
step validate c --recording felt.h5
expect "0 of .* ticks differ"

step python -m pytest -n 0 -p no:cacheprovider "$tests/system/test_forces.py" \
    -k are_the_stored_ones -m "not slow and not long"
echo "windows: the forces of every stored model to the bit"

"$python" "$tests/support/peers/serial_device.py" --object ecoflex-00-30 > peer.txt &
peer=$!
until grep -qs serial:// peer.txt; do sleep 0.1; done
port=$(sed -n 's|^serial://\(.*\)?.*|\1|p' peer.txt)
ln -sfn "$(readlink -f "$port")" "$made/prefix/dosdevices/com9"
step run --scene scene.toml --device serial://COM9 --seconds 4 --log line.h5
grep -a '^ticks' out.txt
step validate c --recording line.h5
expect "0 of .* ticks differ"
grep -q '"event": "stop", "force_n": 0.0' peer.txt
# Windows calls CtrlRoutine in a thread of its own when the console's window is closed.
cat > closed.py <<'P'
import ctypes, pathlib, sys, threading, time
from springpot.host.cli import main
def close():
    while not any(name.name != "closed.py" for name in pathlib.Path().glob("closed*")):
        time.sleep(0.1)
    time.sleep(8.0)  # a log is begun before its device is opened
    ctypes.windll.kernelbase.CtrlRoutine(ctypes.c_void_p(2))
threading.Thread(target=close, daemon=True).start()
sys.argv = ["springpot", *sys.argv[1:]]
main()
P
step python closed.py run --scene scene.toml --device serial://COM9 --seconds 60 --log closed.h5
expect "interrupted by SIGBREAK: zero force was sent"
"$here" validate c --recording closed.h5 >/dev/null
echo "windows: passed"
