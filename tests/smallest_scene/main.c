/* springpot 0.1.0 6c8d0400ad24cd4d314af50f69b21443d983407c78cd768de8a86bdd53cd97d4 */
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
