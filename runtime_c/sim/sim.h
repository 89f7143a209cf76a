/* The simulated bench: soft objects, the device that records them, the hands that press them.
 *
 * It stands in for hardware on a PC, in demonstrations and in tests; nothing of it is emitted.
 * Double precision, no heap: the caller owns the memory of every state, of the size that the
 * ..._size function returns, aligned as for double. States are opaque and independent.
 *
 * Signs: position is penetration from the undeformed surface, positive into the object; force is
 * positive when it pushes the tool out. Units are in the names: m, N, s, mps (m/s).
 *
 * Every int function returns 0, or a negative status for misuse; the state is then unchanged.
 */
#ifndef SIM_H
#define SIM_H

#include <stdint.h>

#pragma GCC visibility push(default)

/* springpot declarations begin */
enum {
    SIM_OK = 0,
    SIM_NULL = -1, /* a pointer is null */
    SIM_RANGE = -2 /* an index, count, factor or time step is out of its range */
};

/* Objects, 0 .. sim_object_count() - 1: five silicones, softest first, then objects of other
 * physics, the last one with a lump; hands likewise. Null beyond the last. */
uint32_t sim_object_count(void);
const char *sim_object_name(uint32_t object);
uint32_t sim_hand_count(void);
const char *sim_hand_name(uint32_t hand);

/* One object, pressed at the middle of its top face.
 * variant: 0 quasi-linear (A); of silicones also 1, relaxation depends on stress (B).
 * stiffer: factor on every force, above 0 (1: the object as calibrated).
 * dt_s: time between samples, above 0.
 * substeps: steps of the integrator in one dt_s, 1 .. 4096; 16 is fine at 1 ms.
 * It starts undeformed and fully relaxed. */
typedef struct sim_object sim_object;
uint32_t sim_object_size(void);
int sim_object_init(sim_object *object_state, uint32_t object, uint32_t variant, double stiffer,
                    double dt_s, uint32_t substeps);

/* Put the tool above another place of a fresh object, m: of the object "lump" alone. */
int sim_object_place(sim_object *object_state, double x_m, double y_m);

/* Move the tool through position_m[0 .. n-1], linear between samples, and return the true force
 * at each: no sensor, no noise. A second call goes on where the first ended; the first sample of
 * all is reached from 0 within one dt_s. */
int sim_object_move(sim_object *object_state, uint32_t n, const double *position_m,
                    double *force_n);

/* An object with a haptic device at rest on its surface: 1 kHz force control by PD, a load cell
 * and an encoder with noise and steps.
 * seed: of the sensors' noise. delay_samples: 0, or 1 when the motor force leaves a tick late. */
typedef struct sim_bench sim_bench;
uint32_t sim_bench_size(void);
int sim_bench_init(sim_bench *bench, uint32_t object, uint32_t variant, double stiffer,
                   uint64_t seed, uint32_t delay_samples, uint32_t substeps);

/* Put a fresh bench above another place of its object, m: of the object "lump" alone. */
int sim_bench_place(sim_bench *bench, double x_m, double y_m);

/* Follow command_n[0 .. n-1], one sample each ms; position_m and force_n are what the sensors saw
 * at the start of each ms, before that command acted. */
int sim_bench_record(sim_bench *bench, uint32_t n, const double *command_n, double *position_m,
                     double *force_n);

/* A hand that holds the device: one mass, drawn to where the hand intends to be by a spring,
 * braked by hand and device.
 * substeps: steps of the integrator in a tick; more are taken where these would be too coarse.
 * noisy: 0 gives true position and velocity; 1 gives the encoder's position and the filtered
 * difference of it. seed: of that noise. position_m: where it starts, at rest. */
typedef struct sim_tool sim_tool;

enum { SIM_MAX_DELAY = 176 }; /* ticks: 20 ms at 8 kHz, and some more */

/* The device that it holds. delay_samples: ticks by which the force is late, to SIM_MAX_DELAY. */
typedef struct {
    double mass_kg;        /* above 0 */
    double viscous_nspm;   /* 0 or more */
    double coulomb_n;      /* dry friction: 0 or more */
    double encoder_step_m; /* above 0 */
    double noise_m;        /* standard deviation of its position: 0 or more */
    uint32_t delay_samples;
} sim_tool_device;

uint32_t sim_tool_size(void);
int sim_tool_init(sim_tool *tool, uint32_t hand, const sim_tool_device *device, uint32_t substeps,
                  uint32_t noisy, uint64_t seed, double position_m);

/* One tick of dt_s (it may differ from tick to tick): intended_m is where the hand intends to be
 * at the end of the tick, force_n what the device renders during it, positive outwards. Returns
 * position and velocity at the end of the tick: the next input of a rendered scene. */
int sim_tool_step(sim_tool *tool, double dt_s, double intended_m, double force_n,
                  double *position_m, double *velocity_mps);

/* As sim_tool_step, but the hand pushes with push_n, N, in place of its spring. */
int sim_tool_push(sim_tool *tool, double dt_s, double push_n, double force_n, double *position_m,
                  double *velocity_mps);

/* Where the tool is and how fast, without sensors. */
void sim_tool_truth(const sim_tool *tool, double *position_m, double *velocity_mps);
/* springpot declarations end */

#pragma GCC visibility pop

#endif
