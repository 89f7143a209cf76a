/* A tool on an object under the force control of sp_press, without a clock: a late force sensor, a
 * late motor, friction, an encoder with steps. */
#ifndef PRESSED_TOOL_H
#define PRESSED_TOOL_H

#include <stdint.h>

#include "sim.h"
#include "sp_press.h"

/* springpot declarations begin */
typedef struct {
    double mass_kg;
    double viscous_nspm;
    double coulomb_n;
    double encoder_m;
    double noise_n;       /* of the sensor */
    uint32_t sensor_late; /* eighths of a tick */
    uint32_t motor_late;  /* likewise */
    double gap_m;         /* between tool and object at the beginning */
    double spring_npm;    /* of the object, where it is a spring and a damper; else 0 */
    double damper_nspm;
    uint32_t object; /* of sim.h */
    uint32_t wrong_tick; /* from then on the sensor shows so much of the force; 0: never */
    double sensor_gain;
    int32_t sensor_holds; /* or what it showed last */
    uint32_t lost_tick;   /* from then on there is no object, and below it a table; 0: never */
    double table_m;
    double table_npm;
} pressed_tool;

/* n ticks of press; of each the position and the object's force, both without sensors, and the
 * motor's force. 0, or a status of sim.h. */
int pressed_tool_run(const pressed_tool *is, sp_press *press, uint32_t n, double *position_m,
                     double *force_n, double *motor_n);
/* springpot declarations end */

#endif
