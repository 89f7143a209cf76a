/* One period of the loop. */
#include <math.h>

#include "sp_loop_self.h"

static void begin_row(sp_loop *self, uint64_t begin_ns, int fresh)
{
    sp_row *row = &self->row;
    row->time_s = 1e-9 * (double)(int64_t)(begin_ns - self->start_ns);
    row->lateness_s = 1e-9 * (double)(int64_t)(begin_ns - self->deadline_ns);
    row->dt_s = (double)(sp_real)self->config.period_s;
    row->call = 0;
    row->notes = 0;
    row->tick_s = 0;
    if (self->link == NULL && !fresh) {
        self->motion.measured_n = (double)NAN; /* what a device that is gone last measured is old */
    }
    row->measured_n = self->motion.measured_n;
}

/* The scene's call of this period. */
static void call_scene(sp_loop *self, int fresh)
{
    sp_row *row = &self->row;
    sp_real force_n = (sp_real)row->returned_n;
    int call = 0, notes;
    if (self->reset_next) {
        self->reset(self->config.state);
        self->reset_next = 0;
        self->resets++;
        call |= SP_CALL_RESET;
    }
    const uint64_t begin_ns = sp_loop_now();
    if (fresh) {
        const sp_real position_m = (sp_real)self->motion.position_m;
        const sp_real velocity_mps = (sp_real)self->motion.velocity_mps;
        if (self->config.measured_n != NULL) {
            *self->config.measured_n = self->motion.measured_n;
        }
        notes = self->step(self->config.state, position_m, velocity_mps, &force_n);
        row->position_m = (double)position_m;
        row->velocity_mps = (double)velocity_mps;
    } else {
        call |= SP_CALL_IDLE;
        notes = self->idle(self->config.state, (sp_real)self->config.period_s, &force_n);
    }
    row->tick_s = 1e-9 * (double)(sp_loop_now() - begin_ns);
    row->call = call;
    row->notes = notes;
    row->returned_n = (double)force_n;
    const int latched = notes >= 0 && (notes & self->config.latched_note);
    self->trips += latched && !self->latched;
    self->latched = latched;
    if (notes < 0) {
        self->reason = SP_STOP_MISUSE;
    }
}

/* NaN is beyond every limit, and so is infinity, even where there is no limit. */
static int is_beyond(double force_n, double max_force_n)
{
    return !(isfinite(force_n) && fabs(force_n) <= max_force_n);
}

static void check_limits(sp_loop *self)
{
    const sp_row *row = &self->row;
    const double max_n = self->config.max_force_n;
    if (self->reason || !sp_loop_at_work(self)) {
        return;
    }
    if (is_beyond(row->returned_n, max_n) ||
        (!isnan(row->measured_n) && is_beyond(row->measured_n, max_n))) {
        self->reason = SP_STOP_FORCE;
    } else if (row->position_m > self->config.max_depth_m) {
        self->reason = SP_STOP_DEPTH;
    }
}

static void send_force(sp_loop *self, int behind)
{
    sp_row *row = &self->row;
    int call = (int)row->call;
    double force_n = row->returned_n;
    if (self->reason || !sp_loop_at_work(self)) {
        force_n = 0.0;
        call |= SP_CALL_SILENT;
    }
    int put = 1;
    if (self->link != NULL && !behind) {
        put = self->link->write(self->link, sp_loop_now(), force_n);
        if (put == SP_LINK_GONE) {
            sp_loop_lose_link(self);
        } else if (put == SP_LINK_TRIPPED) {
            sp_loop_trip(self);
        }
    }
    if (put == 0) {
        row->sent_n = force_n;
    } else {
        call |= SP_CALL_UNSENT;
    }
    row->call = call;
}

void sp_loop_tick(sp_loop *self, uint64_t begin_ns, int fresh, int behind)
{
    begin_row(self, begin_ns, fresh);
    self->row.age_s =
        fresh ? 1e-9 * (double)(int64_t)(begin_ns - self->motion.arrived_ns) : (double)NAN;
    if (!sp_loop_at_work(self)) {
        self->row.call = SP_CALL_NONE;
        self->row.returned_n = 0.0;
        self->row.position_m = fresh ? self->motion.position_m : self->row.position_m;
        self->row.velocity_mps = fresh ? self->motion.velocity_mps : self->row.velocity_mps;
    } else {
        call_scene(self, fresh);
    }
    check_limits(self);
    send_force(self, behind);
    self->stale += !fresh;
    self->late += begin_ns - self->deadline_ns > self->period_ns && begin_ns > self->deadline_ns;
    self->ticks++;
    sp_ring_put(&self->ring, &self->row);
}
