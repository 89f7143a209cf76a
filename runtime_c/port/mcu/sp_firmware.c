/* Firmware: a scene rendered by a board, from its sensor to its motor, once a period: sp_step where
 * the sensor has a new motion, else sp_idle: its watchdog takes the force to zero and latches it
 * until the board starts again. A scene that fails its self-test renders nothing. */
#include "sp_port.h"
#include "sp_scene.h"

int main(void);

static sp_state scene;

/* The tick of `passed` periods, of which all but the last came too late to be ticks: read the tool,
 * compute the force (or hold it, where no sample came), set the motor. */
static void tick(uint32_t passed)
{
    const sp_real missed_s = (sp_real)(passed - 1u) * SP_PERIOD_S;
    float position_m = 0.0f;
    sp_real force_n = (sp_real)0;
    if (!sp_hand_motion(&position_m)) {
        (void)sp_idle(&scene, missed_s + SP_PERIOD_S, &force_n);
    } else {
        if (passed > 1u) {
            (void)sp_idle(&scene, missed_s, &force_n);
        }
        (void)sp_step(&scene, (sp_real)position_m, (sp_real)0, &force_n);
    }
    sp_hand_force((float)force_n);
}

/* Check this compiler by the self-test, then run a tick a period. A board that fails the test
 * keeps a force of 0. */
int main(void)
{
    sp_hand_start();
    sp_hand_force(0.0f);
    const int is_sound = sp_selftest() == 0;
    sp_init(&scene);
    sp_port_start((float)SP_PERIOD_S);
    for (;;) {
        const uint32_t passed = sp_port_take_elapsed_periods();
        if (passed > 0u && is_sound) {
            tick(passed);
        }
        sp_port_sleep();
    }
}
