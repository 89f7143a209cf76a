/* The string.h of a module without a C library: what becomes memory.copy, memory.fill. */
#ifndef SP_WASM_STRING_H
#define SP_WASM_STRING_H

#include <stddef.h>

#define memcpy(to, from, size) __builtin_memcpy(to, from, size)
#define memset(at, value, size) __builtin_memset(at, value, size)

#endif
