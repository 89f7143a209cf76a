/* A soft pad in a game that draws 60 pictures a second: one press, one force a picture.
 *
 *     cc -o soft_pad examples/soft_pad/main.c examples/soft_pad/soft_pad.c -lm && ./soft_pad
 *
 * soft_pad.c and soft_pad.h are what `springpot emit` writes for a silicone pad (Ecoflex 00-30):
 * nothing else is needed, neither Python nor a library. Any position may be passed: above the pad
 * its height as a negative depth, beside it any negative depth. docs/how-to/game-engine.md has pads
 * of other sizes and stiffnesses, pauses and hitches. A hand on a force-feedback device needs
 * soft_pad_step in a loop of 1 kHz instead. */
#include <stdio.h>

#include "soft_pad.h"

enum { PICTURES_PER_S = 60, PICTURES = 90 };

int main(void)
{
    static soft_pad_state pad;
    const int differs = soft_pad_selftest();
    if (differs != 0) {
        fprintf(stderr, "tick %d differs: build without -ffast-math\n", differs - 1);
        return 1;
    }
    soft_pad_init(&pad);
    for (int picture = 0; picture <= PICTURES; picture++) {
        /* Down 10 mm in half a second, half a second of rest, and up again. */
        const int left = PICTURES - picture;
        const int way = picture < 30 ? picture : left < 30 ? left : 30;
        const float depth_m = 0.010f * (float)way / 30.0f;
        float force_n = 0.0f;
        const int notes = soft_pad_advance(&pad, 1.0f / PICTURES_PER_S, depth_m, &force_n);
        if (notes < 0) {
            fprintf(stderr, "misuse: %d\n", notes);
            return 1;
        }
        printf("%5.3f s %6.3f mm %6.3f N\n", (double)picture / PICTURES_PER_S,
               1e3 * (double)depth_m, (double)force_n);
    }
    return 0;
}
