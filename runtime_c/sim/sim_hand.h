/* A hand that holds the device: one mass with it, drawn by a spring, braked by hand and device. */
#ifndef SIM_HAND_H
#define SIM_HAND_H

#include <stdint.h>

/* The device that is assumed where none is measured. */
#define SIM_DEVICE_MASS_KG 0.3
#define SIM_DEVICE_DAMPING_NSPM 4.0

#define SIM_HAND_MAX_SUBSTEPS 4096U /* in a tick */

typedef struct {
    double mass_kg;
    double stiffness_npm;
    double damping_nspm;
} sim_hand;

/* What the hand moves: the device, without its motor. */
typedef struct {
    double mass_kg;
    double viscous_nspm;
    double coulomb_n;
} sim_hand_device;

typedef struct {
    double position_m;
    double velocity_mps;
} sim_motion;

/* Steps of leapfrog in a tick of dt_s, at least so many: more where friction or the hand's spring
 * is fast. */
static inline uint32_t sim_hand_substeps(const sim_hand *hand, const sim_hand_device *moved,
                                         double dt_s, uint32_t at_least)
{
    const double mass_kg = hand->mass_kg + moved->mass_kg;
    const double braked = dt_s * (hand->damping_nspm + moved->viscous_nspm) / mass_kg;
    const double swung = 0.36 * dt_s * dt_s * hand->stiffness_npm / mass_kg;
    uint32_t steps = at_least;
    while (steps < SIM_HAND_MAX_SUBSTEPS &&
           ((double)steps < braked || (double)steps * (double)steps < swung)) {
        steps++;
    }
    return steps;
}

/* Dry friction holds a speed that it can take away within the step at 0. */
static inline double sim_hand_after_friction(double velocity_mps, double taken_mps)
{
    double left_mps = 0.0;
    if (velocity_mps > taken_mps) {
        left_mps = velocity_mps - taken_mps;
    } else if (velocity_mps < -taken_mps) {
        left_mps = velocity_mps + taken_mps;
    } else {
        /* held */
    }
    return left_mps;
}

/* Half a step of leapfrog: what the hand's own force and the rendered one do to the speed. */
static inline void sim_hand_apply_force(const sim_hand *hand, const sim_hand_device *moved,
                                        sim_motion *motion, double step_s, double hand_n,
                                        double force_n)
{
    const double mass_kg = hand->mass_kg + moved->mass_kg;
    const double damping_nspm = hand->damping_nspm + moved->viscous_nspm;
    const double sum_n = hand_n - damping_nspm * motion->velocity_mps - force_n;
    motion->velocity_mps += step_s * sum_n / mass_kg;
    if (moved->coulomb_n > 0.0) {
        const double taken_mps = step_s * moved->coulomb_n / mass_kg;
        motion->velocity_mps = sim_hand_after_friction(motion->velocity_mps, taken_mps);
    }
}

static inline void sim_hand_apply_spring(const sim_hand *hand, const sim_hand_device *moved,
                                         sim_motion *motion, double step_s, double intended_m,
                                         double force_n)
{
    const double spring_n = hand->stiffness_npm * (intended_m - motion->position_m);
    sim_hand_apply_force(hand, moved, motion, step_s, spring_n, force_n);
}

#endif
