/* One period of the loop. */
#include <math.h>
#include <string.h>

#include "sp_loop_self.h"

static const uint64_t silent_sensor_ns = 100000000;

/* Begin the log's row of a period with its times. */
static void begin_row(sp_loop *self, const sp_period *period)
{
    sp_row *row = &self->row;
    row->time_s = 1e-9 * (double)(int64_t)(period->begin_ns - self->start_ns);
    row->lateness_s = 1e-9 * (double)(int64_t)(period->begin_ns - period->deadline_ns);
    row->dt_s = (double)(sp_real)self->config.period_s;
    row->call = 0;
    row->notes = 0;
    row->tick_s = 0;
}

/* What the sensor beside the device measured last; NaN where that is long ago. */
static double sensed_n(sp_loop *self, uint64_t now_ns)
{
    const uint64_t at_ns = self->sensed_ns;
    return at_ns != 0 && now_ns < at_ns + silent_sensor_ns ? self->sensed_n : (double)NAN;
}

/* Take the period's sample, if one has come, and its measured force into the row. now_ns: when
 * the tick began. */
static void take_sample(sp_loop *self, uint64_t now_ns, int fresh)
{
    sp_row *row = &self->row;
    row->age_s = (double)NAN;
    if (fresh) {
        self->motion = self->waiting[0];
        sp_loop_consume_samples(self, 1);
        row->age_s = 1e-9 * (double)(int64_t)(now_ns - self->motion.arrived_ns);
    } else if (self->link == NULL) {
        self->motion.measured_n = (double)NAN; /* what a device that is gone last measured is old */
    }
    if (self->config.sensed) {
        self->motion.measured_n = sensed_n(self, now_ns);
    }
    row->measured_n = self->motion.measured_n;
}

/* Call the emitted C for this period: sp_step with a sample, sp_idle without; sp_reset before,
 * if asked for. The row gets force, notes and duration. */
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
        /* As the device sent it. The scene gets it as sp_real: gcc 12 drops the
         * rounding of two such numbers side by side that are made double again. */
        row->position_m = self->motion.position_m;
        row->velocity_mps = self->motion.velocity_mps;
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

/* End the loop where a force or the depth is beyond the session's limits. */
static void check_limits(sp_loop *self)
{
    const sp_row *row = &self->row;
    const double max_n = self->config.max_force_n;
    if (self->reason || !sp_loop_may_call_scene(self)) {
        return;
    }
    if (is_beyond(row->returned_n, max_n) ||
        (!isnan(row->measured_n) && is_beyond(row->measured_n, max_n))) {
        self->reason = SP_STOP_FORCE;
    } else if (row->position_m > self->config.max_depth_m) {
        self->reason = SP_STOP_DEPTH;
    }
}

void sp_loop_reset_rate_window(sp_loop *self)
{
    memset(self->was_idle, 0, sizeof self->was_idle);
    self->idle_count = 0;
    self->idle_run = 0;
}

/* A surplus sample stands for a period that was counted as one without: take it back, so that a
 * device that is only late does not end the loop. */
void sp_loop_uncount_idle(sp_loop *self, int surplus)
{
    for (int back = 1; back <= RATE_WINDOW && surplus > 0; back++) {
        uint8_t *idle = &self->was_idle[(self->window_index + RATE_WINDOW - back) % RATE_WINDOW];
        surplus -= *idle;
        self->idle_count -= *idle;
        *idle = 0;
    }
}

/* End the loop where too many periods of the last ones had no sample: a force from too few
 * samples would be that of another motion. */
static void check_rate(sp_loop *self)
{
    if (self->reason || self->link == NULL || !sp_loop_may_call_scene(self)) {
        return;
    }
    const int idle = ((int)self->row.call & SP_CALL_IDLE) != 0;
    self->idle_run = idle ? self->idle_run + 1 : 0;
    const int counted = idle && self->idle_run <= MAX_COUNTED_RUN;
    self->idle_count += counted - self->was_idle[self->window_index];
    self->was_idle[self->window_index] = (uint8_t)counted;
    self->window_index = (self->window_index + 1) % RATE_WINDOW;
    if (self->idle_count >= MAX_IDLE_IN_WINDOW) {
        self->reason = SP_STOP_RATE;
    }
}

/* Send what the scene returned last, unless the next period has begun too, or zero where it must
 * be, which does not wait; whether it is zero by that. */
