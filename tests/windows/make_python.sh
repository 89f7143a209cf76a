#!/usr/bin/env bash
# A CPython for Windows under Debian's wine, from PyPI and Debian alone: FOLDER/wpy, and FOLDER/wsp,
# its `springpot`.
#
#     make_python.sh FOLDER CHECKOUT PYTHON
#
# python311.dll comes out of a wheel of panda3d, the library from PYTHON, a 3.11 of this system. The
# compilers that it finds, gcc.exe and ziglang, hand their arguments to mingw's gcc and Linux's zig:
# the zig.exe of ziglang does not run under wine 8.
set -euo pipefail
out=$(realpath -m "$1") checkout=$(realpath "$2") python=$3
here=$(dirname "$(realpath "$0")")
cc=x86_64-w64-mingw32-gcc-posix
if ! command -v wine >/dev/null || ! command -v $cc >/dev/null; then
    apt-get update -q >/dev/null
    DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
        wine wine64 gcc-mingw-w64-x86-64-posix >/dev/null
fi
mkdir -p "$out/py/DLLs" "$out/py/Lib" "$out/wheel" "$out/cc"
windows="--platform win_amd64 --python-version 3.11 --only-binary=:all: --quiet --disable-pip-version-check"
$python -m pip download $windows --no-deps -d "$out/wheel" panda3d
$python - "$out" <<'P'
import pathlib, sys, zipfile
out = pathlib.Path(sys.argv[1])
wheel = zipfile.ZipFile(next((out / "wheel").glob("panda3d*.whl")))
for name in wheel.namelist():
    base = name.rpartition("/")[2]
    if name.startswith("deploy_libs/") and base.endswith((".dll", ".pyd")) and not base.startswith("api-ms"):
        beside = base.lower().startswith(("python", "vcruntime"))
        (out / "py" / base if beside else out / "py/DLLs" / base).write_bytes(wheel.read(name))
P
library=$($python -c 'import os; print(os.path.dirname(os.__file__))')
tar -C "$library" --exclude site-packages --exclude lib-dynload --exclude test --exclude 'config-*' \
    --exclude __pycache__ -cf - . | tar -C "$out/py/Lib" -xf -
site=$out/py/Lib/site-packages
# pip takes markers from the system it runs on: colorama, which click needs on Windows, by name.
$python -m pip install $windows --target "$site" numpy scipy scikit-learn cffi h5py pydantic jinja2 \
    click colorama rich pyserial annotated-types matplotlib tzdata pytest pytest-xdist
ln -sfn "$checkout" "$site/springpot"
mkdir -p "$site/ziglang"
echo 'import subprocess, sys; sys.exit(subprocess.call(["zig.exe", *sys.argv[1:]]))' > "$site/ziglang/__main__.py"
touch "$site/ziglang/__init__.py"
cp -r "$($python -c 'import importlib.metadata as m; print(m.distribution("springpot")._path)')" "$site"
$cc -municode -O1 -static -o "$out/py/python.exe" "$here/python.c"
$cc -O1 -static -DTOOL='"$SP_WINE_CC"' -o "$out/cc/gcc.exe" "$here/gcc.c"
$cc -O1 -static -DTOOL='"$SP_WINE_ZIG"' -o "$out/cc/zig.exe" "$here/gcc.c"
$python "$here/missing_dlls.py" "$out"
$cc -static -O2 -shared -o "$out/py/spx-ms-win-crt-math-l1-1-0.dll" "$out/shim/math.c" "$out/shim/math.def"
$cc -static -O2 -shared -o "$out/py/spx-ms-win-crt-runtime-l1-1-0.dll" "$out/shim/runtime.c" "$out/shim/runtime.def"
$cc -static -O2 -shared -o "$out/py/bcryptprimitives.dll" "$out/shim/random.c" -ladvapi32
as_windows="Z:${out//\//\\}"
cat > "$out/wpy" <<S
#!/bin/sh
export WINEPREFIX=$out/prefix WINEDEBUG=-all WINEARCH=win64 SP_WINE_C=$out/prefix/dosdevices/c:
export SP_WINE_CC="\${SP_WINE_CC:-$cc}" SP_WINE_ZIG="$checkout/build/zig/ziglang/zig" SP_WINE_SCRATCH='$as_windows\\cc' WINEPATH='$as_windows\\cc;$as_windows\\py'
exec timeout \${T:-580} wine '$as_windows\\py\\python.exe' "\$@"
S
cat > "$out/wsp" <<S
#!/bin/sh
exec $out/wpy -c "import sys; sys.argv[0]='springpot'; from springpot.host.cli import main; main()" "\$@"
S
chmod +x "$out/wpy" "$out/wsp"
WINEPREFIX=$out/prefix WINEDEBUG=-all WINEARCH=win64 timeout 300 wine wineboot -i 2>&1 | cat >/dev/null
# Windows' Python refuses wine's handle of a file: its output goes through a pipe.
"$out/wpy" -c 'import sys, numpy, h5py, sklearn; print(sys.version)' </dev/null 2>&1 | cat
