/* For an emulated board: positions out of "calls.bin" (what is not a number stands for a sensor
 * without news), forces into "returns.bin"; the end ends the emulator. */
#include "sp_port.h"
#include "sp_semihosting.h"

static uint32_t from, to;
static int began;

void sp_hand_start(void)
{
    static const char in[] = "calls.bin", out[] = "returns.bin";
    from = sp_semihosting_open(in, sizeof in - 1, SP_SEMIHOSTING_READ_BINARY);
    to = sp_semihosting_open(out, sizeof out - 1, SP_SEMIHOSTING_WRITE_BINARY);
}

int sp_hand_motion(float *position_m)
{
    float row[1];
    if (sp_semihosting_read(from, row, sizeof row) != 0) {
        sp_semihosting_exit();
    }
    began = 1;
    *position_m = row[0];
    return row[0] == row[0];
}

void sp_hand_force(float force_n)
{
    if (began) { /* the force before the first tick is no tick's */
        sp_semihosting_write(to, &force_n, sizeof force_n);
    }
}
