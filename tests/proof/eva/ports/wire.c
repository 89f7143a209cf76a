/* The serial protocol: any bytes in any number, every message out of whatever frame came, and every
 * message sent. */
#include "anything.h"

#include "sp_wire.c"

static sp_wire_receiver receiver;

#define TAKE(number, NAME, name)                                                                   \
    {                                                                                              \
        sp_wire_##name message;                                                                    \
        (void)sp_wire_get_##name(&frame, &message);                                                \
    }
#define SEND(number, NAME, name)                                                                   \
    {                                                                                              \
        ANY(sp_wire_##name, message);                                                              \
        uint8_t bytes[SP_WIRE_MAX_BYTES];                                                          \
        const uint32_t used = sp_wire_send_##name(&sequence, &message, bytes);                     \
        /*@ assert room: used <= SP_WIRE_MAX_BYTES; */                                             \
    }

static void receive(void)
{
    sp_wire_frame frame;
    ANY(uint8_t, byte);
    if (sp_wire_receive(&receiver, byte, &frame) != SP_WIRE_NONE) {
        SP_WIRE_TABLE(TAKE)
    }
}

static void send(void)
{
    ANY(uint32_t, sequence);
    SP_WIRE_TABLE(SEND)
}

void prove(void)
{
    //@ widen_hints "all", SP_WIRE_MAX_BYTES - 1;
    //@ loop unroll 0;
    while (Frama_C_interval(0, 1)) {
        receive();
        send();
        if (Frama_C_interval(0, 1)) {
            sp_wire_restart(&receiver);
        }
    }
}
