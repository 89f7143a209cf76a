# The one home of the C flags: make reads it here, springpot reads it when it builds, and every
# emitted folder carries a copy. -ffp-contract=off keeps the bits the same on every target. All but the
# public functions is static, so -Bsymbolic alone keeps two scenes in one process apart; on macOS
# nothing has to.
SP_CFLAGS = -std=c11 -O2 -ffp-contract=off -fno-math-errno
SP_STRICT = -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wvla -Wundef -Wstrict-prototypes -Wmissing-prototypes -Wcast-qual -Werror
SP_SHARED = -shared -fPIC -Wl,-Bsymbolic -s
