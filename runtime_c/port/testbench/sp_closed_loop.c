/* A scene in closed loop with a simulated hand and device. */
#include "sp_closed_loop.h"

#include <math.h>
#include <string.h>

#include "sp_notes.h"

typedef struct {
    sp_real position_m, velocity_mps;
    int come;
} sample;

/* Close the loop of a scene and a simulated hand for n ticks, with samples late, lost or wrong
 * as the scenario says. Returns the number of forces that were not finite, or a negative error. */
int64_t sp_closed_loop_run(const sp_closed_loop_scene *scene, sim_tool *hand, uint32_t n,
                           const sp_closed_loop_scenario *scenario,
                           const sp_closed_loop_trace *trace)
{
    int (*step)(void *, sp_real, sp_real, sp_real *);
    int (*idle)(void *, sp_real, sp_real *);
    int64_t not_finite = 0;
    double seen_m, seen_mps;
    sample late = {0};
    sp_real force = 0;
    memcpy(&step, &scene->step, sizeof step);
    memcpy(&idle, &scene->idle, sizeof idle);
    sim_tool_truth(hand, &seen_m, &seen_mps);
    for (uint32_t i = 0; i < n; i++) {
        const sample now = {(sp_real)(seen_m + scenario->error_m[i]), (sp_real)seen_mps, 1};
        sim_tool_truth(hand, &trace->position_m[i], &trace->velocity_mps[i]);
        trace->seen_m[i] = (double)now.position_m;
        trace->seen_mps[i] = (double)now.velocity_mps;
        if (scenario->dropped[i] == SP_CLOSED_LOOP_LATE) {
            trace->notes[i] = SP_NOTE_HELD; /* the last force is sent again, and the tick is owed */
            late = now;
        } else if (scenario->dropped[i] == SP_CLOSED_LOOP_LOST) {
            trace->notes[i] = idle(scene->state, (sp_real)scenario->dt_s[i], &force);
        } else {
            if (late.come) {
                (void)step(scene->state, late.position_m, late.velocity_mps, &force);
                late.come = 0;
            }
            trace->notes[i] = step(scene->state, now.position_m, now.velocity_mps, &force);
        }
        trace->force_n[i] = (double)force;
        const double acting_n = isfinite(force) ? (double)force : 0.0;
        not_finite += isfinite(force) ? 0 : 1;
        const int status = isnan(scenario->push_n[i])
                               ? sim_tool_step(hand, scenario->dt_s[i], scenario->intended_m[i],
                                               acting_n, &seen_m, &seen_mps)
                               : sim_tool_push(hand, scenario->dt_s[i], scenario->push_n[i],
                                               acting_n, &seen_m, &seen_mps);
        if (status != SIM_OK) {
            return status;
        }
    }
    return not_finite;
}
