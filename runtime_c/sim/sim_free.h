/* A force-feedback device that nobody holds: one mass with friction, a motor that answers late, an
 * encoder. It stands in for hardware where a device is measured, and shares no code with what
 * measures it. */
#ifndef SIM_FREE_H
#define SIM_FREE_H

#include <stdint.h>

#pragma GCC visibility push(default)

/* springpot declarations begin */
typedef struct {
    double mass_kg; /* above 0 */
    double viscous_nspm;
    double coulomb_n;          /* friction while it slides, and what holds it while it sticks */
    double delay_s;            /* from a command to its force, at most 100 ticks */
    double position_step_m;    /* of the encoder; 0: none */
    double position_noise_m;   /* before it */
    double velocity_noise_mps; /* of a velocity sensor; negative: the difference of positions */
    double sign;               /* 1: a positive command pushes the tool out, -1: the other way */
    double max_n;              /* the motor gives no more */
    double bias_n;             /* a force that always pushes the tool out, such as its weight */
    double bristle_m;    /* LuGre: it gives so far before it slides; 0: plain Coulomb friction */
    double static_ratio; /* LuGre: friction at rest over that while sliding */
    double cogging_n;
    double cogging_pitch_m; /* above 0 where it cogs */
    uint64_t seed;          /* of the sensors' noise */
} sim_free_settings;

typedef struct sim_free sim_free;
uint32_t sim_free_size(void);
/* dt_s: of a tick. At rest at position 0. */
int sim_free_init(sim_free *device, const sim_free_settings *settings, double dt_s);
/* One tick under a command, positive outwards; position (positive into the object) and velocity at
 * its end, as the sensors see them. */
int sim_free_step(sim_free *device, double command_n, double *position_m, double *velocity_mps);
/* Without sensors. */
void sim_free_truth(const sim_free *device, double *position_m, double *velocity_mps);
/* springpot declarations end */

#pragma GCC visibility pop

#endif
