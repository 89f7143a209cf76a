/* The link of a device: whatever bytes come, however many are taken of what is sent. */
#include "any_bytes.h"

#include "sp_link_odrive.c"

enum { MOTIONS = 4 };

void prove(void)
{
    static odrive memory;
    sp_motion motions[MOTIONS];
    const sp_odrive drive = {
        .node = (uint32_t)Frama_C_interval(0, 63),
        .with_torque = Frama_C_interval_split(0, 1),
        .m_per_turn = 0.02,
        .sign = -1.0,
        .max_torque_nm = 0.5,
        .max_turns_per_s = 10.0,
        .max_current_a = 10.0,
    };
    sp_link *link = sp_link_odrive_init(&memory, 0, &drive);
    //@ loop unroll 0;
    while (Frama_C_interval(0, 1)) {
        ANY(uint64_t, now_ns);
        ANY(double, force_n);
        (void)link->read(link, now_ns, motions, MOTIONS);
        (void)link->write(link, now_ns, force_n);
        if (Frama_C_interval(0, 1)) {
            link->reset(link, now_ns);
        }
    }
}
