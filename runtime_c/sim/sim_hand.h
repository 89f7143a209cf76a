/* A hand that holds the device: one mass with it, drawn by a spring, braked by hand and device. */
#ifndef SIM_HAND_H
#define SIM_HAND_H

#define SIM_DEVICE_MASS_KG 0.3
#define SIM_DEVICE_DAMPING_NSPM 4.0

typedef struct {
    double mass_kg;
    double stiffness_npm;
    double damping_nspm;
} sim_hand;

typedef struct {
    double position_m;
    double velocity_mps;
} sim_motion;

/* Half a step of leapfrog: what the hand's own force and the rendered one do to the speed. */
static inline void sim_hand_push(const sim_hand *hand, sim_motion *motion, double step_s,
                                 double hand_n, double force_n)
{
    const double mass_kg = hand->mass_kg + SIM_DEVICE_MASS_KG;
    const double damping_nspm = hand->damping_nspm + SIM_DEVICE_DAMPING_NSPM;
    const double sum_n = hand_n - damping_nspm * motion->velocity_mps - force_n;
    motion->velocity_mps += step_s * sum_n / mass_kg;
}

static inline void sim_hand_pull(const sim_hand *hand, sim_motion *motion, double step_s,
                                 double intended_m, double force_n)
{
    const double spring_n = hand->stiffness_npm * (intended_m - motion->position_m);
    sim_hand_push(hand, motion, step_s, spring_n, force_n);
}

#endif
