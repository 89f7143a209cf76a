/* Non-blocking reads and writes that the serial and CAN links share. */
#define _GNU_SOURCE
#include "sp_link.h"

#include <string.h>

/* Slot for the next sample; where all are taken the oldest goes. */
sp_motion *sp_link_next_slot(sp_motion *motions, uint32_t capacity, int count)
{
    if ((uint32_t)count < capacity) {
        return &motions[count];
    }
    memmove(motions, motions + 1, (capacity - 1) * sizeof *motions);
    return &motions[capacity - 1];
}

#if defined(_WIN32)
#include "sp_clock.h"

/* fd: the handle of a serial port whose timeouts return what is there at once. */
static HANDLE handle_of(int fd)
{
    return (HANDLE)(intptr_t)fd;
}

/* Wait until the descriptor has bytes, max_ns at most. Returns above 0 if it has. */
int sp_link_wait(int fd, uint64_t max_ns)
{
    static const uint64_t look_ns = 250000;
    (void)fd;
    (void)sp_clock_sleep_until(sp_clock_ns() + (max_ns < look_ns ? max_ns : look_ns));
    return 1;
}

int sp_link_read_bytes(int fd, uint8_t *bytes, uint32_t capacity)
{
    DWORD count = 0;
    return ReadFile(handle_of(fd), bytes, capacity, &count, NULL) ? (int)count : SP_LINK_GONE;
}

int sp_link_write_bytes(int fd, const uint8_t *bytes, uint32_t count)
{
    DWORD put = 0;
    return WriteFile(handle_of(fd), bytes, count, &put, NULL) ? (int)put : SP_LINK_GONE;
}
#else
#include <errno.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

static int failed(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS
               ? 0
               : SP_LINK_GONE;
}

/* Wait until the descriptor has bytes, max_ns at most. Returns above 0 if it has. */
int sp_link_wait(int fd, uint64_t max_ns)
{
    const struct timespec left = {.tv_sec = (time_t)(max_ns / 1000000000u),
                                  .tv_nsec = (long)(max_ns % 1000000000u)};
    struct pollfd waits = {.fd = fd, .events = POLLIN};
#if defined(__APPLE__) /* which has no ppoll: in whole milliseconds, and then to look again */
    (void)left;
    return poll(&waits, 1, (int)(max_ns / 1000000u));
#else
    return ppoll(&waits, 1, &left, NULL);
#endif
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
#endif
