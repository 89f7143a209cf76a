#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "sp_link.h"

static int failed(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS
               ? 0
               : SP_LINK_GONE;
}

sp_motion *sp_link_next_slot(sp_motion *motions, uint32_t capacity, int count)
{
    if ((uint32_t)count < capacity) {
        return &motions[count];
    }
    memmove(motions, motions + 1, (capacity - 1) * sizeof *motions);
    return &motions[capacity - 1];
}

int sp_link_read_bytes(int fd, uint8_t *bytes, uint32_t capacity)
{
    const ssize_t count = read(fd, bytes, capacity);
    return count > 0 ? (int)count : count == 0 ? SP_LINK_GONE : failed();
}

int sp_link_write_bytes(int fd, const uint8_t *bytes, uint32_t count)
{
    const ssize_t put = write(fd, bytes, count);
    return put >= 0 ? (int)put : failed();
}
