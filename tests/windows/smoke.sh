#!/usr/bin/env bash
# What a Windows springpot has to do, beside the same on this system.
#
#     smoke.sh FOLDER SPRINGPOT
#
# FOLDER: of make_python.sh; SPRINGPOT: this system's command.
set -euo pipefail
windows=$(realpath "$1")/wsp here=$(realpath "$2")
cd "$(mktemp -d)"
printf 'schema = 1\nname = "Prüfkörper"\nmodel = "model.spm"\n' > scene.toml
python3 - <<'P'
rows = ["Zeit_s;Weg_mm;Kraft_N", *(f"{k/100:.2f};{k % 50/10:.1f};{k % 50/10:.1f}" for k in range(300))]
open("Prüfung.csv", "wb").write("\r\n".join(rows).replace(".", ",").encode("cp1252"))
P
step() {
    local begin=$SECONDS
    if ! "$windows" "$@" </dev/null 2>&1 | cat > out.txt; then  # a pipe: see make_python.sh
        cat out.txt
        echo "windows: springpot $* failed"
        exit 1
    fi
    echo "windows: springpot $1 ${2:-}: $((SECONDS - begin)) s"
}
expect() { grep -aq "$1" out.txt || { cat out.txt; echo "windows: no \"$1\""; exit 1; }; }
step record --device sim://ecoflex-00-30 --protocol paper --out training
step record --device sim://ecoflex-00-30 --protocol validation --seed 1 --out validation
step import Prüfung.csv --map time=Zeit_s:s,position=Weg_mm:mm,force=Kraft_N:N --out imported
step train training --model hammerstein --out model.spm
step emit --scene scene.toml --out c
"$here" emit --scene scene.toml --out c-here >/dev/null 2>&1
for file in sp.c sp.h main.c Makefile manifest.json; do
    cmp "c/$file" "c-here/$file"
done
echo "windows: the same files as here"
step validate c --recording validation
expect "0 ticks differ"
step stability --scene scene.toml
step report c
# Not bench: the workers of joblib do not end under wine.
step run --scene scene.toml --device sim://ecoflex-00-30 --seconds 4 --log felt.h5
step validate c --recording felt.h5
expect "0 of .* ticks differ"
echo "windows: passed"
