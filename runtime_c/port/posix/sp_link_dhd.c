/* A Force Dimension device: the functions of its SDK (libdhd), called in the tick. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "sp_clock.h"
#include "sp_link.h"

/* springpot declarations begin */
/* A Force Dimension device through the functions of its SDK, which one thread calls at a time.
 * position = sign * p[axis] - surface_m. The other axes are free, or drawn to a line by springs of
 * wall_npm, each of max_n at most. weight_n acts upwards, along the last axis, beside all else.
 * Both rise within a second, from zero after each reset or pause. A call that takes longer than
 * max_call_s trips the link: meanwhile the last force stayed. */
typedef struct {
    int (*get_position)(double *, double *, double *, char);
    int (*get_linear_velocity)(double *, double *, double *, char);
    int (*set_force)(double, double, double, char);
    int (*get_status)(int *, char);
    int (*get_button)(int, char);
    int (*enable_force)(unsigned char, char);
    int (*error_get_last)(void);
    int32_t id;
    int32_t axis;
    double sign;
    double surface_m;
    double line_m[3];
    double wall_npm;
    double max_n;
    double weight_n;
    double max_call_s;
} sp_dhd;
enum { /* device_error of such a link, beyond the SDK's own numbers */
       SP_DHD_SLOW_CALL = 0x100,
       SP_DHD_FORCE_OFF = 0x200 /* and the SDK's number of the cause */
};
uint32_t sp_link_dhd_size(void);
sp_link *sp_link_dhd_init(void *memory, const sp_dhd *dhd);
/* springpot declarations end */

/* Of the SDK, as CHAI3D's public header has them. */
enum { MAX_STATUS = 32, STATUS_FORCE = 5, STATUS_FORCE_OFF_CAUSE = 14, ON = 1, OFF = 0 };
enum { AXES = 3, UP = 2 };

/* Its status and button are asked for at every so manieth sample: within 8 ms at 1 kHz. */
enum { STATUS_EVERY = 8 };
/* So many forces that were not taken, one after the other, and the motors are switched off; or the
 * device is gone, where it gives no position either. */
enum { MAX_UNTAKEN = 2 };
static const uint64_t gone_ns = 100000000; /* without a position */
static const double rise_s = 1.0;          /* of the force that holds the tool */
/* Of max_n: a wall's growth at a force, wherever the tool is when it is seen again. */
static const double wall_growth = 0.25;
/* A wall's damping in seconds of its stiffness: what the SDK's own estimate of velocity bears. */
static const double wall_damping_s = 0.005;

typedef struct {
    sp_link link;
    sp_dhd dhd;
    double at_m[AXES];
    double at_mps[AXES];
    double wall_n[AXES];     /* given last; the first one after a pause is zero by its share */
    uint64_t good_ns;        /* of the last call that succeeded */
    uint64_t guide_since_ns; /* since when it holds the tool; 0: not yet */
    uint32_t status_polls;
    uint32_t refused_forces;
    uint32_t failed_reads;
    int tripped;
    int pressed;
} device;

static uint64_t clock_ns(void)
{
    return sp_clock_ns();
}

static void trip(device *self, uint32_t why)
{
    if (!self->tripped) {
        self->link.device_error = why;
    }
    self->tripped = 1;
}

/* A call of the SDK came back: a slow one kept the last force for as long. */
static void watch_call(device *self, uint64_t begin_ns)
{
    if ((double)(clock_ns() - begin_ns) > 1e9 * self->dhd.max_call_s) {
        trip(self, SP_DHD_SLOW_CALL);
        self->link.device_error = SP_DHD_SLOW_CALL; /* whatever the device did meanwhile */
    }
}

/* Ask the device, once in STATUS_EVERY readings, whether its forces are still on and its button
 * is pressed. */
static void poll_status(device *self)
{
    const sp_dhd *dhd = &self->dhd;
    int status[MAX_STATUS] = {0};
    if (self->status_polls++ % STATUS_EVERY != 0) {
        return;
    }
    if (self->link.ready && dhd->get_status(status, (char)dhd->id) >= 0 && !status[STATUS_FORCE]) {
        trip(self, SP_DHD_FORCE_OFF + (uint32_t)(status[STATUS_FORCE_OFF_CAUSE] & 15));
    }
    self->pressed = dhd->get_button(0, (char)dhd->id) > 0;
}

/* Store position and velocity of the three axes if the SDK gave numbers; returns whether it
 * did. */
static int store_if_finite(device *self, const double *at_m, const double *at_mps)
{
    for (int i = 0; i < AXES; i++) {
        if (!isfinite(at_m[i]) || !isfinite(at_mps[i])) {
            self->link.crc_errors++; /* counted as a damaged answer */
            return 0;
        }
    }
    for (int i = 0; i < AXES; i++) {
        self->at_m[i] = at_m[i];
        self->at_mps[i] = at_mps[i];
    }
    return 1;
}

/* Read position and velocity along the pressed axis through the SDK. Returns 1 with a new
 * sample, 0 without, or what ended the loop. */
