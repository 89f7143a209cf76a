#include "sp_page_survey.h"

#include "sp_page_touch.h"

enum { CELLS = 16384 };

static double ends_m[4];
static double surveyed_n[CELLS];

uint32_t sp_page_survey_cells(void)
{
    return CELLS;
}

double *sp_page_survey_ends_m(void)
{
    return ends_m;
}

/* The force of a fresh object that is pressed at a place, N; the speed begins and ends at 0. */
static double pressed_n(double x_m, double y_m, double depth_m, uint32_t ticks, double dt_s)
{
    static sp_state fresh;
    sp_real felt_n[3] = {(sp_real)0, (sp_real)0, (sp_real)0};
    double before_m = 0.0;
    sp_init(&fresh);
    for (uint32_t i = 0; i <= ticks; i++) { /* the first tick is off the object: no start-up ramp */
        const double t = (double)i / (double)ticks;
        const double now_m = depth_m * t * t * (3.0 - 2.0 * t);
        const sp_real at_m[3] = {(sp_real)x_m, (sp_real)y_m, (sp_real)now_m};
        (void)sp_page_touch(&fresh, at_m, (sp_real)((now_m - before_m) / dt_s), felt_n);
        before_m = now_m;
    }
    return (double)felt_n[2];
}

/* Node `at` of n between two ends. */
static double between(double first_m, double last_m, uint32_t at, uint32_t n)
{
    return n > 1U ? first_m + (last_m - first_m) * (double)at / (double)(n - 1U) : first_m;
}

const double *sp_page_survey(uint32_t columns, uint32_t rows, double depth_m, uint32_t ticks,
                             double dt_s)
{
    for (uint32_t j = 0; j < rows; j++) {
        for (uint32_t i = 0; i < columns && j * columns + i < CELLS; i++) {
            surveyed_n[j * columns + i] =
                pressed_n(between(ends_m[0], ends_m[2], i, columns),
                          between(ends_m[1], ends_m[3], j, rows), depth_m, ticks, dt_s);
        }
    }
    return surveyed_n;
}
