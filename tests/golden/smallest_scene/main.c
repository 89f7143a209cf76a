/* springpot 0.1.0 e9450291b20558f9423f16bd37bd6ffa5574750fb352ce2f13b7feed6a2bc3cb */
/* Example: one position (m) a line on standard input, force (N) and notes on standard
 * output, a tick of 0.001 s each. Checks the compiler first. */
#include <stdio.h>

#include "sp_scene.h"

int main(void)
{
    static sp_state state;
    double position_m;
    double before_m = 0.0;
    long line = 0;
    int read;
    const int differs = sp_selftest();
    if (differs != 0) {
        fprintf(stderr,
                "self-test: tick %d differs: this compiler changes floating-point results; build "
                "with -ffp-contract=off and without -ffast-math\n",
                differs - 1);
        return 1;
    }
    fprintf(stderr, "self-test passed: %s\n", sp_manifest());
    sp_init(&state);
    while ((read = scanf("%lf", &position_m)) == 1) {
        const double velocity_mps = (position_m - before_m) / 0.001;
        float force_n = 0;
        const int notes = sp_step(&state, (float)position_m, (float)velocity_mps, &force_n);
        printf("%.17g %d\n", (double)force_n, notes);
        before_m = position_m;
        line++;
    }
    if (read != EOF) {
        fprintf(stderr, "line %ld is not a number: give one position in m a line\n", line + 1);
        return 1;
    }
    return 0;
}
