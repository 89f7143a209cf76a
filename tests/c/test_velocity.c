/* Velocity from positions with noise. Sums and windows: the reference has the same bits. */
#include <math.h>

#include "check.h"
#include "sp_velocity.h"

enum { LENGTH = 7 };

static sp_real velocity_of(const sp_real *track)
{
    sp_real per_step[LENGTH];
    for (int j = 0; j < LENGTH; j++) {
        per_step[j] = (sp_real)1000 / (sp_real)(j + 1);
    }
    return sp_velocity_foaw(track, per_step, LENGTH, (sp_real)1e-5);
}

TEST(velocity_uses_the_whole_past_of_a_steady_motion)
{
    sp_real track[LENGTH + 1];
    for (int k = 0; k <= LENGTH; k++) {
        const sp_real noise = k == 0 || k == LENGTH ? 0 : (sp_real)(k % 2 ? 4e-6 : -4e-6);
        track[k] = (sp_real)0.01 - (sp_real)k * (sp_real)1e-4 + noise;
    }
    CHECK(fabs((double)velocity_of(track) - 0.1) < 1e-4);
}

TEST(velocity_follows_a_sudden_stop)
{
    sp_real track[LENGTH + 1];
    for (int k = 0; k <= LENGTH; k++) {
        track[k] = k < 3 ? (sp_real)0.01 : (sp_real)0.01 - (sp_real)(k - 2) * (sp_real)1e-3;
    }
    CHECK(fabs((double)velocity_of(track)) < 1e-3);
}
