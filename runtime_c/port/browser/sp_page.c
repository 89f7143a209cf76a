#include "sp_page.h"

#include <stddef.h>

#include "sim_hand.h"
#include "sp_scene.h"
#include "sp_wire.h"

enum { ROWS = 16384, LINK_BYTES = 16384, SUBSTEPS = 4 };

static double intended_m[ROWS];
static sp_real position_m[ROWS];
static sp_real velocity_mps[ROWS];
static sp_real force_n[ROWS];
static int32_t notes[ROWS];
static uint8_t link[LINK_BYTES];

static sp_state state;
static sim_hand hand = {0.25, 400.0, 6.0};
static sim_moved moved = {SIM_DEVICE_MASS_KG, SIM_DEVICE_DAMPING_NSPM, 0.0};
static sim_motion motion;
static double intends_m; /* at the end of the last tick */
static uint32_t delay;
static double sent_n[SP_PAGE_MAX_DELAY]; /* forces that do not act yet, the next one first */

static sp_wire_receiver receiver;
static uint32_t sequence;
static sp_wire_hash other_hash;
static int other_known;

uint32_t sp_page_rows(void)
{
    return ROWS;
}

double *sp_page_intended_m(void)
{
    return intended_m;
}

sp_real *sp_page_position_m(void)
{
    return position_m;
}

sp_real *sp_page_velocity_mps(void)
{
    return velocity_mps;
}

sp_real *sp_page_force_n(void)
{
    return force_n;
}

int32_t *sp_page_notes(void)
{
    return notes;
}

uint32_t sp_page_link_bytes(void)
{
    return LINK_BYTES;
}

uint8_t *sp_page_link(void)
{
    return link;
}

int sp_page_device(double mass_kg, double viscous_nspm, double coulomb_n)
{
    if (!(mass_kg > 0.0 && viscous_nspm >= 0.0 && coulomb_n >= 0.0)) {
        return 1;
    }
    moved = (sim_moved){mass_kg, viscous_nspm, coulomb_n};
    return 0;
}

int sp_page_hold(double mass_kg, double stiffness_npm, double damping_nspm, uint32_t delay_samples)
{
    if (!(mass_kg >= 0.0 && stiffness_npm >= 0.0 && damping_nspm >= 0.0) ||
        delay_samples > SP_PAGE_MAX_DELAY) {
        return 1;
    }
    hand = (sim_hand){mass_kg, stiffness_npm, damping_nspm};
    for (uint32_t i = delay; i < delay_samples; i++) {
        sent_n[i] = i > 0 ? sent_n[i - 1] : 0.0;
    }
    delay = delay_samples;
    return 0;
}

void sp_page_start(double at_m)
{
    sp_init(&state);
    motion = (sim_motion){at_m, 0.0};
    intends_m = at_m;
    for (uint32_t i = 0; i < SP_PAGE_MAX_DELAY; i++) {
        sent_n[i] = 0.0;
    }
}

/* The force that acts in this tick, N. */
static double acting_n(double newest_n)
{
    if (delay == 0) {
        return newest_n;
    }
    const double found_n = sent_n[0];
    for (uint32_t i = 1; i < delay; i++) {
        sent_n[i - 1] = sent_n[i];
    }
    sent_n[delay - 1] = newest_n;
    return found_n;
}

/* The hand intends to go evenly to to_m. */
static void move_hand(double dt_s, double to_m, double acts_n)
{
    const uint32_t substeps = sim_hand_substeps(&hand, &moved, dt_s, SUBSTEPS);
    const double step_s = dt_s / substeps;
    const double stride_m = (to_m - intends_m) / substeps;
    for (uint32_t i = 0; i < substeps; i++) {
        sim_hand_pull(&hand, &moved, &motion, 0.5 * step_s, intends_m + i * stride_m, acts_n);
        motion.position_m += step_s * motion.velocity_mps;
        sim_hand_pull(&hand, &moved, &motion, 0.5 * step_s, intends_m + (i + 1) * stride_m, acts_n);
    }
    intends_m = to_m;
}

void sp_page_press(uint32_t rows, double dt_s)
{
    for (uint32_t i = 0; i < rows && i < ROWS; i++) {
        position_m[i] = (sp_real)motion.position_m;
        velocity_mps[i] = (sp_real)motion.velocity_mps;
        notes[i] = sp_step(&state, position_m[i], velocity_mps[i], &force_n[i]);
        move_hand(dt_s, intended_m[i], acting_n((double)force_n[i]));
    }
}

void sp_page_replay(uint32_t rows)
{
    static sp_state replayed; /* what is pressed goes on meanwhile */
    sp_init(&replayed);
    for (uint32_t i = 0; i < rows && i < ROWS; i++) {
        notes[i] = sp_step(&replayed, position_m[i], velocity_mps[i], &force_n[i]);
    }
}

uint32_t sp_page_force_crc(uint32_t rows)
{
    return sp_wire_crc32c((const uint8_t *)force_n, rows * (uint32_t)sizeof force_n[0]);
}

static uint32_t take_frame(const sp_wire_frame *frame, uint32_t row)
{
    sp_wire_rendered rendered;
    sp_wire_hello hello;
    if (sp_wire_get_hello(frame, &hello)) {
        sp_wire_restart(&receiver);
        other_hash = hello.model;
        other_known = 1;
    }
    if (!sp_wire_get_rendered(frame, &rendered) || row >= ROWS) {
        return row;
    }
    position_m[row] = (sp_real)rendered.position_m;
    velocity_mps[row] = (sp_real)rendered.velocity_mps;
    force_n[row] = (sp_real)rendered.force_n;
    notes[row] = rendered.notes;
    return row + 1;
}

uint32_t sp_page_receive(uint32_t bytes)
{
    sp_wire_frame frame;
    uint32_t rows = 0;
    for (uint32_t i = 0; i < bytes && i < LINK_BYTES; i++) {
        const int found = sp_wire_receive(&receiver, link[i], &frame);
        if (found != SP_WIRE_NONE && (found == SP_WIRE_NEW || frame.type == SP_WIRE_TYPE_HELLO)) {
            rows = take_frame(&frame, rows);
        }
    }
    return rows;
}

const uint8_t *sp_page_other_hash(void)
{
    return other_known ? other_hash.bytes : NULL;
}

uint32_t sp_page_ask(void)
{
    return sp_wire_send_ask(&sequence, &(sp_wire_ask){.layout = sp_wire_layout()}, link);
}

uint32_t sp_page_command(uint32_t action, float watchdog_s, float rate_hz)
{
    const sp_wire_command command = {
        .action = (uint8_t)action, .watchdog_s = watchdog_s, .rate_hz = rate_hz};
    return sp_wire_send_command(&sequence, &command, link);
}
