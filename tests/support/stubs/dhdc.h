/* The calls of Force Dimension's SDK that docs/how-to/chai3d.md makes, on a motion of 300 ticks: a press of
 * 8 mm; every seventh position cannot be read. Prints position, velocity and force of each tick. */
#include <stdio.h>

enum { DHD_ON = 1 };
static int stub_tick;

static inline int dhdOpen(void)
{
    return 0;
}
static inline int dhdEnableForce(int on)
{
    return on - DHD_ON;
}
static inline const char *dhdErrorGetLastStr(void)
{
    return "none";
}
static inline int dhdGetButton(int)
{
    return stub_tick == 300;
}
static inline int dhdGetPosition(double *x, double *y, double *z)
{
    const double t = stub_tick / 150.0 - 1.0;
    *x = *y = 0.0;
    *z = -0.008 * (1.0 - t * t);
    stub_tick++;
    if (stub_tick % 7 == 0) {
        printf("idle ");
        return -1;
    }
    printf("%.17g ", *z);
    return 0;
}
static inline int dhdSetForce(double, double, double z)
{
    printf("%.17g\n", z);
    return 0;
}
static inline int dhdClose(void)
{
    return 0;
}
