/* Samples of the loop: what came, and which of them a tick takes. */
#define _GNU_SOURCE
#include <string.h>

#include "sp_clock.h"
#include "sp_loop_self.h"

/* Read what has come from the device into the waiting samples, and note what ends the loop. */
static void take(sp_loop *self)
{
    sp_motion come[MAX_WAITING];
    const int count = self->link->read(self->link, sp_loop_now(), come, MAX_WAITING);
    if (count > 0) {
        for (int i = 0; i < count && i < MAX_WAITING; i++) {
            *sp_link_next_slot(self->waiting, MAX_WAITING, self->waiting_count) = come[i];
            self->waiting_count += self->waiting_count < MAX_WAITING;
        }
    } else if (count == SP_LINK_GONE) {
        sp_loop_on_disconnect(self);
    } else if (count == SP_LINK_TRIPPED) {
        sp_loop_on_device_trip(self);
    } else if (count == SP_LINK_ENDED && !self->reason) {
        self->reason = SP_STOP_ENDED;
    } else if (count == SP_LINK_BUTTON && !self->reason) {
        self->reason = SP_STOP_BUTTON;
    }
}

/* Wait until until_ns and take what comes; return before, once `wanted` samples wait (0: never
 * before). */
void sp_loop_wait_for_samples(sp_loop *self, uint64_t until_ns, int wanted)
{
    uint64_t time_ns;
    while ((time_ns = sp_loop_now()) < until_ns && !(wanted && self->waiting_count >= wanted)) {
        if (self->link == NULL || self->link->fd < 0) {
            (void)sp_clock_sleep_until(until_ns);
            continue;
        }
        if (sp_link_wait(self->link->fd, until_ns - time_ns) > 0) {
            take(self);
        }
    }
}

void sp_loop_consume_samples(sp_loop *self, int count)
{
    self->waiting_count -= count;
    memmove(self->waiting, self->waiting + count,
            (size_t)self->waiting_count * sizeof *self->waiting);
}

/* Take the samples for this tick, waiting a quarter of a period for a late one, and drop those
 * that are more than the periods they can belong to. */
void sp_loop_collect_samples(sp_loop *self, uint64_t late_ns)
{
    const int open = self->open_count + 1;
    if (self->link != NULL && self->waiting_count < open) {
        take(self);
    }
    /* A sample that is a little late is worth waiting for, while the tick itself is in time. */
    if (self->link != NULL && self->link->fd >= 0 && late_ns < self->period_ns) {
        sp_loop_wait_for_samples(self, self->deadline_ns + self->period_ns / 4, open);
    }
    /* More than one a period: the device's clock is faster, or samples came so late that their
     * periods are settled. The newest are those of the open periods; and of the periods after them
     * that a late thread finds begun, or about to. None waits longer than that. */
    const int later = (int)((late_ns + self->period_ns / 4 * 3) / self->period_ns);
    if (self->waiting_count > open + later) {
        const int surplus = self->waiting_count - open - later;
        self->unused += (uint64_t)surplus;
        sp_loop_consume_samples(self, surplus);
        sp_loop_uncount_idle(self, surplus);
    }
}
