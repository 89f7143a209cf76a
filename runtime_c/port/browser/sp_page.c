/* Page in a browser: the scene and the simulated device, called from JavaScript. */
#include "sp_page.h"

#include "sim_hand.h"
#include "sp_scene.h"

enum { SUBSTEPS = 4 };

double sp_page_intended_m[SP_PAGE_ROWS];
sp_real sp_page_position_m[SP_PAGE_ROWS];
sp_real sp_page_velocity_mps[SP_PAGE_ROWS];
sp_real sp_page_force_n[SP_PAGE_ROWS];
int32_t sp_page_notes[SP_PAGE_ROWS];

static sp_state state;
static sim_hand hand;
static sim_hand_device moved;
static sim_motion motion;
static double last_intended_m; /* at the end of the last tick */
static uint32_t delay_samples;
static double sent_n[SP_PAGE_MAX_DELAY + 1]; /* forces that do not act yet, the next one first */

void sp_page_set_device(double mass_kg, double viscous_nspm, double coulomb_n)
{
    moved = (sim_hand_device){mass_kg, viscous_nspm, coulomb_n};
}

/* Change the hand that holds the tool, and by how many ticks its device is late. Forces on
 * their way stay. */
void sp_page_set_hand(double mass_kg, double stiffness_npm, double damping_nspm, uint32_t delay)
{
    hand = (sim_hand){mass_kg, stiffness_npm, damping_nspm};
    const uint32_t wanted = delay < SP_PAGE_MAX_DELAY ? delay : SP_PAGE_MAX_DELAY;
    for (uint32_t i = delay_samples; i < wanted; i++) {
        sent_n[i] = i > 0U ? sent_n[i - 1U] : 0.0;
    }
    delay_samples = wanted;
}

/* Put a tool at rest at position_m, with no force on its way. */
void sp_page_start(double position_m)
{
    sp_init(&state);
    motion = (sim_motion){position_m, 0.0};
    last_intended_m = position_m;
    for (uint32_t i = 0; i < SP_PAGE_MAX_DELAY; i++) {
        sent_n[i] = 0.0;
    }
}

/* Queue the newest force and return the one that is delay_samples old, which acts now, N. */
static double acting_n(double newest_n)
{
    sent_n[delay_samples] = newest_n;
    const double found_n = sent_n[0];
    for (uint32_t i = 0; i < delay_samples; i++) {
        sent_n[i] = sent_n[i + 1U];
    }
    return found_n;
}

/* Advance hand and tool by a tick (leapfrog) while the hand's intended position goes evenly to
 * to_m. */
static void move_hand(double dt_s, double to_m, double force_n)
{
    const uint32_t substeps = sim_hand_substeps(&hand, &moved, dt_s, SUBSTEPS);
    const double step_s = dt_s / (double)substeps;
    const double stride_m = (to_m - last_intended_m) / (double)substeps;
    for (uint32_t i = 0; i < substeps; i++) {
        const double from_m = last_intended_m + (double)i * stride_m;
        sim_hand_apply_spring(&hand, &moved, &motion, 0.5 * step_s, from_m, force_n);
        motion.position_m += step_s * motion.velocity_mps;
        sim_hand_apply_spring(&hand, &moved, &motion, 0.5 * step_s, from_m + stride_m, force_n);
    }
    last_intended_m = to_m;
}

/* Close the loop for `rows` ticks: the scene gives a force, the hand moves under it. */
void sp_page_run(uint32_t rows, double dt_s)
{
    for (uint32_t i = 0; i < rows && i < SP_PAGE_ROWS; i++) {
        sp_page_position_m[i] = (sp_real)motion.position_m;
        sp_page_velocity_mps[i] = (sp_real)motion.velocity_mps;
        sp_page_notes[i] =
            sp_step(&state, sp_page_position_m[i], sp_page_velocity_mps[i], &sp_page_force_n[i]);
        move_hand(dt_s, sp_page_intended_m[i], acting_n((double)sp_page_force_n[i]));
    }
}
