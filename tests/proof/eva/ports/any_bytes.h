/* As sp_link_bytes.c, without a file: any count of any bytes comes and is taken. */
#ifndef ANY_BYTES_H
#define ANY_BYTES_H

#include "anything.h"

#include "sp_link.h"

sp_motion *sp_link_next_slot(sp_motion *motions, uint32_t capacity, int count)
{
    (void)count;
    return &motions[Frama_C_interval(0, (int)capacity - 1)];
}

int sp_link_read_bytes(int fd, uint8_t *bytes, uint32_t capacity)
{
    (void)fd;
    Frama_C_make_unknown((char *)bytes, capacity);
    return Frama_C_interval(SP_LINK_GONE, (int)capacity);
}

int sp_link_write_bytes(int fd, const uint8_t *bytes, uint32_t count)
{
    (void)fd;
    (void)bytes;
    return Frama_C_interval(SP_LINK_GONE, (int)count);
}

#endif
