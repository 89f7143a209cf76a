#include "sp_page_map.h"

#include <stddef.h>

#include "sim_hand.h"
#include "sp_page.h"
#include "sp_page_touch.h"

enum { ROWS = 16384, SUBSTEPS = 4, AXES = 3, DEPTH = 2 };

#define CARRIED_MPS 0.3 /* off the object: below what the guard of a position believes */

static double intended_x_m[ROWS];
static double intended_y_m[ROWS];
static sp_real x_m[ROWS];
static sp_real y_m[ROWS];
static sp_real x_n[ROWS];
static sp_real y_n[ROWS];

static sp_state state;
static sim_hand hand = {0.25, 400.0, 6.0};
static sim_moved moved = {SIM_DEVICE_MASS_KG, SIM_DEVICE_DAMPING_NSPM, 0.0};
static sim_motion motion[AXES];
static double intends_m[AXES]; /* at the end of the last tick */
static uint32_t delay;
static double sent_n[SP_PAGE_MAX_DELAY][AXES]; /* that do not act yet, the next one first */

double *sp_page_map_intended_x_m(void)
{
    return intended_x_m;
}

double *sp_page_map_intended_y_m(void)
{
    return intended_y_m;
}

sp_real *sp_page_map_x_m(void)
{
    return x_m;
}

sp_real *sp_page_map_y_m(void)
{
    return y_m;
}

sp_real *sp_page_map_x_n(void)
{
    return x_n;
}

sp_real *sp_page_map_y_n(void)
{
    return y_n;
}

int sp_page_map_slides(void)
{
    return sp_page_slides();
}

double sp_page_map_carried_mps(void)
{
    return CARRIED_MPS;
}

int sp_page_map_device(double mass_kg, double viscous_nspm, double coulomb_n)
{
    if (!(mass_kg > 0.0 && viscous_nspm >= 0.0 && coulomb_n >= 0.0)) {
        return 1;
    }
    moved = (sim_moved){mass_kg, viscous_nspm, coulomb_n};
    return 0;
}

int sp_page_map_hold(double mass_kg, double stiffness_npm, double damping_nspm,
                     uint32_t delay_samples)
{
    if (!(mass_kg >= 0.0 && stiffness_npm >= 0.0 && damping_nspm >= 0.0) ||
        delay_samples > SP_PAGE_MAX_DELAY) {
        return 1;
    }
    hand = (sim_hand){mass_kg, stiffness_npm, damping_nspm};
    for (uint32_t i = delay; i < delay_samples; i++) {
        for (uint32_t k = 0; k < AXES; k++) {
            sent_n[i][k] = i > 0U ? sent_n[i - 1U][k] : 0.0;
        }
    }
    delay = delay_samples;
    return 0;
}

void sp_page_map_start(double at_x_m, double at_y_m, double depth_m)
{
    const double at_m[AXES] = {at_x_m, at_y_m, depth_m};
    sp_init(&state);
    for (uint32_t k = 0; k < AXES; k++) {
        motion[k] = (sim_motion){at_m[k], 0.0};
        intends_m[k] = at_m[k];
        for (uint32_t i = 0; i < SP_PAGE_MAX_DELAY; i++) {
            sent_n[i][k] = 0.0;
        }
    }
}

/* The force that acts in this tick, N, in the place of the newest one. */
static void delay_force(double *force_n)
{
    for (uint32_t k = 0; k < AXES && delay > 0U; k++) {
        const double acts_n = sent_n[0][k];
        for (uint32_t i = 1; i < delay; i++) {
            sent_n[i - 1U][k] = sent_n[i][k];
        }
        sent_n[delay - 1U][k] = force_n[k];
        force_n[k] = acts_n;
    }
}

/* Off the object the tool goes where the hand intends to be; on it, a place is held: most_m is 0.
 */
static void carry(sim_motion *lateral, double to_m, double most_m)
{
    const double way_m = to_m - lateral->position_m;
    const double below_m = way_m < most_m ? way_m : most_m;
    lateral->velocity_mps = 0.0;
    lateral->position_m += below_m > -most_m ? below_m : -most_m;
}

/* The hand intends to go evenly to to_m along one axis; against_n: the force that it feels. */
static void move_hand(uint32_t axis, double dt_s, double to_m, double against_n)
{
    sim_motion *its = &motion[axis];
    const uint32_t substeps = sim_hand_substeps(&hand, &moved, dt_s, SUBSTEPS);
    const double step_s = dt_s / (double)substeps;
    const double stride_m = (to_m - intends_m[axis]) / (double)substeps;
    for (uint32_t i = 0; i < substeps; i++) {
        const double from_m = intends_m[axis] + i * stride_m;
        sim_hand_pull(&hand, &moved, its, 0.5 * step_s, from_m, against_n);
        its->position_m += step_s * its->velocity_mps;
        sim_hand_pull(&hand, &moved, its, 0.5 * step_s, from_m + stride_m, against_n);
    }
}

void sp_page_map_press(uint32_t rows, double dt_s)
{
    for (uint32_t i = 0; i < rows && i < ROWS; i++) {
        const double to_m[AXES] = {intended_x_m[i], intended_y_m[i], sp_page_intended_m()[i]};
        const int touches = motion[DEPTH].position_m > 0.0;
        sp_real at_m[AXES];
        sp_real felt_n[AXES] = {(sp_real)0, (sp_real)0, (sp_real)0};
        for (uint32_t k = 0; k < AXES; k++) {
            at_m[k] = (sp_real)motion[k].position_m;
        }
        const sp_real velocity_mps = (sp_real)motion[DEPTH].velocity_mps;
        sp_page_notes()[i] = sp_page_touch(&state, at_m, velocity_mps, felt_n);
        x_m[i] = at_m[0];
        y_m[i] = at_m[1];
        sp_page_position_m()[i] = at_m[DEPTH];
        sp_page_velocity_mps()[i] = velocity_mps;
        x_n[i] = felt_n[0];
        y_n[i] = felt_n[1];
        sp_page_force_n()[i] = felt_n[DEPTH];
        /* Against the hand: the object pushes out, and along x and y. */
        double acts_n[AXES] = {-(double)felt_n[0], -(double)felt_n[1], (double)felt_n[DEPTH]};
        delay_force(acts_n);
        for (uint32_t k = 0; k < AXES; k++) {
            if (k == DEPTH || (touches && sp_page_slides())) {
                move_hand(k, dt_s, to_m[k], acts_n[k]);
            } else {
                carry(&motion[k], to_m[k], touches ? 0.0 : dt_s * CARRIED_MPS);
            }
            intends_m[k] = to_m[k];
        }
    }
}

void sp_page_map_replay(uint32_t rows, double at_x_m, double at_y_m)
{
    static sp_state replayed; /* what is pressed goes on meanwhile */
    sp_init(&replayed);
    sp_place(&replayed, (sp_real)at_x_m, (sp_real)at_y_m);
    for (uint32_t i = 0; i < rows && i < ROWS; i++) {
        sp_page_notes()[i] = sp_step(&replayed, sp_page_position_m()[i], sp_page_velocity_mps()[i],
                                     &sp_page_force_n()[i]);
    }
}
