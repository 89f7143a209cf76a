#include <math.h>

#include "check.h"
#include "sp_smooth.h"
#include "sp_taps.h"
#include "sp_velocity.h"
#include "sp_weighted_sum.h"
#include "sp_window.h"

enum { LENGTH = 7, VECTOR_WIDTH = 8 };

static void window_is_contiguous_and_newest_first(void)
{
    sp_real samples[2 * LENGTH];
    uint32_t newest;
    sp_window_fill(samples, &newest, LENGTH, (sp_real)-1);
    for (int n = 0; n < 40; n++) {
        const sp_real *window = sp_window_push(samples, &newest, LENGTH, (sp_real)n);
        CHECK(window >= samples && window + LENGTH <= samples + 2 * LENGTH);
        for (int k = 0; k < LENGTH; k++) {
            CHECK(window[k] == (sp_real)(n - k >= 0 ? n - k : -1));
        }
    }
}

static void bank_is_the_plain_sum_in_the_same_order(void)
{
    sp_real taps[LENGTH * VECTOR_WIDTH];
    sp_real window[LENGTH];
    sp_real derivative[VECTOR_WIDTH];
    for (int i = 0; i < LENGTH * VECTOR_WIDTH; i++) {
        taps[i] = (sp_real)((i * 37) % 19) / (sp_real)7 - (sp_real)1;
    }
    for (int k = 0; k < LENGTH; k++) {
        window[k] = (sp_real)1 / (sp_real)(k + 3);
    }
    sp_weighted_sum(taps, window, LENGTH, VECTOR_WIDTH, derivative);
    for (int lane = 0; lane < VECTOR_WIDTH; lane++) {
        volatile sp_real sum = 0;
        for (int k = 0; k < LENGTH; k++) {
            const volatile sp_real product = taps[k * VECTOR_WIDTH + lane] * window[k];
            sum = sum + product;
        }
        CHECK(derivative[lane] == sum);
    }
}

static void taps_add_sixteen_sums_in_one_order(void)
{
    enum { WINDOW = 3 * SP_TAPS_SUMS };
    sp_real taps[2 * WINDOW];
    sp_real window[WINDOW];
    sp_real derivative[2];
    for (int i = 0; i < 2 * WINDOW; i++) {
        taps[i] = (sp_real)((i * 37) % 19) / (sp_real)7 - (sp_real)1;
    }
    for (int k = 0; k < WINDOW; k++) {
        window[k] = (sp_real)1 / (sp_real)(k + 3);
    }
    sp_taps(taps, window, WINDOW, 2, derivative);
    for (int row = 0; row < 2; row++) {
        volatile sp_real sum[SP_TAPS_SUMS] = {0};
        for (int k = 0; k < WINDOW; k++) {
            const volatile sp_real product = taps[row * WINDOW + k] * window[k];
            sum[k % SP_TAPS_SUMS] = sum[k % SP_TAPS_SUMS] + product;
        }
        for (int half = SP_TAPS_SUMS / 2; half >= 4; half /= 2) {
            for (int i = 0; i < half; i++) {
                sum[i] = sum[i] + sum[i + half];
            }
        }
        const volatile sp_real even = sum[0] + sum[2];
        const volatile sp_real odd = sum[1] + sum[3];
        CHECK(derivative[row] == even + odd);
    }
}

static sp_real velocity_of(const sp_real *track)
{
    sp_real per_step[LENGTH];
    for (int j = 0; j < LENGTH; j++) {
        per_step[j] = (sp_real)1000 / (sp_real)(j + 1);
    }
    return sp_velocity_foaw(track, per_step, LENGTH, (sp_real)1e-5);
}

static void velocity_uses_the_whole_past_of_a_steady_motion(void)
{
    sp_real track[LENGTH + 1];
    for (int k = 0; k <= LENGTH; k++) {
        const sp_real noise = k == 0 || k == LENGTH ? 0 : (sp_real)(k % 2 ? 4e-6 : -4e-6);
        track[k] = (sp_real)0.01 - (sp_real)k * (sp_real)1e-4 + noise;
    }
    CHECK(fabs((double)velocity_of(track) - 0.1) < 1e-4);
}

static void velocity_follows_a_sudden_stop(void)
{
    sp_real track[LENGTH + 1];
    for (int k = 0; k <= LENGTH; k++) {
        track[k] = k < 3 ? (sp_real)0.01 : (sp_real)0.01 - (sp_real)(k - 2) * (sp_real)1e-3;
    }
    CHECK(fabs((double)velocity_of(track)) < 1e-3);
}

static void smoothing_reaches_a_step(void)
{
    sp_real smoothed = 0;
    CHECK(sp_smooth((sp_real)0.75, &smoothed, (sp_real)4) == (sp_real)3);
    CHECK(sp_smooth((sp_real)0.75, &smoothed, (sp_real)4) == (sp_real)3.75);
}

int main(void)
{
    window_is_contiguous_and_newest_first();
    bank_is_the_plain_sum_in_the_same_order();
    taps_add_sixteen_sums_in_one_order();
    velocity_uses_the_whole_past_of_a_steady_motion();
    velocity_follows_a_sudden_stop();
    smoothing_reaches_a_step();
    return failed;
}
