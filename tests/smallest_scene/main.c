/* springpot 0.1.0 55c4227d8bae79067de13cb9fd840f263318e50d16e8ced7ef60e871c453d162 */
/* Example: one position (m) a line on standard input, one force (N) a line on standard output,
 * a tick of 0.001 s each. Checks the compiler first. */
#include <stdio.h>

#include "sp_scene.h"

int main(void)
{
    static sp_state state;
    double position_m;
    double before_m = 0.0;
    const int differs = sp_selftest();
    if (differs != 0) {
        fprintf(stderr,
                "self-test: tick %d differs: this compiler changes floating-point results; build "
                "with the flags of flags.mk (-ffp-contract=off, no -ffast-math)\n",
                differs - 1);
        return 1;
    }
    fprintf(stderr, "self-test passed: %s\n", sp_manifest());
    sp_init(&state);
    while (scanf("%lf", &position_m) == 1) {
        const double velocity_mps = (position_m - before_m) / 0.001;
        float force_n = 0;
        (void)sp_step(&state, (float)position_m, (float)velocity_mps, &force_n);
        printf("%.9g\n", (double)force_n);
        before_m = position_m;
    }
    return 0;
}
