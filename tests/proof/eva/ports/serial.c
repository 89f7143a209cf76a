/* The link of a device: whatever bytes come, however many are taken of what is sent. */
#include "any_bytes.h"

#include "sp_link_serial.c"

/* As sp_wire.c, which is analysed alone: any frame, any message. */
int sp_wire_receive(sp_wire_receiver *receiver, uint8_t byte, sp_wire_frame *frame)
{
    (void)receiver;
    (void)byte;
    Frama_C_make_unknown((char *)frame, sizeof *frame);
    return Frama_C_interval(SP_WIRE_NONE, SP_WIRE_OLD);
}

void sp_wire_restart(sp_wire_receiver *receiver)
{
    receiver->joining = 1;
}

#define WIRE(number, NAME, name)                                                                   \
    int sp_wire_get_##name(const sp_wire_frame *frame, sp_wire_##name *message)                    \
    {                                                                                              \
        (void)frame;                                                                               \
        const int is_it = Frama_C_interval_split(0, 1);                                            \
        if (is_it) {                                                                               \
            Frama_C_make_unknown((char *)message, sizeof *message);                                \
        }                                                                                          \
        return is_it;                                                                              \
    }                                                                                              \
    uint32_t sp_wire_send_##name(uint32_t *sequence, const sp_wire_##name *message,                \
                                 uint8_t *bytes)                                                   \
    {                                                                                              \
        (void)message;                                                                             \
        *sequence += 1;                                                                            \
        Frama_C_make_unknown((char *)bytes, SP_WIRE_MAX_BYTES);                                    \
        return (uint32_t)Frama_C_interval(0, SP_WIRE_MAX_BYTES);                                   \
    }
SP_WIRE_TABLE(WIRE)

enum { MOTIONS = 4 };

void prove(void)
{
    static serial memory;
    sp_motion motions[MOTIONS];
    ANY(uint32_t, sequence);
    ANY(double, surface_m);
    sp_link *link = sp_link_serial_init(&memory, 0, surface_m, 0.02f, 1000.0f, sequence);
    //@ widen_hints "all", SP_WIRE_MAX_BYTES - 1;
    //@ loop unroll 0;
    while (Frama_C_interval(0, 1)) {
        ANY(uint64_t, now_ns);
        ANY(float, force_n);
        (void)link->read(link, now_ns, motions, MOTIONS);
        (void)link->write(link, now_ns, (double)force_n);
        if (Frama_C_interval(0, 1)) {
            link->reset(link, now_ns);
        }
    }
}