static int send_force(sp_loop *self, int behind, int *put)
{
    const int silent = self->reason || !sp_loop_may_call_scene(self);
    const double force_n = silent ? 0.0 : self->row.returned_n;
    *put = 1;
    if (self->link != NULL && (silent || !behind)) {
        self->link->released = silent || self->latched;
        *put = self->link->write(self->link, sp_loop_now(),
                                 self->config.reversed ? -force_n : force_n);
        if (*put == 0) {
            self->sent_n = force_n;
        } else if (*put == SP_LINK_GONE) {
            sp_loop_on_disconnect(self);
        } else if (*put == SP_LINK_TRIPPED) {
            sp_loop_on_device_trip(self);
        }
    }
    return silent;
}

/* Compute a period: its row, its sample, the scene's force and the checks of it. */
static void run_period(sp_loop *self, const sp_period *period, uint64_t now_ns, int fresh)
{
    begin_row(self, period);
    take_sample(self, now_ns, fresh);
    if (!sp_loop_may_call_scene(self)) {
        self->row.call = SP_CALL_NONE;
        self->row.returned_n = 0.0;
        self->row.position_m = fresh ? self->motion.position_m : self->row.position_m;
        self->row.velocity_mps = fresh ? self->motion.velocity_mps : self->row.velocity_mps;
    } else {
        call_scene(self, fresh);
    }
    check_limits(self);
    check_rate(self);
}

/* Finish the row of a period, count it, and hand it to the log. */
static void put_row(sp_loop *self, const sp_period *period, double sent_n, int call, int fresh)
{
    self->row.sent_n = sent_n;
    self->row.call = (double)((int)self->row.call | call);
    self->stale += !fresh;
    self->late += period->begin_ns > period->deadline_ns + self->period_ns;
    self->ticks++;
    sp_ring_put(&self->ring, &self->row);
}

/* Compute a period that was left open for its late sample; in its time the force before was
 * sent again. */
static void close_open_period(sp_loop *self, const sp_period *period, uint64_t now_ns, int fresh)
{
    const int before = self->reason;
    int put;
    run_period(self, period, now_ns, fresh);
    if (self->reason != before) {
        (void)send_force(self, 0, &put);
        put_row(self, period, self->sent_n, SP_CALL_SILENT | (put ? SP_CALL_UNSENT : 0), fresh);
    } else {
        put_row(self, period, period->sent_n, SP_CALL_UNSENT, fresh);
    }
}

/* Compute the period that has just begun, and send its force. */
static void close_current_period(sp_loop *self, const sp_period *period, int behind, int fresh)
{
    int put;
    run_period(self, period, period->begin_ns, fresh);
    const int silent = send_force(self, behind, &put);
    put_row(self, period, self->sent_n, (silent ? SP_CALL_SILENT : 0) | (put ? SP_CALL_UNSENT : 0),
            fresh);
}

/* Whether a sample may still come for a period without one. */
static int may_stay_open(sp_loop *self)
{
    return self->link != NULL && self->link->fd >= 0 && !self->reset_next &&
           sp_loop_may_call_scene(self);
}

/* Rows for the oldest open periods: first for `idle` of them without a sample, then for those that
 * have one waiting. */
static void close_open_periods(sp_loop *self, int count, int idle, uint64_t now_ns)
{
    const int before = self->reason;
    for (int i = 0; i < count && self->reason == before; i++) {
        close_open_period(self, &self->open_periods[i], now_ns, i >= idle);
    }
    self->open_count -= count;
    memmove(self->open_periods, self->open_periods + count,
            (size_t)self->open_count * sizeof *self->open_periods);
}

/* One tick. A period whose sample is late stays open, the last force is sent again, and it is
 * computed with its sample in a later tick; after max_open periods without. Returns whether a
 * sample had come. */
int sp_loop_tick(sp_loop *self, int behind)
{
    sp_period now = {.begin_ns = sp_loop_now(), .deadline_ns = self->deadline_ns};
    const int fresh = self->waiting_count > 0;
    if (!fresh && may_stay_open(self)) {
        int put;
        close_open_periods(self, self->open_count == self->max_open, MAX_OPEN_PERIODS,
                           now.begin_ns);
        (void)send_force(self, behind, &put);
        now.sent_n = self->sent_n;
        self->open_periods[self->open_count++] = now;
        return fresh;
    }
    close_open_periods(self, self->open_count, self->open_count + 1 - self->waiting_count,
                       now.begin_ns);
    if (!self->reason) {
        close_current_period(self, &now, behind, self->waiting_count > 0);
    }
    return fresh;
}

void sp_loop_close_open_periods(sp_loop *self)
{
    close_open_periods(self, self->open_count, MAX_OPEN_PERIODS, sp_loop_now());
}
