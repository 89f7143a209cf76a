/* Samples of the loop: what came, and which of them a tick takes. */
#define _GNU_SOURCE
#include <poll.h>
#include <string.h>
#include <time.h>

#include "sp_loop_self.h"

static struct timespec as_timespec(uint64_t time_ns)
{
    return (struct timespec){.tv_sec = (time_t)(time_ns / 1000000000u),
                             .tv_nsec = (long)(time_ns % 1000000000u)};
}

static void take(sp_loop *self)
{
    sp_motion come[WAITING];
    const int count = self->link->read(self->link, sp_loop_now(), come, WAITING);
    if (count > 0) {
        for (int i = 0; i < count && i < WAITING; i++) {
            *sp_link_place(self->waiting, WAITING, self->waiting_count) = come[i];
            self->waiting_count += self->waiting_count < WAITING;
        }
    } else if (count == SP_LINK_GONE) {
        sp_loop_lose_link(self);
    } else if (count == SP_LINK_TRIPPED) {
        sp_loop_trip(self);
    } else if (count == SP_LINK_ENDED && !self->reason) {
        self->reason = SP_STOP_ENDED;
    }
}

void sp_loop_listen(sp_loop *self, uint64_t until_ns, int only_first)
{
    uint64_t time_ns;
    while ((time_ns = sp_loop_now()) < until_ns && !(only_first && self->waiting_count)) {
        if (self->link == NULL || self->link->fd < 0) {
            const struct timespec until = as_timespec(until_ns);
            (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
            continue;
        }
        const struct timespec left = as_timespec(until_ns - time_ns);
        struct pollfd waits = {.fd = self->link->fd, .events = POLLIN};
        if (ppoll(&waits, 1, &left, NULL) > 0) {
            take(self);
        }
    }
}

static void look_for_sample(sp_loop *self, int behind)
{
    if (self->link != NULL && !self->waiting_count) {
        take(self);
    }
    /* A sample that is a little late is worth waiting for, while the tick itself is in time. */
    if (self->link != NULL && self->link->fd >= 0 && !behind) {
        sp_loop_listen(self, self->deadline_ns + self->period_ns / 4, 1);
    }
}

/* The sample of this tick: the newest. Periods that were missed take one each, oldest first, so
 * that the scene's memory has no hole. Returns whether there is one. */
static int next_sample(sp_loop *self, int behind)
{
    if (!self->waiting_count) {
        return 0;
    }
    const int used = behind ? 1 : self->waiting_count;
    self->motion = self->waiting[used - 1];
    self->waiting_count -= used;
    memmove(self->waiting, self->waiting + used,
            (size_t)self->waiting_count * sizeof *self->waiting);
    return 1;
}

int sp_loop_sample(sp_loop *self, int behind)
{
    look_for_sample(self, behind);
    return next_sample(self, behind);
}
