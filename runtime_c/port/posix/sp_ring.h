/* One writer, one reader, no lock: rows that find no room are counted, never waited for. */
#ifndef SP_RING_H
#define SP_RING_H

#include <stdatomic.h>

#include "sp_loop.h"

typedef struct {
    sp_row *rows;
    uint32_t mask;
    _Atomic uint64_t head; /* written by the writer only */
    _Atomic uint64_t tail; /* written by the reader only */
    _Atomic uint64_t dropped;
} sp_ring;

/* Append a row without waiting (one writer, one reader); a full ring drops it and counts that. */
static inline void sp_ring_put(sp_ring *ring, const sp_row *row)
{
    const uint64_t head = atomic_load_explicit(&ring->head, memory_order_relaxed);
    const uint64_t tail = atomic_load_explicit(&ring->tail, memory_order_acquire);
    if (head - tail > ring->mask) {
        atomic_fetch_add_explicit(&ring->dropped, 1, memory_order_relaxed);
        return;
    }
    ring->rows[head & ring->mask] = *row;
    atomic_store_explicit(&ring->head, head + 1, memory_order_release);
}

/* Take up to n rows, oldest first; returns how many. */
static inline uint32_t sp_ring_get(sp_ring *ring, sp_row *rows, uint32_t n)
{
    const uint64_t tail = atomic_load_explicit(&ring->tail, memory_order_relaxed);
    const uint64_t there = atomic_load_explicit(&ring->head, memory_order_acquire) - tail;
    const uint32_t count = there < n ? (uint32_t)there : n;
    for (uint32_t i = 0; i < count; i++) {
        rows[i] = ring->rows[(tail + i) & ring->mask];
    }
    atomic_store_explicit(&ring->tail, tail + count, memory_order_release);
    return count;
}

#endif