static int read_device(sp_link *link, uint64_t now_ns, sp_motion *motion, uint32_t capacity)
{
    device *self = (device *)link;
    const sp_dhd *dhd = &self->dhd;
    const uint64_t begin_ns = clock_ns();
    double at_m[AXES], at_mps[AXES];
    (void)capacity;
    if (self->good_ns == 0) {
        self->good_ns = now_ns;
    }
    const int got = dhd->get_position(&at_m[0], &at_m[1], &at_m[2], (char)dhd->id);
    if (got < 0 ||
        dhd->get_linear_velocity(&at_mps[0], &at_mps[1], &at_mps[2], (char)dhd->id) < 0) {
        link->crc_errors++;
        self->failed_reads++;
        link->device_error = (uint32_t)dhd->error_get_last();
        watch_call(self, begin_ns);
        return now_ns - self->good_ns > gone_ns ? SP_LINK_GONE
               : self->tripped                  ? SP_LINK_TRIPPED
                                                : 0;
    }
    self->good_ns = now_ns;
    self->failed_reads = 0;
    poll_status(self);
    watch_call(self, begin_ns);
    if (self->pressed) {
        return SP_LINK_BUTTON;
    }
    /* Above 0: the SDK has answered with what it had read before. */
    const int fresh = got == 0 && store_if_finite(self, at_m, at_mps);
    if (fresh) {
        link->samples++;
        motion->position_m = dhd->sign * at_m[dhd->axis] - dhd->surface_m;
        motion->velocity_mps = dhd->sign * at_mps[dhd->axis];
        motion->measured_n = (double)NAN;
        motion->arrived_ns = now_ns;
    }
    return self->tripped ? SP_LINK_TRIPPED : fresh;
}

/* Spring force that keeps the tool on its line along another axis, N. It grows by a step a tick
 * at most, wherever the tool is when it is seen again. */
static double wall_n(const device *self, int axis, double share)
{
    const sp_dhd *dhd = &self->dhd;
    if (axis == dhd->axis || !(dhd->wall_npm > 0)) {
        return 0.0;
    }
    const double spring_n =
        -share * dhd->wall_npm *
        (self->at_m[axis] - dhd->line_m[axis] + wall_damping_s * self->at_mps[axis]);
    const double step_n = wall_growth * dhd->max_n;
    const double lower_n = fmax(fmin(self->wall_n[axis], 0.0) - step_n, -share * dhd->max_n);
    const double upper_n = fmin(fmax(self->wall_n[axis], 0.0) + step_n, share * dhd->max_n);
    return fmin(fmax(spring_n, lower_n), upper_n);
}

/* What holds the tool on its line, and its handle up. */
static double guide_force_n(device *self, uint64_t now_ns, int axis)
{
    const double share = fmin(1e-9 * (double)(now_ns - self->guide_since_ns) / rise_s, 1.0);
    self->wall_n[axis] = wall_n(self, axis, share);
    return self->wall_n[axis] + (axis == UP ? share * self->dhd.weight_n : 0.0);
}

/* Send the force along the pressed axis, and the guide's along the others. Returns 0 if it was
 * taken, 1 if not, or that the device is gone or tripped. */
static int write_device(sp_link *link, uint64_t now_ns, double force_n)
{
    device *self = (device *)link;
    const sp_dhd *dhd = &self->dhd;
    const uint64_t begin_ns = clock_ns();
    double force[AXES];
    self->guide_since_ns = link->released         ? 0
                           : self->guide_since_ns ? self->guide_since_ns
                                                  : now_ns;
    for (int i = 0; i < AXES; i++) {
        force[i] = link->released ? 0.0 : guide_force_n(self, now_ns, i);
    }
    force[dhd->axis] -= dhd->sign * force_n;
    const int put = dhd->set_force(force[0], force[1], force[2], (char)dhd->id);
    link->saturated += put > 0;
    self->refused_forces = put < 0 ? self->refused_forces + 1 : 0;
    if (put < 0) {
        link->device_error = (uint32_t)dhd->error_get_last();
        link->unsent++;
    }
    watch_call(self, begin_ns); /* the next reading says so: this force was taken */
    if (self->refused_forces >= MAX_UNTAKEN) {
        /* The device keeps the last force that it took. */
        if (self->failed_reads >= MAX_UNTAKEN) {
            return SP_LINK_GONE;
        }
        (void)dhd->enable_force(OFF, (char)dhd->id);
        trip(self, link->device_error);
        return SP_LINK_TRIPPED;
    }
    return put < 0;
}

/* Enable forces again, from 0. */
static void reset_device(sp_link *link, uint64_t now_ns)
{
    device *self = (device *)link;
    (void)now_ns;
    self->tripped = 0;
    self->refused_forces = 0;
    self->guide_since_ns = 0;
    (void)self->dhd.set_force(0.0, 0.0, 0.0, (char)self->dhd.id);
    link->ready = self->dhd.enable_force(ON, (char)self->dhd.id) >= 0;
}

uint32_t sp_link_dhd_size(void)
{
    return (uint32_t)sizeof(device);
}

/* Make the link of a Force Dimension device in the caller's memory. */
sp_link *sp_link_dhd_init(void *memory, const sp_dhd *dhd)
{
    device *self = (device *)memory;
    *self = (device){
        .link = {.fd = -1, .read = read_device, .write = write_device, .reset = reset_device},
        .dhd = *dhd,
        .at_m = {dhd->line_m[0], dhd->line_m[1], dhd->line_m[2]}}; /* until the first reading */
    return &self->link;
}
