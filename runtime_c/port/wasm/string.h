/* The string.h of a module without a C library: what clang turns into memory.copy, memory.fill. */
#ifndef SP_WASM_STRING_H
#define SP_WASM_STRING_H

#include <stddef.h>

void *memcpy(void *to, const void *from, size_t size);
void *memset(void *at, int value, size_t size);

#endif
