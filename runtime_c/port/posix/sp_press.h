/* Force control while recording: the tool presses with a commanded force. To the loop it is a
 * scene: the force that it returns drives the motor, so that it is negative while pressing.
 *
 * The motor gets the command and a part of the measured error. Where the sensor is late, mass_kg is
 * the tool's, and an observer takes the error's place: what the motor's force and the positions
 * leave is the object's force and the device's own resistance, known without the sensor's delay.
 * What it says of a moment less what the sensor says of the same moment is the resistance, which
 * the motor gets too: the sensor's delay is in this slow comparison and nowhere else. A damper on
 * the observer's velocity, which is not late, takes the resonance of tool and object away.
 *
 * Without samples for the watchdog's time the press is over: no force, latched. So it is where
 * sp_press_watch.h finds a fault: a tool that runs away, which is braked first, a sensor that does
 * not measure what the motor gives, a control that rings. */
#ifndef SP_PRESS_H
#define SP_PRESS_H

#include <stdint.h>

/* springpot declarations begin */
#define SP_PRESS_HISTORY 64u      /* ticks: more than any delay */
#define SP_PRESS_SPEED_SAMPLES 5u /* positions that a speed is of */

enum { /* what ended a press */
       SP_PRESS_NO_FAULT = 0,
       SP_PRESS_OVERSPEED = 1,
       SP_PRESS_SENSOR_MISMATCH = 2, /* motor and sensor */
       SP_PRESS_OSCILLATES = 3
};

typedef struct {
    const double *command_n; /* one value a tick, positive into the object */
    uint32_t n;
    uint32_t at;
    double dt_s;
    double max_force_n;
    double p_gain;   /* N/N */
    double d_gain_s; /* N/(N/s) */
    double d_time_s; /* of the low-pass on the D part */
    double mass_kg;  /* 0: no observer */
    double damping_nspm;
    double pole;             /* of the observer, of which all three are the same */
    double resistance_share; /* of a tick, of the newest sample */
    uint32_t motor_late;     /* ticks */
    uint32_t sensor_late;    /* ticks behind the observer, below SP_PRESS_HISTORY */
    double watchdog_s;
    int32_t latched_note;
    double measured_n;
    double error_n; /* filtered */
    double tool_m;  /* the observer's */
    double tool_mps;
    double tool_n;       /* on the tool, of object and resistance */
    double resistance_n; /* half of max_force_n at most */
    double motor_n[SP_PRESS_HISTORY];
    double past_n[SP_PRESS_HISTORY]; /* tool_n */
    uint32_t tick;
    double silent_s;
    int32_t seen; /* a position */
    int32_t latched;
    double max_mps; /* into the object; 0: nothing is watched */
    int32_t fault;
    double place_m[SP_PRESS_SPEED_SAMPLES]; /* and when; the newest is the `places`th */
    uint32_t place_tick[SP_PRESS_SPEED_SAMPLES];
    uint32_t places;
    double speed_mps;
    double braked_s;
    double mean_motor_n; /* over a tenth of a second */
    double mean_measured_n;
    double unlike_s;
    int32_t way; /* -1, 1: of the last motion that was not slow */
    uint32_t turn_tick;
    uint32_t turns; /* one quickly after the other */
} sp_press;

int sp_press_step(sp_press *press, double position_m, double velocity_mps, double *force_n);
int sp_press_idle(sp_press *press, double dt_s, double *force_n);
void sp_press_reset(sp_press *press);
/* springpot declarations end */

#endif
