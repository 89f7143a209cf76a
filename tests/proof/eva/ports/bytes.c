/* The ring between an interrupt and the main loop. */
#include "anything.h"

#include "sp_bytes.h"

static sp_bytes ring;

void prove(void)
{
    //@ loop unroll 0;
    while (Frama_C_interval(0, 1)) {
        ANY(uint8_t, byte);
        if (Frama_C_interval(0, 1)) {
            sp_bytes_put(&ring, byte);
        } else {
            (void)sp_bytes_take(&ring, &byte);
        }
        (void)sp_bytes_waiting(&ring);
    }
}
