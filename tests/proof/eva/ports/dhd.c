/* The link of a Force Dimension device: whatever the functions of its SDK return and write. */
#include "anything.h"

#include "sp_link_dhd.c"

static int any_three(double *x, double *y, double *z, char id)
{
    (void)id;
    Frama_C_make_unknown((char *)x, sizeof *x);
    Frama_C_make_unknown((char *)y, sizeof *y);
    Frama_C_make_unknown((char *)z, sizeof *z);
    return Frama_C_interval(-1, 1);
}

static int any_force(double x, double y, double z, char id)
{
    (void)x;
    (void)y;
    (void)z;
    (void)id;
    return Frama_C_interval(-1, 2);
}

static int any_status(int *status, char id)
{
    (void)id;
    Frama_C_make_unknown((char *)status, MAX_STATUS * sizeof *status);
    return Frama_C_interval(-1, 0);
}

static int any_button(int index, char id)
{
    (void)index;
    (void)id;
    return Frama_C_interval(-1, 1);
}

static int any_switch(unsigned char on, char id)
{
    (void)on;
    (void)id;
    return Frama_C_interval(-1, 0);
}

static int any_error(void)
{
    return Frama_C_interval(0, 64);
}

void prove(void)
{
    static device memory;
    sp_motion motion;
    const sp_dhd dhd = {
        .get_position = any_three,
        .get_linear_velocity = any_three,
        .set_force = any_force,
        .get_status = any_status,
        .get_button = any_button,
        .enable_force = any_switch,
        .error_get_last = any_error,
        .axis = Frama_C_interval(0, 2),
        .sign = -1.0,
        .surface_m = 0.01,
        .wall_npm = 1000.0,
        .max_n = 12.0,
        .weight_n = 0.5,
        .max_call_s = 0.02,
    };
    sp_link *link = sp_link_dhd_init(&memory, &dhd);
    //@ loop unroll 0;
    while (Frama_C_interval(0, 1)) {
        ANY(uint64_t, now_ns);
        ANY(double, force_n);
        link->released = Frama_C_interval(0, 1);
        (void)link->read(link, now_ns, &motion, 1);
        (void)link->write(link, now_ns, force_n);
        if (Frama_C_interval(0, 1)) {
            link->reset(link, now_ns);
        }
    }
}
