/* Firmware: a scene rendered by a board, from its sensor to its motor, one call a period: sp_step
 * where the sensor has a new motion, else sp_idle: its watchdog takes the force to zero and
 * latches it until the board starts again. A scene that fails its self-test renders nothing. */
#include "sp_port.h"
#include "sp_scene.h"

int main(void);

static sp_state scene;

/* One period of the loop: read the tool, compute the force (or hold it, where no sample came),
 * set the motor. */
static void tick(void)
{
    float position_m = 0.0f;
    float velocity_mps = 0.0f;
    sp_real force_n = (sp_real)0;
    if (sp_hand_motion(&position_m, &velocity_mps)) {
        (void)sp_step(&scene, (sp_real)position_m, (sp_real)velocity_mps, &force_n);
    } else {
        (void)sp_idle(&scene, SP_PERIOD_S, &force_n);
    }
    sp_hand_force((float)force_n);
}

/* Check this compiler by the self-test, then run a tick a period. A board that fails the test
 * keeps a force of 0. */
int main(void)
{
    const int is_sound = sp_selftest() == 0;
    sp_hand_force(0.0f);
    sp_init(&scene);
    sp_port_start((float)SP_PERIOD_S);
    for (;;) {
        for (uint32_t passed = sp_port_take_elapsed_periods(); passed > 0; passed--) {
            if (is_sound) {
                tick();
            }
        }
        sp_port_sleep();
    }
}
