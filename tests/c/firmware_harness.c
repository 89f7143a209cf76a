/* The firmware's main loop on a motion and a clock of a test's own: periods pass while it sleeps,
 * and the test notes the force of each. */
#include <setjmp.h>

#define main firmware_main
#include "sp_firmware.c"
#undef main

/* position_m: of each period; what is not a number stands for a sensor without news.
 * periods: how many pass in each sleep, n in all. Returns how many forces the motor was given. */
uint32_t harness_run(const float *position_m, const uint32_t *periods, uint32_t n, float *force_n);

static struct {
    const float *position_m;
    const uint32_t *periods;
    float *force_n;
    uint32_t n, now, given, passed;
    jmp_buf over;
} line;

void sp_port_start(float period_s)
{
    line.given = 0; /* the force before the first period is no tick's */
    (void)period_s;
}

uint32_t sp_port_take_elapsed_periods(void)
{
    const uint32_t passed = line.passed;
    line.passed = 0;
    return passed;
}

void sp_port_sleep(void)
{
    if (line.n == 0) {
        longjmp(line.over, 1);
    }
    line.passed = *line.periods++;
    line.n -= line.passed;
    line.now += line.passed;
}

void sp_hand_start(void)
{
}

int sp_hand_motion(float *position_m)
{
    *position_m = line.position_m[line.now - 1];
    return *position_m == *position_m;
}

void sp_hand_force(float force_n)
{
    line.force_n[line.given++] = force_n;
}

uint32_t harness_run(const float *position_m, const uint32_t *periods, uint32_t n, float *force_n)
{
    line.position_m = position_m;
    line.periods = periods;
    line.n = n;
    line.force_n = force_n;
    line.now = line.given = line.passed = 0;
    if (setjmp(line.over) == 0) {
        (void)firmware_main();
    }
    return line.given;
}
