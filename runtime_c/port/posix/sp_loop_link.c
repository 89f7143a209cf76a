/* The loop's device: at work, tripped, gone, ready again. */
#define _POSIX_C_SOURCE 200809L
#include "sp_clock.h"
#include "sp_loop_self.h"

static const uint64_t max_arming_ns = 1000000000;
/* Zero at the end: so often, since one may be lost; a full buffer is tried again for so long. */
enum { ZEROS = 3 };
static const uint64_t max_stopping_ns = 200000000;
static const uint64_t stopping_step_ns = 1000000;

uint64_t sp_loop_now(void)
{
    return sp_clock_ns();
}

void sp_loop_on_disconnect(sp_loop *self)
{
    self->link = NULL;
    self->tripped_before_disconnect = self->latched || self->tripped;
    self->connected = 0;
    self->disconnects++;
}

void sp_loop_on_device_trip(sp_loop *self)
{
    if (!self->tripped) {
        self->tripped = 1;
        self->trips++;
    }
}

void sp_loop_arm_device(sp_loop *self)
{
    self->link->reset(self->link, sp_loop_now());
    self->arming_ns = self->link->ready ? 0 : sp_loop_now();
}

/* Whether the scene's force may be rendered: not during a pause, after a trip, or while the
 * device is being armed. An arming that takes too long counts as a trip. */
int sp_loop_may_call_scene(sp_loop *self)
{
    if (self->arming_ns && self->link != NULL) {
        if (self->link->ready) {
            self->arming_ns = 0;
        } else if (sp_loop_now() - self->arming_ns > max_arming_ns) {
            self->arming_ns = 0;
            sp_loop_on_device_trip(self);
        }
    }
    return !self->paused && !self->tripped && !self->arming_ns;
}

/* Send a force of zero at the end, several times and until it was taken: the last force that a
 * device has must be 0. */
void sp_loop_stop_device(sp_loop *self)
{
    const uint64_t end_ns = sp_loop_now() + max_stopping_ns;
    int taken = 0;
    while (self->link != NULL && taken < ZEROS) {
        const uint64_t now_ns = sp_loop_now();
        self->link->released = 1;
        const int put = self->link->write(self->link, now_ns, 0.0);
        if (put == SP_LINK_GONE) {
            sp_loop_on_disconnect(self);
        } else if (put <= 0) {
            taken++;
        } else if (now_ns >= end_ns) {
            break;
        } else {
            (void)sp_clock_sleep_until(now_ns + stopping_step_ns);
        }
    }
}
