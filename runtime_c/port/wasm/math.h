/* The math.h of a module without a C library: what WebAssembly has instructions for. */
#ifndef SP_WASM_MATH_H
#define SP_WASM_MATH_H

#define NAN __builtin_nanf("")
#define INFINITY __builtin_inff()
#define isfinite(x) __builtin_isfinite(x)
#define isnan(x) __builtin_isnan(x)

/* One instruction each: no function is called, whatever a compiler takes for a C library. */
#define fabs(x) __builtin_fabs(x)
#define fabsf(x) __builtin_fabsf(x)
#define floor(x) __builtin_floor(x)
#define sqrt(x) __builtin_sqrt(x)
#define sqrtf(x) __builtin_sqrtf(x)

/* No instruction, and nothing here: the linker names them where something reachable calls them. */
double cos(double x);
double fmax(double x, double y);
double fmin(double x, double y);
double log(double x);

#endif
