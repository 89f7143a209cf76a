/* Simulated hand on the device: exact steps of a mass on a spring and a damper. */
#include "sim_hand.h"

#include <math.h>
#include <stddef.h>

#include "sim_device.h"

/* Hands, from a stiff pinch to one fingertip. */
static const struct {
    const char *name;
    sim_hand hand;
} hands[] = {
    {"mid", {0.25, 400.0, 6.0}},
    {"firm", {0.03, 5000.0, 5.0}},
    {"light", {0.03, 50.0, 0.5}},
};
enum { HANDS = sizeof hands / sizeof hands[0] };

static const double velocity_time_s = 0.004; /* of the low-pass on the encoder's difference */

struct sim_tool {
    uint32_t hand;
    uint32_t substeps;
    uint32_t noisy;
    sim_tool_device device;
    sim_hand_device moved;
    sim_noise noise;

    sim_motion motion;
    double intended_m;            /* m, at the end of the last tick */
    double late_n[SIM_MAX_DELAY]; /* N, rendered but not yet acting; a ring */
    uint32_t next;                /* the one that acts next */
    double encoder_m;             /* m, last reading */
    double encoder_speed_mps;     /* m/s, filtered difference of readings */
};

uint32_t sim_hand_count(void)
{
    return HANDS;
}

const char *sim_hand_name(uint32_t hand)
{
    return hand < HANDS ? hands[hand].name : NULL;
}

uint32_t sim_tool_size(void)
{
    return (uint32_t)sizeof(sim_tool);
}

/* Whether the device's figures are finite and of the right sign. */
static int possible(const sim_tool_device *device)
{
    return device->mass_kg > 0.0 && isfinite(device->mass_kg) && device->viscous_nspm >= 0.0 &&
           isfinite(device->viscous_nspm) && device->coulomb_n >= 0.0 &&
           isfinite(device->coulomb_n) && device->encoder_step_m > 0.0 &&
           isfinite(device->encoder_step_m) && device->noise_m >= 0.0 &&
           isfinite(device->noise_m) && device->delay_samples <= SIM_MAX_DELAY;
}

/* A tool at rest at position_m in one of the three hands, with its device's mass, friction,
 * delay and encoder. */
int sim_tool_init(sim_tool *tool, uint32_t hand, const sim_tool_device *device, uint32_t substeps,
                  uint32_t noisy, uint64_t seed, double position_m)
{
    if (tool == NULL || device == NULL) {
        return SIM_NULL;
    }
    if (hand >= HANDS || !possible(device) || substeps < 1 || substeps > SIM_MAX_SUBSTEPS ||
        noisy > 1 || !isfinite(position_m)) {
        return SIM_RANGE;
    }
    tool->hand = hand;
    tool->substeps = substeps;
    tool->device = *device;
    tool->moved = (sim_hand_device){device->mass_kg, device->viscous_nspm, device->coulomb_n};
    tool->noisy = noisy;
    sim_noise_init(&tool->noise, seed);
    tool->motion.position_m = position_m;
    tool->motion.velocity_mps = 0.0;
    tool->intended_m = position_m;
    for (uint32_t i = 0; i < SIM_MAX_DELAY; i++) {
        tool->late_n[i] = 0.0;
    }
    tool->next = 0;
    tool->encoder_m = position_m;
    tool->encoder_speed_mps = 0.0;
    return SIM_OK;
}

/* Where the hand intends to be after a share of a tick that ends at intended_m. */
static double intended_at(const sim_tool *tool, double share, double intended_m)
{
    return tool->intended_m + share * (intended_m - tool->intended_m);
}

/* Position and velocity as the device reports them: encoder with noise, and the filtered
 * differences of it; or the truth, if not noisy. */
