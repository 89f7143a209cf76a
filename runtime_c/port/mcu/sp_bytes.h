/* A ring of bytes between an interrupt and the main loop of one core: one side puts, the other
 * takes. What finds no room is counted, never written over what waits. Zeroed is a good start. */
#ifndef SP_BYTES_H
#define SP_BYTES_H

#include <stdint.h>

enum { SP_BYTES_CAPACITY = 512 /* a power of two; five milliseconds of 921 600 baud */ };

typedef struct {
    volatile uint8_t bytes[SP_BYTES_CAPACITY];
    volatile uint32_t put;      /* ever put; wraps */
    volatile uint32_t taken;    /* ever taken; wraps */
    volatile uint32_t overflow; /* bytes that found no room */
} sp_bytes;

static inline uint32_t sp_bytes_waiting(const sp_bytes *ring)
{
    return ring->put - ring->taken;
}

static inline void sp_bytes_put(sp_bytes *ring, uint8_t byte)
{
    const uint32_t put = ring->put;
    if (put - ring->taken == SP_BYTES_CAPACITY) {
        ring->overflow = ring->overflow + 1;
        return;
    }
    ring->bytes[put % SP_BYTES_CAPACITY] = byte;
    ring->put = put + 1;
}

/* 0 where nothing waits. */
static inline int sp_bytes_take(sp_bytes *ring, uint8_t *byte)
{
    const uint32_t taken = ring->taken;
    if (ring->put == taken) {
        return 0;
    }
    *byte = ring->bytes[taken % SP_BYTES_CAPACITY];
    ring->taken = taken + 1;
    return 1;
}

#endif
