"""Write the C of DLLs that Debian's wine 8.0 lacks: complex numbers of the C runtime, and others.

    python missing_dlls.py FOLDER

FOLDER/py holds the .pyd and .dll files whose imports are looked at; the C goes to FOLDER/shim.
"""

import argparse
import re
import subprocess
from pathlib import Path

OBJDUMP = "x86_64-w64-mingw32-objdump"
MATH, RUNTIME = "api-ms-win-crt-math-l1-1-0", "api-ms-win-crt-runtime-l1-1-0"
PARTS = ("cabs", "carg", "creal", "cimag")
FUNCTIONS = {
    *PARTS, "cacos", "cacosh", "casin", "casinh", "catan", "catanh", "ccos", "ccosh", "cexp",
    "clog", "conj", "cpow", "cproj", "csin", "csinh", "csqrt", "ctan", "ctanh",
}  # fmt: skip
IMPORT = re.compile(r"\t[0-9a-f]+\s+(?:\d+|<none>\s+[0-9a-f]+)\s+(\w+)$")
HEAD = """#include <complex.h>
typedef struct { float r, i; } F;
typedef struct { double r, i; } D;
static float complex from_F(F x) { float complex z; __real__ z = x.r; __imag__ z = x.i; return z; }
static double complex from_D(D x)
{
    double complex z;
    __real__ z = x.r;
    __imag__ z = x.i;
    return z;
}
static F to_F(float complex z) { F x = {__real__ z, __imag__ z}; return x; }
static D to_D(double complex z) { D x = {__real__ z, __imag__ z}; return x; }
"""
BUILD = {
    "_Cbuild": "D shim__Cbuild(double r, double i) { D x = {r, i}; return x; }",
    "_LCbuild": "D shim__LCbuild(double r, double i) { D x = {r, i}; return x; }",
    "_FCbuild": "F shim__FCbuild(float r, float i) { F x = {r, i}; return x; }",
}
RANDOM = """#include <windows.h>
BOOLEAN NTAPI SystemFunction036(void *, ULONG);
__declspec(dllexport) BOOL WINAPI ProcessPrng(BYTE *p, SIZE_T n) { return SystemFunction036(p, n); }
"""
FENV = """typedef struct { unsigned long c, s; } E;
int shim_feholdexcept(E *e) { if (e) e->c = e->s = 0; return 0; }
"""


def imported(folder: Path) -> dict[str, set[str]]:
    """Names that the libraries below a folder import, by DLL; those renamed before count too."""
    names: dict[str, set[str]] = {}
    for file in [*folder.rglob("*.pyd"), *folder.rglob("*.dll")]:
        done = subprocess.run(
            [OBJDUMP, "-p", file], capture_output=True, text=True, errors="replace", check=False
        )
        dll = ""
        for line in done.stdout.splitlines():
            if found := re.match(r"\s*DLL Name: (\S+)", line):
                dll = found[1].lower().removesuffix(".dll").replace("spx-", "api-")
            elif dll and (found := IMPORT.match(line)):
                names.setdefault(dll, set()).add(found[1])
    return names


def complex_function(name: str) -> str | None:
    """C of a complex function by the compiler's own; None of another name."""
    for base, kind in ((name, "D"), (name[:-1], "F" if name.endswith("f") else "D")):
        if base not in FUNCTIONS or (base != name and name[-1] not in "fl"):
            continue
        call, scalar = base + "f" * (kind == "F"), "float" if kind == "F" else "double"
        if base in PARTS:
            body = {"creal": "x.r", "cimag": "x.i"}.get(base, f"{call}(from_{kind}(x))")
            return f"{scalar} shim_{name}({kind} x) {{ return {body}; }}"
        arguments = ("x", "y") if base == "cpow" else ("x",)
        given = ", ".join(f"from_{kind}({each})" for each in arguments)
        declared = ", ".join(f"{kind} {each}" for each in arguments)
        return f"{kind} shim_{name}({declared}) {{ return to_{kind}({call}({given})); }}"
    return None


def exports(library: str, ours: set[str], names: set[str]) -> str:
    """A .def file: our own functions, and the runtime's for all other names."""
    rows = [f" {name} = {f'shim_{name}' if name in ours else f'ucrtbase.{name}'}"
            for name in sorted(names | ours)]  # fmt: skip
    return "\n".join([f"LIBRARY {library}", "EXPORTS", *rows, ""])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    names = imported(folder / "py")
    shim = folder / "shim"
    shim.mkdir(exist_ok=True)
    functions = {name: c for name in names[MATH] if (c := complex_function(name))} | BUILD
    (shim / "math.c").write_text(HEAD + "\n".join(functions.values()) + "\n")
    library = MATH.replace("api", "spx")
    (shim / "math.def").write_text(exports(library, set(functions), names[MATH]))
    (shim / "runtime.c").write_text(FENV)
    library = RUNTIME.replace("api", "spx")
    (shim / "runtime.def").write_text(exports(library, {"feholdexcept"}, names[RUNTIME]))
    (shim / "random.c").write_text(RANDOM)
    for file in (folder / "py/Lib/site-packages").rglob("*"):
        if file.suffix not in (".pyd", ".dll"):
            continue
        old = file.read_bytes()
        new = old.replace(MATH.encode(), MATH.replace("api", "spx").encode())
        if b"feholdexcept" in new:
            new = new.replace(RUNTIME.encode(), RUNTIME.replace("api", "spx").encode())
        if new != old:
            file.write_bytes(new)


if __name__ == "__main__":
    main()