static void read_sensors(sim_tool *tool, double dt_s, double *position_m, double *velocity_mps)
{
    if (tool->noisy == 0) {
        *position_m = tool->motion.position_m;
        *velocity_mps = tool->motion.velocity_mps;
        return;
    }
    double encoder_m = sim_device_encoder_m(&tool->noise, tool->motion.position_m,
                                            tool->device.noise_m, tool->device.encoder_step_m);
    double difference_mps = (encoder_m - tool->encoder_m) / dt_s;
    double weight = dt_s / (dt_s + velocity_time_s);
    tool->encoder_speed_mps += weight * (difference_mps - tool->encoder_speed_mps);
    tool->encoder_m = encoder_m;
    *position_m = encoder_m;
    *velocity_mps = tool->encoder_speed_mps;
}

/* Status for arguments that a step can not take. */
static int refused(const sim_tool *tool, double dt_s, double hand, double force_n,
                   const double *position_m, const double *velocity_mps)
{
    if (tool == NULL || position_m == NULL || velocity_mps == NULL) {
        return SIM_NULL;
    }
    if (!(dt_s > 0.0 && isfinite(dt_s)) || !isfinite(hand) || !isfinite(force_n)) {
        return SIM_RANGE;
    }
    return SIM_OK;
}

/* Queue force_n and return the force that acts in this tick, N: the one of delay_samples ago. */
static double acting(sim_tool *tool, double force_n)
{
    if (tool->device.delay_samples == 0) {
        return force_n;
    }
    double acting_n = tool->late_n[tool->next];
    tool->late_n[tool->next] = force_n;
    tool->next = (tool->next + 1) % tool->device.delay_samples;
    return acting_n;
}

/* Advance by dt_s while the hand pushes with push_n, and not to a position. */
int sim_tool_push(sim_tool *tool, double dt_s, double push_n, double force_n, double *position_m,
                  double *velocity_mps)
{
    int status = refused(tool, dt_s, push_n, force_n, position_m, velocity_mps);
    if (status != SIM_OK) {
        return status;
    }
    const sim_hand *hand = &hands[tool->hand].hand;
    double acting_n = acting(tool, force_n);
    uint32_t substeps = sim_hand_substeps(hand, &tool->moved, dt_s, tool->substeps);
    double step_s = dt_s / substeps;
    for (uint32_t i = 0; i < substeps; i++) {
        sim_hand_apply_force(hand, &tool->moved, &tool->motion, 0.5 * step_s, push_n, acting_n);
        tool->motion.position_m += step_s * tool->motion.velocity_mps;
        sim_hand_apply_force(hand, &tool->moved, &tool->motion, 0.5 * step_s, push_n, acting_n);
    }
    tool->intended_m = tool->motion.position_m;
    read_sensors(tool, dt_s, position_m, velocity_mps);
    return SIM_OK;
}

void sim_tool_truth(const sim_tool *tool, double *position_m, double *velocity_mps)
{
    *position_m = tool->motion.position_m;
    *velocity_mps = tool->motion.velocity_mps;
}

/* Advance by dt_s while the hand, a spring and damper, is drawn to intended_m. */
int sim_tool_step(sim_tool *tool, double dt_s, double intended_m, double force_n,
                  double *position_m, double *velocity_mps)
{
    int status = refused(tool, dt_s, intended_m, force_n, position_m, velocity_mps);
    if (status != SIM_OK) {
        return status;
    }
    const sim_hand *hand = &hands[tool->hand].hand;
    double acting_n = acting(tool, force_n);
    uint32_t substeps = sim_hand_substeps(hand, &tool->moved, dt_s, tool->substeps);
    double step_s = dt_s / substeps;
    for (uint32_t i = 0; i < substeps; i++) {
        sim_hand_apply_spring(hand, &tool->moved, &tool->motion, 0.5 * step_s,
                              intended_at(tool, (double)i / substeps, intended_m), acting_n);
        tool->motion.position_m += step_s * tool->motion.velocity_mps;
        sim_hand_apply_spring(hand, &tool->moved, &tool->motion, 0.5 * step_s,
                              intended_at(tool, (double)(i + 1) / substeps, intended_m), acting_n);
    }
    tool->intended_m = intended_m;
    read_sensors(tool, dt_s, position_m, velocity_mps);
    return SIM_OK;
}
