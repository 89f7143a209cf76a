/* Up to three scenes in one loop, one of them felt: to the loop they are one scene.
 *
 * What is felt changes only when the tool is above the surface and the force has faded: the scene
 * that comes is reset, and touched from rest. Every step lasts `latency_ns`, whichever scene is
 * felt, so that the time to the force cannot tell one from the other; a step that takes longer is
 * counted. Place 0 gives no force; so does a place without a scene: a real object lies there.
 *
 * Where the watchdog of a scene has latched, that scene stays, whatever is wanted: only
 * sp_switch_reset, which a person asks for, takes the force back.
 */
#ifndef SP_SWITCH_H
#define SP_SWITCH_H

#include <stdint.h>

#include "sp_real.h"

/* springpot declarations begin */
enum {
    SP_SWITCH_PLACES = 4,       /* 0: nothing */
    SP_SWITCH_PLACE_NOTE = 256, /* above the scene's own notes: times the place */
    SP_SWITCH_RESET_NOTE = 1024 /* the scene was reset before this step */
};

typedef struct {
    void *step; /* null: no scene */
    void *idle;
    void *reset;
    void *state;
} sp_switch_scene;

typedef struct {
    sp_switch_scene scenes[4]; /* changed only while `active` and `wanted` are 0 */
    uint64_t latency_ns;
    double faded_n; /* a force below it is none */
    int32_t wanted; /* set by another thread */
    int32_t active; /* read by another thread */
    int32_t reset;  /* the next step is the first of its scene */
    int32_t latched;
    double force_n; /* returned last */
    uint64_t overruns;
    uint64_t max_ns; /* longest step of a scene */
} sp_switch;

int sp_switch_step(sp_switch *places, sp_real position_m, sp_real velocity_mps, sp_real *force_n);
int sp_switch_idle(sp_switch *places, sp_real dt_s, sp_real *force_n);
void sp_switch_reset(sp_switch *places);
void sp_switch_want(sp_switch *places, int32_t place);
int32_t sp_switch_active(sp_switch *places);
/* springpot declarations end */

#endif
